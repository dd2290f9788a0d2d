//! Tests of plans, frames and devices: one binary, so that the core is instantiated once.

use paros_models::allocations::CountingAllocator;

/// Counts allocations per thread, so that parallel tests don't disturb each other.
#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

mod devices;
mod mixer;
mod planner;
