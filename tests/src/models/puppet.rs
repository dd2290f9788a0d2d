//! A visitor on strings: single motions, for tests that tell a story.

use glam::{Quat, Vec3};
use paros_core::events::Event;
use paros_core::input::{HandInput, Input, Pointer, RawPose};
use paros_core::pose::Pose;
use paros_core::size::{Grid, Size};
use paros_core::workbench::Item;

use super::dense::Dense;
use super::studio::Studio;
use super::visitor::at;

/// The left hand.
pub const LEFT: usize = 0;
/// The right hand.
pub const RIGHT: usize = 1;

/// A tracked hand, pointing ahead.
pub fn hand_at(position: Vec3) -> HandInput {
    let pose = RawPose::new(position, Quat::IDENTITY);
    HandInput { aim: pose, grip: pose, tracked: true, ..HandInput::default() }
}

/// An input with one hand, the other out of sight.
pub fn with(hand: usize, input: HandInput) -> Input {
    let mut all = Input::default();
    all.hands[hand] = input;
    all
}

/// A squeeze, and the hand open again.
pub fn squeeze(studio: &mut Studio<64>, hand: usize, position: Vec3) -> Vec<Event> {
    studio.step(&with(hand, HandInput { squeeze: 255, ..hand_at(position) }));
    let events = studio.world.events().to_vec();
    studio.step(&with(hand, hand_at(position)));
    events
}

/// Has a thing put into a hand.
pub fn take<const N: usize>(studio: &mut Studio<N>, hand: usize, item: Item)
where
    Grid<N>: Size,
{
    let pointer = Pointer::Take { hand: hand as u8, item: item.number() as u8 };
    studio.step(&Input { pointer, ..Input::default() });
}

/// A tick with the held bit at a place of the grid.
pub fn reach<const N: usize>(studio: &mut Studio<N>, hand: usize, position: Vec3, trigger: bool)
where
    Grid<N>: Size,
{
    let pose = Pose { position, rotation: Quat::IDENTITY };
    let input =
        HandInput { trigger: if trigger { 255 } else { 0 }, ..at(&studio.world, hand, &pose) };
    studio.step(&with(hand, input));
}

/// A stroke from one place to another, trigger pulled; then the bit is out of the way.
pub fn stroke(studio: &mut Studio<64>, hand: usize, from: Vec3, to: Vec3, ticks: u32) {
    reach(studio, hand, from, false);
    for i in 1..=ticks {
        reach(studio, hand, from.lerp(to, i as f32 / ticks as f32), true);
    }
    reach(studio, hand, to, false);
    reach(studio, hand, to + Vec3::Y * 40.0, false);
}

/// A floor of stone up to `height`.
pub fn floor(studio: &mut Studio<64>, height: usize) {
    studio.start_from(|[_, y, _]| y < height);
}

/// What stands.
pub fn voxels(studio: &Studio<64>) -> Dense {
    Dense::from_plane(studio.world.volume().rows())
}
