//! Tests of plans, frames and devices: one binary, so that the core is instantiated once.

use paros_models::allocations::CountingAllocator;

/// Counts allocations a thread, so that tests of other threads don't disturb who counts.
#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

mod devices;
mod mixer;
mod planner;
