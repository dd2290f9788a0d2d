//! What is lit as a squeeze would take it: items of the bench, and the stool.

use paros_core::World;
use paros_core::session::{BenchItem, GrabTarget};
use paros_core::volume::{Grid, Size};

use super::assembly::PLAIN;

/// Colour factors of what is lit, and its emissive part: warm, and bright in the shade too.
pub const LIT: [f32; 4] = [1.3, 1.08, 0.75, 0.7];

/// The same of the stool, which is large and bright itself.
pub const LIT_STOOL: [f32; 4] = [1.2, 1.05, 0.82, 0.25];

/// What is lit in a frame: what each hand's squeeze would take, and the stool while one holds it.
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

    /// How an item is tinted; a tool with the bit on it.
    pub(super) fn item_tint(&self, item: BenchItem) -> [f32; 4] {
        if self.0.contains(&Some(GrabTarget::Item(item))) { LIT } else { PLAIN }
    }

    pub(super) fn stool_tint(&self) -> [f32; 4] {
        if self.0.contains(&Some(GrabTarget::Stool)) { LIT_STOOL } else { PLAIN }
    }
}
