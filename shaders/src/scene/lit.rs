//! Highlight of what a squeeze would take: items of the bench, and the stool.

use paros_core::World;
use paros_core::session::{BenchItem, GrabTarget};
use paros_core::volume::{Grid, Size};

use super::assembly::PLAIN;

/// Colour factors and emissive part of a lit item: warm, and bright in the shade too.
pub const LIT: [f32; 4] = [1.3, 1.08, 0.75, 0.7];

/// Colour factors and emissive part of the lit stool, which is large and bright itself.
pub const LIT_STOOL: [f32; 4] = [1.2, 1.05, 0.82, 0.25];

/// The lit targets of a frame: what each hand's squeeze would take, and the stool while a hand holds it.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct LitTargets([Option<GrabTarget>; 2]);

impl LitTargets {
    pub(super) fn of_hands<const N: usize, const K: usize>(world: &World<N, K>) -> Self
    where
        Grid<N>: Size,
    {
        LitTargets([0, 1].map(|hand| {
            let holds = world.hand_state(hand).holds_stool;
            world.grab_target(hand).filter(|_| !holds).or(holds.then_some(GrabTarget::Stool))
        }))
    }

    /// Returns an item's tint; a tool's bit has the tool's tint.
    pub(super) fn item_tint(&self, item: BenchItem) -> [f32; 4] {
        if self.0.contains(&Some(GrabTarget::Item(item))) { LIT } else { PLAIN }
    }

    pub(super) fn stool_tint(&self) -> [f32; 4] {
        if self.0.contains(&Some(GrabTarget::Stool)) { LIT_STOOL } else { PLAIN }
    }
}
