//! Reports and answers by which a headset and the booth agree on a lease.
//!
//! Either may be lost, late or doubled. A report says all that was taken so far, an answer all that is left, so the
//! newest one makes up for all before.

use heapless::Vec;

use crate::badge::code::BadgeNumber;
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::limits::{BLOCK_NUMBERS, MAX_LEASED_BLOCKS};

/// The blocks of a lease, in the order of their use.
pub type LeasedBlocks = Vec<LeasedBlock, MAX_LEASED_BLOCKS>;

/// The tail of a block of numbers: one at least, the last one of the block always among them.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LeasedBlock {
    block: u16,
    first: u8,
}

/// What a headset tells the booth.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct LeaseReport {
    /// The headset's number, which outlives a wipe.
    pub headset: u32,
    /// Which lease of this headset it is about: drawn at random at its start.
    pub epoch: u64,
    /// The report's own number within the epoch, from 1.
    pub report: u32,
    /// Leased numbers that were taken in this epoch.
    pub taken: u32,
}

/// What the booth tells a headset.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct LeaseAnswer {
    /// Of the report.
    pub headset: u32,
    /// Of the report.
    pub epoch: u64,
    /// Of the report.
    pub report: u32,
    /// Of the report; more where the lease is behind what the booth knows, as one brought back from a copy.
    pub taken: u32,
    /// Whether the booth doesn't know this epoch, or not any more. Its numbers belong to others.
    pub is_void: bool,
    /// All that the headset holds once it has taken `taken` numbers.
    pub blocks: LeasedBlocks,
}

impl LeasedBlock {
    /// Length of a written block in bytes.
    pub(crate) const BYTES: usize = 3;

    /// The numbers of a block from place `first` on; `None` where there is no such block, or no number.
    #[must_use]
    pub fn new(block: u16, first: u8) -> Option<Self> {
        BadgeNumber::of_block(block, first).map(|_| LeasedBlock { block, first })
    }

    /// Which of [`LEASED_BLOCKS`](super::LEASED_BLOCKS) it is.
    #[must_use]
    pub const fn block(self) -> u16 {
        self.block
    }

    /// Numbers in it, 1 to [`BLOCK_NUMBERS`].
    #[must_use]
    pub const fn count(self) -> u32 {
        BLOCK_NUMBERS as u32 - self.first as u32
    }

    /// Its first number.
    pub(crate) fn first_number(self) -> Option<BadgeNumber> {
        BadgeNumber::of_block(self.block, self.first)
    }

    /// What is left without its first `taken` numbers; `None` if nothing is.
    #[must_use]
    pub fn without_first(self, taken: u32) -> Option<Self> {
        let first = u32::from(self.first).saturating_add(taken);
        u8::try_from(first).ok().and_then(|first| LeasedBlock::new(self.block, first))
    }
}

/// The blocks without their first `taken` numbers.
pub(crate) fn skip_taken(blocks: &[LeasedBlock], mut taken: u32) -> LeasedBlocks {
    let mut rest = LeasedBlocks::new();
    for block in blocks {
        if let Some(tail) = block.without_first(taken) {
            // It has no more blocks than the lease that it comes from.
            let _ = rest.push(tail);
        }
        taken = taken.saturating_sub(block.count());
    }
    rest
}

/// Length of written blocks in bytes.
pub(crate) const fn blocks_bytes() -> usize {
    1 + MAX_LEASED_BLOCKS * LeasedBlock::BYTES
}

/// Writes how many there are, and as many as there may be: zeros after the last one.
pub(crate) fn write_blocks(to: &mut ByteWriter<'_>, blocks: &LeasedBlocks) {
    to.u8(blocks.len() as u8);
    for i in 0..MAX_LEASED_BLOCKS {
        let LeasedBlock { block, first } =
            blocks.get(i).copied().unwrap_or(LeasedBlock { block: 0, first: 0 });
        to.u16(block);
        to.u8(first);
    }
}

/// Reads what [`write_blocks`] wrote.
pub(crate) fn read_blocks(from: &mut ByteReader<'_>) -> Result<LeasedBlocks, BadBytes> {
    let bad = from.error_here("up to 6 blocks");
    let count = usize::from(from.u8()?);
    if count > MAX_LEASED_BLOCKS {
        return Err(bad);
    }
    let mut blocks = LeasedBlocks::new();
    for i in 0..MAX_LEASED_BLOCKS {
        let bad = from.error_here("another block, a place in it, and zeros after the last one");
        let (block, first) = (from.u16()?, from.u8()?);
        if i >= count {
            if (block, first) != (0, 0) {
                return Err(bad);
            }
            continue;
        }
        let leased = LeasedBlock::new(block, first).ok_or(bad)?;
        let is_new = blocks.iter().all(|other| other.block != block);
        if !is_new || blocks.push(leased).is_err() {
            return Err(bad);
        }
    }
    Ok(blocks)
}
