//! The demos: scripted sessions that carve the lump, one to the figure hidden in it, one to a lantern.
//!
//! A script reads the world, its volume and contacts, and produces tick inputs. It has no other state and no
//! clock, so its digests are the same on every machine.

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
use scripted_hands::ScriptedHands;
pub use scripted_hands::TickWatcher;

/// The right hand does the work; the left turns the stool.
const RIGHT: usize = 1;

/// The azimuths of the block's sides in degrees. Each is turned to the visitor in this order.
const SIDES: [f32; 4] = [0.0, 90.0, 180.0, 270.0];

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

/// Returns the horizontal unit vector at an angle in degrees from +z towards +x.
fn direction_at_azimuth(degrees_from_z_to_x: f32) -> Vec3 {
    let radians = degrees_from_z_to_x.to_radians();
    Vec3::new(libm::sinf(radians), 0.0, libm::cosf(radians))
}

/// Returns the numbers from `first` to `last_inclusive` in steps of `step`, which may be negative.
fn evenly_spaced(first: f32, last_inclusive: f32, step: f32) -> impl Iterator<Item = f32> {
    let count = ((last_inclusive - first) / step).floor() as usize;
    (0..=count).map(move |i| first + step * i as f32)
}
