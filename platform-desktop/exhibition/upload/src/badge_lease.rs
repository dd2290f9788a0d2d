//! The blocks of badges' numbers that this device holds. They are on the disk as used before a badge is shown.

use paros_core::badge::BadgeNumber;
use paros_protocol::limits::MAX_HELD_BLOCKS;
use paros_protocol::{BadgeReport, BlockSerial, HeldBlock, append_hash, split_hash};
use serde::{Deserialize, Serialize};

use super::folder::OutboxFolder;

/// The lease's file, beside the parcels: JSON, and its SHA-256.
const FILE: &str = "badges.lease";

/// Bytes of the file at most: four times what it takes.
const MAX_FILE_BYTES: u64 = 4096;

/// A lease of numbers. They are used in order, and none is taken twice.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub(super) struct BadgeLease {
    report: BadgeReport,
    /// Blocks that were given up last: a parcel may yet carry a number of theirs.
    former: Vec<HeldBlock>,
}

impl BadgeLease {
    /// Reads the lease in a folder. One that isn't there or is damaged is given up: a new epoch begins, by these random bits,
    /// and the booth leases other blocks.
    pub(super) fn open(folder: &impl OutboxFolder, epoch: u64) -> Self {
        let read = folder.read(FILE, MAX_FILE_BYTES).ok();
        let Some(mut lease) = read.and_then(|bytes| parse(&bytes)) else {
            let report = BadgeReport { epoch, blocks: Vec::new() };
            return BadgeLease { report, former: Vec::new() };
        };
        // Where a storage can't sync folders, a loss of power takes the last write back: its number may have been shown.
        if let Some(held) = lease.next_block() {
            held.next += 1;
        }
        lease
    }

    /// What the next heartbeat tells the booth.
    pub(super) const fn report(&self) -> &BadgeReport {
        &self.report
    }

    /// Takes the number of the next badge, and notes so on the disk: the first that is left; or a provisional one of
    /// `random` bits, where none is or the disk refuses.
    pub(super) fn take_number(
        &mut self,
        folder: &mut impl OutboxFolder,
        random: u32,
    ) -> BadgeNumber {
        let provisional = BadgeNumber::provisional(random);
        let Some(held) = self.next_block() else { return provisional };
        let number = BadgeNumber::of_block(held.block, held.next);
        held.next += 1;
        number.filter(|_| self.save(folder)).unwrap_or(provisional)
    }

    fn next_block(&mut self) -> Option<&mut HeldBlock> {
        self.report.blocks.iter_mut().find(|held| !held.is_used_up())
    }

    /// The serial of the lease that a number is of.
    pub(super) fn serial_of(&self, number: BadgeNumber) -> Option<BlockSerial> {
        let (block, place) = number.block_and_place()?;
        let mut known = self.report.blocks.iter().chain(&self.former);
        let held = known.find(|held| held.block == block && place < held.next)?;
        Some(held.serial)
    }

    /// Takes the booth's answer to a report: what this device holds from now on.
    pub(super) fn take_answer(&mut self, folder: &mut impl OutboxFolder, answer: &[HeldBlock]) {
        let known = self.report.blocks.iter().chain(&self.former);
        let of_answer = |new: &HeldBlock| {
            let mut same = known.clone().filter(|held| held.serial == new.serial);
            // Numbers may have been taken since the report was made.
            HeldBlock { next: same.next().map_or(new.next, |held| held.next.max(new.next)), ..*new }
        };
        let blocks: Vec<HeldBlock> = answer.iter().map(of_answer).collect();
        if blocks == self.report.blocks {
            return;
        }
        let is_gone = |held: &HeldBlock| blocks.iter().all(|new| new.serial != held.serial);
        let gone: Vec<HeldBlock> = known.copied().filter(is_gone).take(MAX_HELD_BLOCKS).collect();
        (self.report.blocks, self.former) = (blocks, gone);
        // What isn't saved now is saved with the next badge, before that is shown.
        let _ = self.save(folder);
    }

    fn save(&self, folder: &mut impl OutboxFolder) -> bool {
        let Ok(json) = serde_json::to_vec(self) else { return false };
        folder.write(FILE, &append_hash(json)).is_ok()
    }
}

fn parse(file: &[u8]) -> Option<BadgeLease> {
    let (json, _) = split_hash(file)?;
    let lease: BadgeLease = serde_json::from_slice(json).ok()?;
    lease.report.is_valid().then_some(lease)
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::folder::DiskFolder;

    fn held(block: u16, next: u8) -> HeldBlock {
        HeldBlock { block, serial: BlockSerial([block as u8; 8]), next }
    }

    #[test]
    fn no_number_is_taken_twice_whatever_the_program_or_the_booth_forgets() {
        let path = std::env::temp_dir().join(format!("paros-lease-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        let mut folder = DiskFolder::open(&path).expect("room on the disk");
        let mut lease = BadgeLease::open(&folder, 5);
        assert_eq!(lease.report(), &BadgeReport { epoch: 5, blocks: Vec::new() });
        assert!(lease.take_number(&mut folder, 0).is_provisional(), "nothing is leased yet");
        lease.take_answer(&mut folder, &[held(7, 61), held(9, 0)]);
        let take = |lease: &mut BadgeLease, folder: &mut DiskFolder| {
            lease.take_number(folder, 0).block_and_place()
        };
        assert_eq!(take(&mut lease, &mut folder), Some((7, 61)));
        // The program ends, and another epoch is offered. The disk may have lost the last write.
        let mut lease = BadgeLease::open(&folder, 6);
        assert_eq!(lease.report().epoch, 5);
        // An answer to a report of before.
        lease.take_answer(&mut folder, &[held(7, 61), held(9, 0)]);
        assert_eq!(take(&mut lease, &mut folder), Some((7, 63)));
        assert_eq!(take(&mut lease, &mut folder), Some((9, 0)));
        assert_eq!(lease.report().blocks, [held(7, 64), held(9, 1)]);
        lease.take_answer(&mut folder, &[held(9, 1), held(11, 0)]);
        // A parcel that is made late has the serial of a block that was given up; what was never shown has none.
        let number = |block, place| BadgeNumber::of_block(block, place).expect("a number");
        assert_eq!(lease.serial_of(number(7, 63)), Some(held(7, 0).serial));
        assert_eq!(lease.serial_of(number(9, 1)), None);
        assert_eq!(lease.serial_of(BadgeNumber::provisional(3)), None);
        // A booth that came back from a backup says that it is leased still.
        lease.take_answer(&mut folder, &[held(7, 10)]);
        assert_eq!(lease.report().blocks, [held(7, 64)]);
        assert!(take(&mut lease, &mut folder).is_none());
        lease.take_answer(&mut folder, &[held(13, 0)]);
        // A damaged file is given up.
        let file = path.join(FILE);
        let good = fs::read(&file).expect("it was written");
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 1;
            fs::write(&file, &bad).expect("room on the disk");
            assert_eq!(BadgeLease::open(&folder, 6).report().epoch, 6, "byte {at}");
        }
        // Where the disk takes nothing, no leased number is shown.
        fs::remove_dir_all(&path).expect("it is there");
        assert!(take(&mut lease, &mut folder).is_none());
    }
}
