//! The CPU time of this thread, and the share of it that isn't the shell's own: foreign calls.

use std::cell::Cell;

thread_local! {
    static FOREIGN_NANOS: Cell<u64> = const { Cell::new(0) };
    static IN_FOREIGN_CALL: Cell<bool> = const { Cell::new(false) };
    static FOREIGN_CALLS: Cell<u64> = const { Cell::new(0) };
}

/// Runs a foreign call and counts its time. A call within another one counts as part of it.
pub(crate) fn time_foreign_call<R>(call: impl FnOnce() -> R) -> R {
    if IN_FOREIGN_CALL.replace(true) {
        return call();
    }
    let begun = thread_cpu_nanos_so_far();
    let done = call();
    FOREIGN_NANOS.set(FOREIGN_NANOS.get() + (thread_cpu_nanos_so_far() - begun));
    FOREIGN_CALLS.set(FOREIGN_CALLS.get() + 1);
    IN_FOREIGN_CALL.set(false);
    done
}

/// Returns the nanoseconds that timing a thousand foreign calls adds to the shell's own time.
pub(crate) fn measure_clock_nanos_per_thousand_calls() -> u64 {
    let begun = own_cpu_nanos_so_far();
    (0..1000).for_each(|_| time_foreign_call(|| ()));
    own_cpu_nanos_so_far() - begun
}

/// Words of [`ReferenceTable`]: 256 KiB, more than a core's first cache.
const REFERENCE_WORDS: usize = 1 << 16;

/// The table that [`measure_reference_nanos`] reads.
pub(crate) type ReferenceTable = [u32; REFERENCE_WORDS];

/// Returns the nanoseconds of a fixed calculation: 10,000 reads at pseudo-random places of a table, each
/// place computed from the previous word. A frame's time is given in multiples of it: a slow core, or caches
/// that the software device's threads fill, slow both.
pub(crate) fn measure_reference_nanos(table: &ReferenceTable) -> u64 {
    let begun = thread_cpu_nanos_so_far();
    let mut state = 1u32;
    for _ in 0..10_000 {
        let word = table[state as usize % REFERENCE_WORDS];
        state = (state ^ word).wrapping_mul(0x9E37_79B1).rotate_left(13);
    }
    std::hint::black_box(state);
    thread_cpu_nanos_so_far() - begun
}

/// Returns the filled table of the reference calculation.
pub(crate) fn reference_table() -> Box<ReferenceTable> {
    let mut table = Box::new([0; REFERENCE_WORDS]);
    for (word, i) in table.iter_mut().zip(0u32..) {
        *word = i.wrapping_mul(0x85EB_CA6B);
    }
    table
}

/// Returns the shell's own CPU time so far, in nanoseconds. It includes about half of each reading of the
/// clock.
pub(crate) fn own_cpu_nanos_so_far() -> u64 {
    thread_cpu_nanos_so_far() - FOREIGN_NANOS.get()
}

/// Returns the number of foreign calls so far.
pub(crate) fn foreign_calls_so_far() -> u64 {
    FOREIGN_CALLS.get()
}

/// Returns this thread's CPU time so far, in nanoseconds (`CLOCK_THREAD_CPUTIME_ID`).
pub(crate) fn thread_cpu_nanos_so_far() -> u64 {
    #[repr(C)]
    struct Timespec {
        seconds: i64,
        nanos: i64,
    }
    unsafe extern "C" {
        fn clock_gettime(clock: i32, time: *mut Timespec) -> i32;
    }
    const CLOCK_THREAD_CPUTIME_ID: i32 = 3;
    let mut time = Timespec { seconds: 0, nanos: 0 };
    // SAFETY: the structure is that of 64-bit Linux.
    unsafe { clock_gettime(CLOCK_THREAD_CPUTIME_ID, &mut time) };
    time.seconds.cast_unsigned() * 1_000_000_000 + time.nanos.cast_unsigned()
}
