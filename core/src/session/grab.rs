//! Grabbing, releasing and swapping: items of the bench, and the stool by its rim.

use glam::Vec3;

use crate::session::events::WorldEvent;
use crate::session::hand::HandPresses;
use crate::session::state::SessionState;
use crate::session::step::metres_from_um;
use crate::session::stool_frame::distance_from_stool_rim;
use crate::session::workbench::{BenchItem, GRAB_DISTANCE};
use crate::session::world::World;
use crate::volume::size::{Grid, Size};

/// The target of a hand's squeeze.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum GrabTarget {
    /// An item of the bench, wherever it lies.
    Item(BenchItem),
    /// The stool's rim: the stool turns with the hand as long as it is squeezed.
    Stool,
}

impl<const N: usize, const K: usize> World<N, K>
where
    Grid<N>: Size,
{
    /// Returns what a squeeze of a hand would grab at its position: the nearest item in reach, or else the
    /// stool if the hand is empty. Returns `None` if hands may not work, or if the hand isn't tracked.
    #[must_use]
    pub fn grab_target(&self, hand: usize) -> Option<GrabTarget> {
        let hand = hand & 1;
        let may_work = self.state.session == SessionState::Sculpting
            && self.state.visit.phase().lets_hands_work();
        self.find_grab_target(hand).filter(|_| may_work && self.state.hands[hand].tracked)
    }

    fn find_grab_target(&self, hand: usize) -> Option<GrabTarget> {
        let (state, bench) = (&self.state.hands[hand], &self.state.bench);
        let held = bench.held_tool(hand);
        let grip: Vec3 = state.grip.0;
        let tip = held.map(|tool| state.bit_centre_pose(metres_from_um(tool.length_um())).0);
        let item = bench.nearest_in_reach(hand, grip, tip.unwrap_or(grip));
        let is_at_rim = held.is_none() && distance_from_stool_rim(grip) < GRAB_DISTANCE;
        item.map(GrabTarget::Item).or(is_at_rim.then_some(GrabTarget::Stool))
    }

    /// On the edge of a squeeze: grabs the item or stool in reach, else releases the held tool.
    pub(crate) fn grab_or_release_on_squeeze(&mut self, hand: usize, presses: HandPresses) {
        if !presses.squeezed {
            return;
        }
        let grip = self.state.hands[hand].grip;
        match self.find_grab_target(hand) {
            Some(GrabTarget::Item(item)) => self.take_item(hand, item),
            Some(GrabTarget::Stool) => self.state.hands[hand].holds_stool = true,
            None => {
                if let Some(tool) = self.state.bench.let_tool_fall_or_return_home(hand, grip) {
                    self.state.hands[hand].invalidate_bit_pose();
                    self.push_event(WorldEvent::Released { hand: hand as u8, tool });
                }
            }
        }
    }

    /// Puts an item into a hand, or mounts a bit on the hand's tool.
    pub(crate) fn take_item(&mut self, hand: usize, item: BenchItem) {
        let other = self.state.bench.held_tool(1 - hand);
        if self.state.bench.try_take_item(hand, item) {
            self.state.hands[hand].invalidate_bit_pose();
            self.state.hands[hand].holds_stool = false;
            if self.state.bench.held_tool(1 - hand) != other {
                self.state.hands[1 - hand].invalidate_bit_pose();
            }
            self.push_event(WorldEvent::Took { hand: hand as u8, item });
        }
    }

    /// Swaps the tools of the two hands. Resets their state: a tool runs again only after its hand's trigger
    /// is released and pulled. Does nothing if no hand holds a tool, or if a tool would move to a hand that
    /// isn't tracked and would be invisible.
    pub(crate) fn swap_hands(&mut self, presses: &mut [HandPresses; 2]) {
        let held = [0, 1].map(|hand| self.state.bench.held_tool(hand));
        let gets_lost = |hand: usize| held[1 - hand].is_some() && !self.state.hands[hand].tracked;
        if held == [None; 2] || gets_lost(0) || gets_lost(1) {
            return;
        }
        self.state.bench.swap_held_tools(held);
        for (state, presses) in self.state.hands.iter_mut().zip(presses) {
            state.end_pull();
            state.holds_stool = false;
            presses.pulled = false;
        }
        self.push_event(WorldEvent::HandsSwapped);
    }
}
