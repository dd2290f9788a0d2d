//! The lantern: the lump with six slots that wind up its sides, cut through to a post in the middle.
//!
//! Most of the hollow is visible along no axis: it lies behind the stone between the slots and under the
//! roof. With one interval per column, closure would fill it again.

use glam::Vec3;
use paros_core::session::{BenchItem, SessionMode, Tool, ToolBit, commands};
use paros_core::volume::{Grid, Size};

use super::scripted_hands::{ScriptedHands, StoneAndMaskDistances};
use super::{Chapter, RIGHT, direction_at_azimuth, evenly_spaced};

/// Slots round the lantern.
const SLOTS: usize = 6;

/// The distance between the three cuts side by side that make a slot.
const ASIDE: f32 = 8.0;

/// The angle by which a slot winds round the lantern from its lower to its upper end, in degrees.
const TWIST_DEGREES: f32 = 40.0;

/// The heights of the lowest and the highest cut of a slot, in 1/128 of the block's edge.
const SLOT_HEIGHTS: [f32; 2] = [24.0, 92.0];

/// The distances from the axis at which a cut ends, and at which it begins, clear of the block.
const POST: f32 = 16.0;
const FAR: f32 = 98.0;

/// Carves the lantern out of the free-form lump.
pub(super) fn carve_lantern<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    mut done: impl FnMut(Chapter, &ScriptedHands<'_, '_, N, K>),
) where
    Grid<N>: Size,
{
    hands.start_session(SessionMode::FreeForm);
    done(Chapter::Stone, hands);
    hands.fetch_item(RIGHT, BenchItem::Tool(Tool::Rotary));
    hands.fetch_item(RIGHT, BenchItem::Bit(ToolBit::LargeBall));
    for slot in 0..SLOTS {
        cut_slot(hands, 360.0 / SLOTS as f32 * slot as f32);
        if 2 * (slot + 1) == SLOTS {
            done(Chapter::HalfSlotted, hands);
        }
    }
    hands.move_hand_to_rest(RIGHT);
    hands.wait_ticks(36);
    hands.send_commands(commands::FINISH);
    done(Chapter::Slotted, hands);
}

/// Cuts a slot from the top down, by successive plunges towards the axis.
fn cut_slot<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    degrees_from_z_to_x: f32,
) where
    Grid<N>: Size,
{
    let unit = N as f32 / 128.0;
    let [low, high] = SLOT_HEIGHTS;
    hands.turn_azimuth_to_visitor(degrees_from_z_to_x);
    for below in evenly_spaced(0.0, high - low, 5.0) {
        let twist = TWIST_DEGREES * (0.5 - below / (high - low));
        let out = direction_at_azimuth(degrees_from_z_to_x + twist);
        for aside in [-ASIDE, 0.0, ASIDE] {
            let middle = Vec3::new(64.0, high - below, 64.0) + Vec3::Y.cross(out) * aside;
            plunge_bit(hands, (middle + out * FAR) * unit, -out, (FAR - POST) * unit, 1.0);
        }
    }
    hands.move_hand_to_rest(RIGHT);
}

/// Plunges the bit along `direction` and back out. Does nothing if there is less than `min_depth_voxels` of
/// stone before the mask or `max_travel_voxels`.
fn plunge_bit<const N: usize, const K: usize>(
    hands: &mut ScriptedHands<'_, '_, N, K>,
    start_voxels: Vec3,
    direction: Vec3,
    max_travel_voxels: f32,
    min_depth_voxels: f32,
) where
    Grid<N>: Size,
{
    let StoneAndMaskDistances { stone: Some(stone), mask } =
        hands.cast_ray_to_stone_and_mask(start_voxels, direction)
    else {
        return;
    };
    // The bit enters by its own size beyond the surface that the ray meets; the mask stops it.
    let end = mask.unwrap_or(max_travel_voxels).min(max_travel_voxels);
    if end - stone < min_depth_voxels || hands.has_ended() {
        return;
    }
    let clear = 0.075 * N as f32;
    let outside = start_voxels + direction * (stone - clear).max(0.0);
    hands.move_bit_to(RIGHT, start_voxels, direction);
    hands.move_bit_to(RIGHT, outside, direction);
    hands.drive_bit(RIGHT, outside, direction, end - stone + clear);
    // The trigger stays down until the bit is out: a bit that is switched off could stick in a curved hole.
    hands.move_bit_to(RIGHT, start_voxels, direction);
    hands.release_trigger(RIGHT);
}
