//! Code coverage of a run by LLVM's inline 8-bit counters, as libFuzzer uses them, if the compiler was set to
//! emit them (as in `.ci/nightly`). Without them only outcomes guide the fuzzer.

use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};

static COUNTERS: AtomicPtr<u8> = AtomicPtr::new(std::ptr::null_mut());
static LENGTH: AtomicUsize = AtomicUsize::new(0);

/// Registers the counters of the whole program. Called by each module that was compiled with counters.
///
/// # Safety
/// `first..end` must be the program's counters: one allocation that is never freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn __sanitizer_cov_8bit_counters_init(first: *mut u8, end: *mut u8) {
    COUNTERS.store(first, Ordering::Relaxed);
    LENGTH.store(end as usize - first as usize, Ordering::Relaxed);
}

/// The coverage of all runs so far.
#[derive(Debug, Default)]
pub struct CoverageMap {
    /// For each counter, the set of count classes seen, one bit each.
    seen: Vec<u8>,
}

/// Returns the number of counters in the program; 0 if it was compiled without them.
#[must_use]
pub fn counter_count() -> usize {
    LENGTH.load(Ordering::Relaxed)
}

/// Sets all counters to 0.
pub fn reset() {
    counters().iter().for_each(|counter| counter.store(0, Ordering::Relaxed));
}

impl CoverageMap {
    /// Adds the coverage since [`reset`]. Returns `true` if any of it is new.
    pub fn note(&mut self) -> bool {
        let counters = counters();
        self.seen.resize(counters.len(), 0);
        let mut is_new = false;
        for (counter, seen) in counters.iter().zip(&mut self.seen) {
            let bit = bit_of_count(counter.load(Ordering::Relaxed));
            is_new |= bit & !*seen != 0;
            *seen |= bit;
        }
        is_new
    }

    /// Returns the number of counters reached.
    #[must_use]
    pub fn reached(&self) -> usize {
        self.seen.iter().filter(|seen| **seen != 0).count()
    }
}

/// Returns the class of a count as a bit: 1, 2, 3, 4, 8, 16, 32 or 128 times and more.
const fn bit_of_count(count: u8) -> u8 {
    match count {
        0 => 0,
        1 => 1,
        2 => 2,
        3 => 4,
        4..8 => 8,
        8..16 => 16,
        16..32 => 32,
        32..128 => 64,
        128.. => 128,
    }
}

fn counters() -> &'static [std::sync::atomic::AtomicU8] {
    let first = COUNTERS.load(Ordering::Relaxed);
    if first.is_null() {
        return &[];
    }
    // SAFETY: the compiler's counters are that many bytes, never freed, and an atomic byte has a byte's
    // layout. That they are counted up without atomics loses a count at most, on a thread of its own.
    unsafe { std::slice::from_raw_parts(first.cast(), counter_count()) }
}
