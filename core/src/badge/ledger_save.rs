//! A ledger as bytes, as the booth keeps it.
//!
//! Little-endian. `PBLG`; u16 version; u64 time; u16 days of retention; u16 the next turn; u32 the last
//! day on which a block was looked for, and u16 the blocks that it has left; for every block u8 numbers
//! spent, 128 more where it is held, and u32 the day from which it is free; u16 headsets; for each u32 number,
//! u64 epoch, u64 when it began, u64 former epochs, u32 report, u32 taken, u64 when it was reported and one more, or 0, u8 blocks, and a u16
//! for each that there may be; u64 checksum.

use heapless::Vec;

use crate::badge::code::LEASED_BLOCKS;
use crate::badge::ledger::{BadgeLedger, BlockState, HeadsetLease};
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::digest::checksum;
use crate::limits::{BLOCK_NUMBERS, DAY_BLOCKS, FORMER_EPOCHS, MAX_HEADSETS, MAX_LEASED_BLOCKS};

/// The first bytes of a saved ledger.
const MAGIC: [u8; 4] = *b"PBLG";

/// Changes with every change of the format.
const LEDGER_VERSION: u16 = 2;

/// In the byte of the numbers spent.
const IS_HELD: u8 = 128;

const HEADSET_BYTES: usize = 4 + 16 + 8 * FORMER_EPOCHS + 4 + 4 + 8 + 1 + 2 * MAX_LEASED_BLOCKS;

/// Before the blocks.
const HEAD_BYTES: usize = 24;

/// Bytes of a saved ledger at most: 158 KB.
pub const MAX_LEDGER_BYTES: usize =
    HEAD_BYTES + 5 * LEASED_BLOCKS + 2 + MAX_HEADSETS * HEADSET_BYTES + 8;

impl BadgeLedger {
    /// Writes the ledger at the front of `bytes`, and gives their number; more than there are where it doesn't fit.
    /// [`MAX_LEDGER_BYTES`] are always enough.
    pub fn save(&self, bytes: &mut [u8]) -> usize {
        let mut to = ByteWriter::new(bytes);
        self.write_body(&mut to);
        let len = to.len();
        if let Some((body, rest)) = bytes.split_at_mut_checked(len) {
            ByteWriter::new(rest).u64(checksum(body));
        }
        len + 8
    }

    fn write_body(&self, to: &mut ByteWriter<'_>) {
        to.bytes(&MAGIC);
        to.u16(LEDGER_VERSION);
        to.u64(self.now);
        to.u16(self.retention_days);
        to.u16(self.next_turn);
        to.u32(self.lease_day);
        to.u16(self.blocks_left);
        for state in &self.blocks {
            to.u8(state.spent | if state.is_held { IS_HELD } else { 0 });
            to.u32(state.free_on);
        }
        to.u16(self.headsets.len() as u16);
        for lease in &self.headsets {
            write_headset(lease, to);
        }
    }

    /// Becomes what [`BadgeLedger::save`] wrote.
    ///
    /// # Errors
    /// [`BadBytes`], and the ledger is as it was before.
    pub fn load(&mut self, bytes: &[u8]) -> Result<(), BadBytes> {
        check_sum(bytes)?;
        let from = &mut ByteReader::new(bytes);
        let head = read_head(from)?;
        // Looked at first, and taken over when all is right: a second ledger would be large.
        let blocks = from.bytes(5 * LEASED_BLOCKS)?;
        let headsets = read_headsets(from)?;
        from.bytes(8)?;
        from.expect_end()?;
        check_blocks(blocks, &headsets)?;
        for (state, bytes) in self.blocks.iter_mut().zip(blocks.chunks_exact(5)) {
            *state = read_block(bytes);
        }
        (self.now, self.retention_days, self.next_turn) =
            (head.now, head.retention_days, head.next_turn);
        (self.lease_day, self.blocks_left) = (head.lease_day, head.blocks_left);
        self.headsets = headsets;
        Ok(())
    }
}

fn check_sum(bytes: &[u8]) -> Result<(), BadBytes> {
    let offset = bytes.len().saturating_sub(8);
    let (body, sum) = bytes.split_at(offset);
    if ByteReader::new(sum).u64() == Ok(checksum(body)) {
        return Ok(());
    }
    Err(BadBytes { offset, expected: "the checksum of the bytes before" })
}

/// What stands before the blocks.
struct Head {
    now: u64,
    retention_days: u16,
    next_turn: u16,
    lease_day: u32,
    blocks_left: u16,
}

