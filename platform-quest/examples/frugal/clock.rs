//! This thread's time on a processor, and how much of it is not the shell's own.

use std::cell::Cell;

thread_local! {
    static OTHERS: Cell<u64> = const { Cell::new(0) };
    static WITHIN: Cell<bool> = const { Cell::new(false) };
    static CALLS: Cell<u64> = const { Cell::new(0) };
}

/// Carries out what is not the shell's own. What that calls in turn is in its time already.
pub(crate) fn elsewhere<R>(call: impl FnOnce() -> R) -> R {
    if WITHIN.replace(true) {
        return call();
    }
    let begun = nanos();
    let done = call();
    OTHERS.set(OTHERS.get() + (nanos() - begun));
    CALLS.set(CALLS.get() + 1);
    WITHIN.set(false);
    done
}

/// What a thousand calls add to the shell's own time because a clock is around them.
pub(crate) fn cost() -> u64 {
    let begun = own();
    (0..1000).for_each(|_| elsewhere(|| ()));
    own() - begun
}

/// The shell's own time so far, in nanoseconds. About half of each look at the clock is within it.
pub(crate) fn own() -> u64 {
    nanos() - OTHERS.get()
}

/// How many times something else was carried out so far.
pub(crate) fn calls() -> u64 {
    CALLS.get()
}

/// This thread's time so far, in nanoseconds.
pub(crate) fn nanos() -> u64 {
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
