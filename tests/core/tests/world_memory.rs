//! A world's memory: all zero bytes at first, like new after a clear, and of a known size.

use std::mem::size_of;
use std::sync::{Mutex, PoisonError};

use paros_core::session::SessionState;
use paros_core::{RangeMaps, World};
use paros_models::random_visitor::RandomVisitor;
use paros_models::world_harness::WorldHarness;

static HARNESS: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());

#[test]
fn a_new_world_is_a_cleared_one() {
    let mut harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    harness.reset();
    let empty = harness.world.digest();
    static NEW: Mutex<World<64>> = Mutex::new(World::new());
    let new = NEW.lock().unwrap_or_else(PoisonError::into_inner);
    assert_eq!(new.digest(), empty);
    assert_eq!(new.recompute_digest(), empty);
    for seed in 0..4 {
        harness.start_from_voxels(|[x, y, z]| y < 4 || x % 9 < 2 && (z % 7 < 2 || y % 16 == 15));
        let mut visitor = RandomVisitor::new(seed);
        (0..150).for_each(|_| harness.step(&visitor.next_input()));
        assert_ne!(harness.world.digest(), empty);
        harness.world.clear();
        assert_eq!(harness.world.digest(), empty);
        assert_eq!(harness.world.recompute_digest(), empty);
        assert_eq!(
            (harness.world.tick(), harness.world.session_state()),
            (0, SessionState::Waiting)
        );
    }
}

#[test]
fn a_world_fits_its_memory() {
    let sizes = (size_of::<World<128>>(), size_of::<World<256>>());
    println!("World<128> is {} bytes, World<256> {}", sizes.0, sizes.1);
    assert!(sizes.0 <= 1 << 20 && sizes.1 <= 6 << 20, "{sizes:?}");
    assert_eq!(size_of::<RangeMaps<128>>(), 3 * 2 * 128 * 128);
}
