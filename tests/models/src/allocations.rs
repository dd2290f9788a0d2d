//! A counting allocator, for tests of code that must not allocate.

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

thread_local! {
    /// The number of allocations of this thread.
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

/// The system's allocator with a count of each thread's allocations. Tests install it as the global
/// allocator.
#[derive(Clone, Copy, Debug)]
pub struct CountingAllocator;

fn count_allocation() {
    // A thread that is ending no longer has its count.
    let _ = COUNT.try_with(|count| count.set(count.get() + 1));
}

// SAFETY: every call goes to the system's allocator with the arguments it came with.
unsafe impl GlobalAlloc for CountingAllocator {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count_allocation();
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc(layout) }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count_allocation();
        // SAFETY: the caller's promise is passed on.
        unsafe { System.alloc_zeroed(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        count_allocation();
        // SAFETY: the caller's promise is passed on.
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count_allocation();
        // SAFETY: the caller's promise is passed on.
        unsafe { System.realloc(pointer, layout, size) }
    }
}

/// Returns the number of this thread's allocations so far.
#[must_use]
pub fn allocation_count() -> u64 {
    COUNT.get()
}

/// Runs `act` and asserts that it doesn't allocate.
///
/// # Panics
/// `act` allocates; the message begins with `what`.
pub fn without_allocating<T>(what: &str, act: impl FnOnce() -> T) -> T {
    let before = allocation_count();
    let result = act();
    assert_eq!(allocation_count(), before, "{what} allocated");
    result
}