fn read_head(from: &mut ByteReader<'_>) -> Result<Head, BadBytes> {
    let bad = from.error_here("the magic PBLG");
    if from.bytes(4)? != MAGIC {
        return Err(bad);
    }
    let bad = from.error_here("version 2 of a ledger");
    if from.u16()? != LEDGER_VERSION {
        return Err(bad);
    }
    let (now, retention_days) = (from.u64()?, from.u16()?);
    let bad = from.error_here("the turn of a block");
    let next_turn = from.u16()?;
    if usize::from(next_turn) >= LEASED_BLOCKS {
        return Err(bad);
    }
    let lease_day = from.u32()?;
    let bad = from.error_here("no more blocks than a day has");
    let blocks_left = from.u16()?;
    if blocks_left > DAY_BLOCKS {
        return Err(bad);
    }
    Ok(Head { now, retention_days, next_turn, lease_day, blocks_left })
}

/// A block of five bytes.
fn read_block(bytes: &[u8]) -> BlockState {
    let from = &mut ByteReader::new(bytes);
    let (spent, free_on) = (from.u8().unwrap_or(0), from.u32().unwrap_or(0));
    BlockState { spent: spent & !IS_HELD, is_held: spent & IS_HELD != 0, free_on }
}

fn write_headset(lease: &HeadsetLease, to: &mut ByteWriter<'_>) {
    to.u32(lease.headset);
    to.u64(lease.epoch);
    to.u64(lease.begun_at);
    lease.former.iter().for_each(|epoch| to.u64(*epoch));
    to.u32(lease.report);
    to.u32(lease.taken);
    to.u64(lease.reported_at.map_or(0, |time| time.saturating_add(1)));
    to.u8(lease.blocks.len() as u8);
    for i in 0..MAX_LEASED_BLOCKS {
        to.u16(lease.blocks.get(i).copied().unwrap_or(0));
    }
}

fn read_headsets(from: &mut ByteReader<'_>) -> Result<Vec<HeadsetLease, MAX_HEADSETS>, BadBytes> {
    let mut headsets: Vec<HeadsetLease, MAX_HEADSETS> = Vec::new();
    for _ in 0..from.u16()? {
        let bad = from.error_here("up to 256 headsets, by their numbers");
        let lease = read_headset(from)?;
        let is_next = headsets.last().is_none_or(|last| last.headset < lease.headset);
        if !is_next || headsets.push(lease).is_err() {
            return Err(bad);
        }
    }
    Ok(headsets)
}

fn read_headset(from: &mut ByteReader<'_>) -> Result<HeadsetLease, BadBytes> {
    let (headset, epoch, begun_at) = (from.u32()?, from.u64()?, from.u64()?);
    let mut former = [0; FORMER_EPOCHS];
    for epoch in &mut former {
        *epoch = from.u64()?;
    }
    let (report, taken) = (from.u32()?, from.u32()?);
    let reported_at = from.u64()?.checked_sub(1);
    let bad = from.error_here("up to 6 blocks, and zeros after the last one");
    let count = usize::from(from.u8()?);
    let mut blocks = Vec::new();
    for i in 0..MAX_LEASED_BLOCKS {
        let block = from.u16()?;
        if if i < count { blocks.push(block).is_err() } else { block != 0 } {
            return Err(bad);
        }
    }
    if count > MAX_LEASED_BLOCKS {
        return Err(bad);
    }
    Ok(HeadsetLease { headset, epoch, begun_at, former, report, taken, reported_at, blocks })
}

/// Checks that no block has more numbers spent than it has, and that those are held of which a headset says so, by it
/// alone.
fn check_blocks(bytes: &[u8], headsets: &[HeadsetLease]) -> Result<(), BadBytes> {
    let mut held = 0;
    for (i, block) in bytes.chunks_exact(5).enumerate() {
        let BlockState { spent, is_held, .. } = read_block(block);
        held += usize::from(is_held);
        if usize::from(spent) > BLOCK_NUMBERS - usize::from(is_held) {
            let expected = "0 to 64 numbers spent, fewer of a block that is held";
            return Err(BadBytes { offset: HEAD_BYTES + 5 * i, expected });
        }
    }
    let offset = HEAD_BYTES + bytes.len();
    let bad = BadBytes { offset, expected: "each block that is held with one headset" };
    let mut listed = [0u64; LEASED_BLOCKS.div_ceil(64)];
    for block in headsets.iter().flat_map(|lease| &lease.blocks) {
        let block = usize::from(*block);
        let is_held = bytes.get(5 * block).is_some_and(|byte| byte & IS_HELD != 0);
        let word = listed.get_mut(block / 64).ok_or(bad)?;
        if !is_held || *word >> (block % 64) & 1 != 0 {
            return Err(bad);
        }
        *word |= 1 << (block % 64);
        held -= 1;
    }
    if held == 0 { Ok(()) } else { Err(bad) }
}
