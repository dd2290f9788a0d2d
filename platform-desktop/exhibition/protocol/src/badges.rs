//! The exchange by which a headset leases the numbers of badges from the booth.
//!
//! The booth leases blocks of 64 numbers. A block's random *serial* names this lease of it: a parcel that carries the
//! serial proves that its badge was leased. Every heartbeat lists the blocks that the headset holds, and every answer
//! those that it holds from then on.

use paros_core::badge::LEASED_BLOCKS;
use paros_core::limits::BLOCK_NUMBERS;
use serde::{Deserialize, Serialize};

use crate::limits::MAX_HELD_BLOCKS;
use crate::{BlockSerial, ProtocolError, expect};

/// A block of numbers that a headset holds.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct HeldBlock {
    /// The block, below [`LEASED_BLOCKS`].
    pub block: u16,
    /// Names this lease of the block.
    pub serial: BlockSerial,
    /// The place of the next number in the block, 0 to 64; 64 if it is used up. The greater one counts.
    pub next: u8,
}

/// The blocks that a headset holds.
#[derive(Clone, PartialEq, Eq, Default, Debug, Serialize, Deserialize)]
pub struct BadgeReport {
    /// Random bits that the headset draws when it has no saved lease. With a new epoch, all blocks of the one before are
    /// gone: nobody knows which of their numbers were shown.
    pub epoch: u64,
    /// At most [`MAX_HELD_BLOCKS`], used-up ones too until the booth has heard of them.
    pub blocks: Vec<HeldBlock>,
}

impl HeldBlock {
    /// `true` if no number is left.
    #[must_use]
    pub const fn is_used_up(&self) -> bool {
        self.next as usize >= BLOCK_NUMBERS
    }
}

impl BadgeReport {
    /// `true` if it has an epoch, and no more blocks than a headset holds, all different.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.check().is_ok()
    }

    pub(crate) fn check(&self) -> Result<(), ProtocolError> {
        expect(self.epoch != 0, "epoch", "random bits, not 0")?;
        check_blocks(&self.blocks, "blocks")
    }
}

/// Checks blocks of a report or an answer.
pub(crate) fn check_blocks(blocks: &[HeldBlock], field: &'static str) -> Result<(), ProtocolError> {
    let is_block = |held: &HeldBlock| {
        usize::from(held.block) < LEASED_BLOCKS && usize::from(held.next) <= BLOCK_NUMBERS
    };
    let is_new = |at: usize| blocks[..at].iter().all(|other| other.block != blocks[at].block);
    let is_right = blocks.len() <= MAX_HELD_BLOCKS
        && blocks.iter().all(is_block)
        && (0..blocks.len()).all(is_new);
    expect(is_right, field, "up to two different blocks, with places of 0 to 64")
}
