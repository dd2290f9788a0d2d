//! Model of the sizes of bits and of their changes.

use paros_core::internals::ToolBitSpec;
use paros_core::session::{BitSize, HandState, PointerCommand, ToolBit};

use crate::step::StepModel;

impl<const K: usize> StepModel<K> {
    /// Changes the size of a hand's bit by the sum of its stick's and the pointer's steps.
    pub(super) fn resize_held_bit(&mut self, hand: usize, by_stick: i32, pointer: PointerCommand) {
        let by_pointer = match pointer {
            PointerCommand::Resize { hand: of, by } if usize::from(of % 2) == hand => by.into(),
            _ => 0,
        };
        if let Some((_, bit)) = self.bench.held(hand) {
            self.bench.resize(bit, by_stick + by_pointer);
        }
    }

    /// Returns a bit's table entry, scaled to its present size.
    pub(super) fn spec_of(&self, bit: ToolBit) -> ToolBitSpec {
        let size = BitSize::of_bit(bit, self.bench.size_of(bit)).expect("it comes in this size");
        bit.spec_at(size)
    }
}

/// Advances the stick's push along y by a tick. A push begins at three quarters of the stick's range, if it
/// is further out than along x, and lasts while it is at least half way out. Returns a step in the first tick
/// of a push and in every 18th after it.
pub(super) fn push_stick(hand: &mut HandState, [x, y]: [i8; 2]) -> i32 {
    let (x, y, before) = (i32::from(x), i32::from(y), i32::from(hand.resize_push));
    let goes_on = before * y > 0 && y.abs() >= 64;
    let is_pushed = goes_on || (y.abs() >= 96 && y.abs() > x.abs());
    let ticks = match (is_pushed, goes_on) {
        (false, _) => 0,
        (true, false) => 1,
        (true, true) => before.abs() % 18 + 1,
    };
    hand.resize_push = (ticks * y.signum()) as i8;
    if ticks == 1 { y.signum() } else { 0 }
}
