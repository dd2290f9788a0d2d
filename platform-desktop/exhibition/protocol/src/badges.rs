//! Badge leases: how a headset leases blocks of badge numbers from the booth.
//!
//! The booth leases blocks of 64 numbers. A random *serial* identifies each lease of a block: a parcel that
//! carries the serial proves that its badge was leased. Every heartbeat lists the blocks that the headset
//! holds. Every answer lists the blocks that the headset holds from then on.

use paros_core::badge::LEASED_BLOCKS;
use paros_core::limits::BLOCK_NUMBERS;
use serde::{Deserialize, Serialize};

use crate::limits::MAX_HELD_BLOCKS;
use crate::{BlockSerial, ProtocolError, expect};

/// A block of badge numbers that a headset holds.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct HeldBlock {
    /// The block, below [`LEASED_BLOCKS`].
    pub block: u16,
    /// The serial of this lease of the block.
    pub serial: BlockSerial,
    /// The index of the next unused number in the block, 0 to 64; 64 if the block is used up. If the booth
    /// and the headset differ, the greater index counts.
    pub next: u8,
}

/// The blocks that a headset holds.
#[derive(Clone, PartialEq, Eq, Default, Debug, Serialize, Deserialize)]
pub struct BadgeReport {
    /// Random bits that the headset draws when it has no saved lease. A new epoch invalidates all blocks of
    /// the previous epoch, since their used numbers are unknown.
    pub epoch: u64,
    /// At most [`MAX_HELD_BLOCKS`]. A used-up block stays in the list until the booth has acknowledged it.
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
    /// `true` if the epoch isn't 0, and the blocks are distinct, in range and at most [`MAX_HELD_BLOCKS`].
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.check().is_ok()
    }

    pub(crate) fn check(&self) -> Result<(), ProtocolError> {
        expect(self.epoch != 0, "epoch", "random bits, not 0")?;
        check_blocks(&self.blocks, "blocks")
    }
}

/// Checks the blocks of a report or an answer.
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
