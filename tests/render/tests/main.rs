//! Tests of the pictures that need no GPU: one binary, so that the core is instantiated once.

use paros_models::allocations::CountingAllocator;

/// Counts allocations a thread, so that tests of other threads don't disturb who counts.
#[global_allocator]
static ALLOCATOR: CountingAllocator = CountingAllocator;

mod alloc_field;
mod alloc_panels;
mod exposure;
mod fidelity;
mod field;
mod field_shapes;
mod field_upkeep;
mod figure;
mod guides;
mod lit;
mod marble;
mod outline;
mod panels;
mod pictures;
mod refusal;
mod room;
mod scene;
mod smooth;
mod twin;
