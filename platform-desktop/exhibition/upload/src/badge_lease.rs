//! The blocks of badge numbers that this device holds. A number is marked as used on the disk before its
//! badge is shown.

use paros_core::badge::BadgeNumber;
use paros_protocol::limits::MAX_HELD_BLOCKS;
use paros_protocol::{BadgeReport, BlockSerial, HeldBlock, append_hash, split_hash};
use serde::{Deserialize, Serialize};

use super::folder::OutboxFolder;

/// The file of the lease, beside the parcels: JSON and its SHA-256.
const FILE: &str = "badges.lease";

/// Largest file in bytes: four times what it takes.
const MAX_FILE_BYTES: u64 = 4096;

/// A lease of badge numbers. They are used in order, and each at most once.
#[derive(Clone, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub(super) struct BadgeLease {
    report: BadgeReport,
    /// The blocks that were given up last. A later parcel may still carry one of their numbers.
    former: Vec<HeldBlock>,
}

impl BadgeLease {
    /// Reads the lease in a folder. If it is missing or damaged, starts a new epoch from these random bits,
    /// and the booth leases other blocks.
    pub(super) fn open(folder: &impl OutboxFolder, epoch: u64) -> Self {
        let read = folder.read(FILE, MAX_FILE_BYTES).ok();
        let Some(mut lease) = read.and_then(|bytes| parse(&bytes)) else {
            let report = BadgeReport { epoch, blocks: Vec::new() };
            return BadgeLease { report, former: Vec::new() };
        };
        // On a storage that can't sync folders, a power cut may have undone the last write, whose number may
        // have been shown.
        if let Some(held) = lease.next_block() {
            held.next += 1;
        }
        lease
    }

    /// Returns the badge report of the next heartbeat.
    pub(super) const fn report(&self) -> &BadgeReport {
        &self.report
    }

    /// Takes the number of the next badge, and saves that it is used. Returns a provisional number of
    /// `random` bits if no number is left or the disk fails.
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

    /// Returns the serial of the lease that a number belongs to.
    pub(super) fn serial_of(&self, number: BadgeNumber) -> Option<BlockSerial> {
        let (block, place) = number.block_and_place()?;
        let mut known = self.report.blocks.iter().chain(&self.former);
        let held = known.find(|held| held.block == block && place < held.next)?;
        Some(held.serial)
    }

    /// Applies the booth's answer to a report: the blocks that this device holds from now on.
    pub(super) fn take_answer(&mut self, folder: &mut impl OutboxFolder, answer: &[HeldBlock]) {
        let known = self.report.blocks.iter().chain(&self.former);
        let of_answer = |new: &HeldBlock| {
            let mut same = known.clone().filter(|held| held.serial == new.serial);
            // Numbers may have been used since the report was made.
            HeldBlock { next: same.next().map_or(new.next, |held| held.next.max(new.next)), ..*new }
        };
        let blocks: Vec<HeldBlock> = answer.iter().map(of_answer).collect();
        if blocks == self.report.blocks {
            return;
        }
        let is_gone = |held: &HeldBlock| blocks.iter().all(|new| new.serial != held.serial);
        let gone: Vec<HeldBlock> = known.copied().filter(is_gone).take(MAX_HELD_BLOCKS).collect();
        (self.report.blocks, self.former) = (blocks, gone);
        // If this fails, the lease is saved with the next badge, before the badge is shown.
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
        // Restart with another random epoch. The disk may have lost the last write.
        let mut lease = BadgeLease::open(&folder, 6);
        assert_eq!(lease.report().epoch, 5);
        // An answer to an outdated report.
        lease.take_answer(&mut folder, &[held(7, 61), held(9, 0)]);
        assert_eq!(take(&mut lease, &mut folder), Some((7, 63)));
        assert_eq!(take(&mut lease, &mut folder), Some((9, 0)));
        assert_eq!(lease.report().blocks, [held(7, 64), held(9, 1)]);
        lease.take_answer(&mut folder, &[held(9, 1), held(11, 0)]);
        // A late parcel gets the serial of a former block. A number that was never shown has no serial.
        let number = |block, place| BadgeNumber::of_block(block, place).expect("a number");
        assert_eq!(lease.serial_of(number(7, 63)), Some(held(7, 0).serial));
        assert_eq!(lease.serial_of(number(9, 1)), None);
        assert_eq!(lease.serial_of(BadgeNumber::provisional(3)), None);
        // A restored booth still counts the block as leased.
        lease.take_answer(&mut folder, &[held(7, 10)]);
        assert_eq!(lease.report().blocks, [held(7, 64)]);
        assert!(take(&mut lease, &mut folder).is_none());
        lease.take_answer(&mut folder, &[held(13, 0)]);
        // A damaged file starts a new epoch.
        let file = path.join(FILE);
        let good = fs::read(&file).expect("it was written");
        for at in 0..good.len() {
            let mut bad = good.clone();
            bad[at] ^= 1;
            fs::write(&file, &bad).expect("room on the disk");
            assert_eq!(BadgeLease::open(&folder, 6).report().epoch, 6, "byte {at}");
        }
        // If the disk refuses writes, no leased number is shown.
        fs::remove_dir_all(&path).expect("it is there");
        assert!(take(&mut lease, &mut folder).is_none());
    }
}
