//! The demos: scripted sessions, from the lump to the figure hidden in it, and to a lantern.
//!
//! The script reads the world, its volume and contacts, and answers with tick inputs. It has no other
//! state and no clock, so its digests are the same on every machine.

mod faces;
mod lantern;
mod owl;
mod rows;
mod saw;
mod script;
pub mod scripted_hands;
mod surface_pass;

use crate::tick_runner::TickRunner;
use glam::Vec3;
use paros_core::volume::{Grid, Size};

pub use script::{Chapter, DemoScript};
pub use scripted_hands::TickWatcher;
use scripted_hands::{ScriptedHands, StoneAndMaskDistances};

/// The right hand does the work; the left turns the stool.
const RIGHT: usize = 1;

/// Plays a session. Calls `watcher` after every tick and `after_chapter` at the end of every chapter.
pub fn play_demo<const N: usize, const K: usize>(
    script: DemoScript,
    runner: &mut TickRunner<'_, N, K>,
    watcher: &mut TickWatcher<'_, N, K>,
    mut after_chapter: impl FnMut(Chapter, &paros_core::World<N, K>),
) where
    Grid<N>: Size,
{
    let mut hands = ScriptedHands::new(runner, watcher);
    let done = |chapter, hands: &ScriptedHands<'_, '_, N, K>| after_chapter(chapter, hands.world());
    match script {
        DemoScript::Owl => owl::carve_owl(&mut hands, done),
        DemoScript::Lantern => lantern::carve_lantern(&mut hands, done),
    }
}

/// Plunges the bit along `direction` and back out. Does nothing where less than `min_depth_voxels`
/// of stone lie before the mask or `max_travel_voxels`.
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
    // The bit is let into what is left by its own size; the mask stops it.
    let end = mask.unwrap_or(max_travel_voxels).min(max_travel_voxels);
    if end - stone < min_depth_voxels || hands.has_ended() {
        return;
    }
    let clear = 0.075 * N as f32;
    let outside = start_voxels + direction * (stone - clear).max(0.0);
    hands.move_bit_to(RIGHT, start_voxels, direction);
    hands.move_bit_to(RIGHT, outside, direction);
    hands.drive_bit(RIGHT, outside, direction, end - stone + clear);
    // The trigger stays down until the bit is out: switched off, it could stick in a bent hole.
    hands.move_bit_to(RIGHT, start_voxels, direction);
    hands.release_trigger(RIGHT);
}

/// The horizontal unit vector at an angle in degrees from +z towards +x.
fn direction_at_azimuth(degrees_from_z_to_x: f32) -> Vec3 {
    let radians = degrees_from_z_to_x.to_radians();
    Vec3::new(libm::sinf(radians), 0.0, libm::cosf(radians))
}

/// The numbers from `first` to `last_inclusive` in steps of `step`, which may be negative.
fn evenly_spaced(first: f32, last_inclusive: f32, step: f32) -> impl Iterator<Item = f32> {
    let count = ((last_inclusive - first) / step).floor() as usize;
    (0..=count).map(move |i| first + step * i as f32)
}
