//! The connections between the parts of a tick: each change reaches the other parts.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::Vec3;
use paros_core::session::{BenchItem, Tool};
use paros_core::volume::Axis;
use paros_core::{RangeMaps, WorldEvent};
use paros_models::scripted_hand::{LEFT, RIGHT, step_with_bit_at, take_item};
use paros_models::world_harness::{WorldHarness, maps_are_equal};

static HARNESS: Mutex<WorldHarness<64>> = Mutex::new(WorldHarness::new());

fn lock_harness() -> MutexGuard<'static, WorldHarness<64>> {
    HARNESS.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Number of ticks after which a pass with few row visits has ended, whatever the hands do.
const SHORT_PASS: usize = 24;

/// Starts with a floor, and a block high above it that no edit has touched.
fn start_with_hovering_block(harness: &mut WorldHarness<64>) {
    harness.start_from_voxels(|[x, y, z]| {
        y < 10 || (30..36).contains(&y) && (28..36).contains(&x) && (50..58).contains(&z)
    });
}

/// Returns the number of voxels removed by an island pass in the last tick.
fn count_fallen_voxels(harness: &WorldHarness<64>) -> u32 {
    let fallen = harness.world.events().iter().map(|event| match event {
        WorldEvent::Islands(report) => report.removed,
        _ => 0,
    });
    fallen.sum()
}

/// Copies the columns in the dirty rectangles of the last tick.
fn copy_dirty_columns(harness: &WorldHarness<64>, stale: &mut RangeMaps<64>) {
    let maps = harness.world.volume().maps();
    for axis in Axis::ALL {
        for rect in harness.world.dirty_rects().rects(axis) {
            for line in rect.first.0..=rect.last.0 {
                for place in rect.first.1..=rect.last.1 {
                    let at = (line.into(), place.into());
                    stale.set_column(axis, at, maps.column(axis, at));
                }
            }
        }
    }
}

#[test]
fn islands_that_fall_are_dirty() {
    static STALE: Mutex<RangeMaps<64>> = Mutex::new(RangeMaps::new());
    let (mut harness, mut stale) = (lock_harness(), STALE.lock().unwrap());
    start_with_hovering_block(&mut harness);
    stale.copy_from(harness.world.volume().maps());
    take_item(&mut harness, RIGHT, BenchItem::Tool(Tool::Rotary));
    step_with_bit_at(&mut harness, RIGHT, Vec3::new(10.5, 11.0, 10.5), true);
    let mut fallen = count_fallen_voxels(&harness);
    copy_dirty_columns(&harness, &mut stale);
    for _ in 0..SHORT_PASS {
        // The hand rests far from where the block falls.
        step_with_bit_at(&mut harness, RIGHT, Vec3::new(10.5, 40.0, 10.5), false);
        fallen += count_fallen_voxels(&harness);
        copy_dirty_columns(&harness, &mut stale);
        assert!(maps_are_equal(&stale, harness.world.volume().maps()), "a column isn't dirty");
    }
    assert_eq!(fallen, 6 * 8 * 8);
}

#[test]
fn an_edit_that_only_fills_calls_for_a_pass() {
    let mut harness = lock_harness();
    start_with_hovering_block(&mut harness);
    take_item(&mut harness, LEFT, BenchItem::Tool(Tool::FillGun));
    let (mut added, mut fallen) = (0, 0);
    for tick in 0..SHORT_PASS {
        let along = 10.5 + 0.2 * tick as f32;
        step_with_bit_at(&mut harness, LEFT, Vec3::new(along, 11.0, 10.5), true);
        let report = harness.world.edit_report(LEFT);
        assert_eq!(report.removed, 0);
        added += report.added;
        fallen += count_fallen_voxels(&harness);
    }
    assert!(added > 0);
    assert_eq!(fallen, 6 * 8 * 8);
}
