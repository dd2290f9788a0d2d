//! Spalling at a hidden figure: all stone near a bit that touches the figure comes off, and none elsewhere.

use std::sync::{Mutex, PoisonError};

use glam::Vec3;
use paros_core::TickInput;
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit, commands};
use paros_models::dense::DenseVolume;
use paros_models::scripted_hand::{RIGHT, step_with_bit_at, take_item, volume_of};
use paros_models::world_harness::WorldHarness;

static HARNESS: Mutex<WorldHarness<128, 2>> = Mutex::new(WorldHarness::new());

/// A millimetre in voxels: the stone's box is 450 mm wide.
const MILLIMETRE: f32 = 128.0 / 450.0;
/// The height of the figure's top, and the thickness of the stone on and around it, in voxels.
const TOP: i32 = 50;
const COAT: i32 = 9;

/// Starts with a block under a coat of stone, and a hand with a bit over it.
fn start(harness: &mut WorldHarness<128, 2>, tool: Tool, bit: ToolBit) -> DenseVolume {
    let block = |grown: i32| {
        let sides = 40 - grown..88 + grown;
        DenseVolume::from_fn(128, |[x, y, z]| {
            sides.contains(&x) && sides.contains(&z) && y < TOP + grown
        })
    };
    let figure = block(0);
    harness.reset_to_voxels(&block(COAT), &figure);
    let start = SessionMode::Constrained { figure: 0 };
    harness.step(&TickInput { start, ..TickInput::default() });
    take_item(harness, RIGHT, BenchItem::Tool(tool));
    take_item(harness, RIGHT, BenchItem::Bit(bit));
    (0..10).for_each(|_| step_with_bit_at(harness, RIGHT, Vec3::new(64.0, 100.0, 64.0), false));
    figure
}

/// Presses the bit down onto the figure for some ticks. Calls `check` after each tick that removed stone, with the
/// world and the voxels that it removed.
fn press_down(
    harness: &mut WorldHarness<128, 2>,
    mut check: impl FnMut(&WorldHarness<128, 2>, &[Vec3]),
) {
    let mut before = volume_of(harness);
    for tick in 0..140 {
        let count = harness.world.volume().count_voxels();
        let height = (100.0 - 0.5 * tick as f32).max(TOP as f32);
        step_with_bit_at(harness, RIGHT, Vec3::new(64.0, height, 64.0), true);
        if harness.world.volume().count_voxels() == count {
            continue;
        }
        let after = volume_of(harness);
        let middle = |at: [i32; 3]| Vec3::from_array(at.map(|i| i as f32 + 0.5));
        let removed: Vec<Vec3> = before.difference(&after).occupied().map(middle).collect();
        check(harness, &removed);
        before = after;
    }
}

#[test]
fn stone_spalls_where_a_ball_touches_the_figure_and_nowhere_else() {
    let harness = &mut *HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    let figure = start(harness, Tool::Rotary, ToolBit::MediumBall);
    let whole = volume_of(harness);
    let (ball, spall) = (15.0 * MILLIMETRE, 34.0 * MILLIMETRE);
    let mut ticks = [0, 0];
    press_down(harness, |harness, removed| {
        let bit = harness.world.hand_state(RIGHT).frozen_pose.position;
        let touches = harness.world.hand_contact(RIGHT).is_some_and(|contact| contact.on_mask);
        ticks[usize::from(touches)] += 1;
        // The bit follows its hand by half a voxel a tick.
        let most = if touches { spall + 0.01 } else { ball + 0.6 };
        for &voxel in removed {
            assert!(voxel.distance(bit) < most, "{voxel} is too far from the bit at {bit}");
        }
    });
    assert!(ticks[0] > 5 && ticks[1] > 0, "{ticks:?}");
    let (left, bit) = (volume_of(harness), harness.world.hand_state(RIGHT).frozen_pose.position);
    for at in whole.occupied() {
        let is_near = Vec3::from_array(at.map(|i| i as f32 + 0.5)).distance(bit) < spall - 0.1;
        assert!(left.contains(at) || !figure.contains(at), "the figure lost {at:?}");
        assert!(!(left.contains(at) && is_near) || figure.contains(at), "{at:?} is left");
    }
    // One undo reverts the whole stroke.
    step_with_bit_at(harness, RIGHT, Vec3::new(64.0, 100.0, 64.0), false);
    harness.step(&TickInput { commands: commands::UNDO, ..TickInput::default() });
    assert!(volume_of(harness) == whole, "undone, the stone isn't whole");
}

/// A saw blade parts the stone and spalls none beside it.
#[test]
fn nothing_spalls_at_a_saw() {
    let harness = &mut *HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
    start(harness, Tool::Rotary, ToolBit::DiscSaw);
    let mut touched = false;
    press_down(harness, |harness, removed| {
        touched |= harness.world.hand_contact(RIGHT).is_some_and(|contact| contact.on_mask);
        for voxel in removed {
            assert!((voxel.x - 64.0).abs() < 3.0 || (voxel.z - 64.0).abs() < 3.0, "{voxel}");
        }
    });
    assert!(touched, "the blade doesn't reach the figure");
}
