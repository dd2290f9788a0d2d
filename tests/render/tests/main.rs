//! Tests of pictures that need no GPU. All are one binary, so that the core is instantiated only once.

use paros_models::allocations::CountingAllocator;

/// Counts allocations by thread, so that tests in other threads don't disturb the count.
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
