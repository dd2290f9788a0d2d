//! The headset's side: which badge is next, with what the booth leased, for days without it, and without any.

use crate::badge::code::BadgeNumber;
use crate::badge::exchange::{
    LeaseAnswer, LeaseReport, LeasedBlocks, blocks_bytes, read_blocks, skip_taken, write_blocks,
};
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::digest::checksum;
use crate::limits::{ALLOWANCE_SECONDS, MAX_ALLOWANCE};

/// The first bytes of a saved lease.
const MAGIC: [u8; 4] = *b"PBLS";

/// Changes with every change of a saved lease's format.
const LEASE_VERSION: u16 = 1;

/// The length of what the checksum is of.
const BODY_BYTES: usize = 33 + blocks_bytes();

/// What a headset holds of the booth's numbers. They are used in order, and none is taken twice.
///
/// It takes a leased number while it has an *allowance*: full after an answer of the booth, one less with each number,
/// and one more every [`ALLOWANCE_SECONDS`]. So the booth knows how many numbers a headset can have shown at most that
/// it hasn't heard of, and gets the rest back where the headset's data was wiped.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BadgeLease {
    headset: u32,
    epoch: u64,
    /// Reports made so far.
    reports: u32,
    /// The report that the last answer taken was to.
    answered: u32,
    taken: u32,
    /// At most [`MAX_ALLOWANCE`].
    allowance: u8,
    /// Towards the next number of the allowance, below [`ALLOWANCE_SECONDS`].
    part_seconds: u32,
    /// What is left.
    blocks: LeasedBlocks,
}

/// What became of an answer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum AnswerOutcome {
    /// It is what the lease is now.
    Taken,
    /// It is another headset's or epoch's, or older than one that was taken.
    Ignored,
    /// The booth gave the lease's numbers to others: they are gone. Begin a lease of a new epoch.
    Void,
}

impl BadgeLease {
    /// Length of a saved lease in bytes.
    pub const BYTES: usize = BODY_BYTES + 8;

    /// A lease of nothing, for a headset without a saved one. `epoch` is drawn at random; `headset` is the same before
    /// and after a wipe, and no other headset's.
    #[must_use]
    pub const fn new(headset: u32, epoch: u64) -> Self {
        BadgeLease {
            headset,
            epoch,
            reports: 0,
            answered: 0,
            taken: 0,
            allowance: 0,
            part_seconds: 0,
            blocks: LeasedBlocks::new(),
        }
    }

    /// Leased numbers left.
    #[must_use]
    pub fn left(&self) -> u32 {
        self.blocks.iter().map(|block| block.count()).sum()
    }

    /// Leased numbers that it could take now without the booth.
    #[must_use]
    pub fn left_now(&self) -> u32 {
        self.left().min(u32::from(self.allowance))
    }

    /// Takes the number of the next badge: the first that is left, or a provisional one of `random_bits`, of which 18
    /// count. The lease is saved before the badge is shown.
    #[must_use]
    pub fn take_number(&mut self, random_bits: u32) -> BadgeNumber {
        let provisional = BadgeNumber::provisional(random_bits);
        let Some(first) = self.blocks.first_mut() else { return provisional };
        if self.allowance == 0 || self.taken == u32::MAX {
            return provisional;
        }
        let number = first.first_number().unwrap_or(provisional);
        if let Some(tail) = first.without_first(1) {
            *first = tail;
        } else {
            self.blocks.remove(0);
        }
        self.allowance -= 1;
        self.taken += 1;
        number
    }

    /// Lets time pass, which makes up the allowance. `seconds` may be fewer than really passed, never more: a clock
    /// that may be set counts as 0, and so does the time that the headset was off.
    pub fn pass_time(&mut self, seconds: u32) {
        let seconds = self.part_seconds.saturating_add(seconds);
        let gained = seconds / ALLOWANCE_SECONDS;
        self.part_seconds = seconds % ALLOWANCE_SECONDS;
        let allowance = u32::from(self.allowance).saturating_add(gained);
        self.allowance = allowance.min(u32::from(MAX_ALLOWANCE)) as u8;
    }

    /// Makes a report, to be sent within [`MAX_REPORT_SECONDS`](crate::limits::MAX_REPORT_SECONDS) or not at all, once
    /// the lease is saved. Due at the start, after each badge and, in a headset that is worn by nobody, before it
    /// sleeps.
    #[must_use]
    pub const fn make_report(&mut self) -> LeaseReport {
        self.reports = self.reports.saturating_add(1);
        LeaseReport {
            headset: self.headset,
            epoch: self.epoch,
            report: self.reports,
            taken: self.taken,
        }
    }

    /// Takes the booth's answer to a report.
    #[must_use]
    pub fn take_answer(&mut self, answer: &LeaseAnswer) -> AnswerOutcome {
        let is_mine = (answer.headset, answer.epoch) == (self.headset, self.epoch);
        if !is_mine || answer.report <= self.answered || answer.report > self.reports {
            return AnswerOutcome::Ignored;
        }
        self.answered = answer.report;
        if answer.is_void {
            self.blocks = LeasedBlocks::new();
            return AnswerOutcome::Void;
        }
        // A lease that is behind the booth's was brought back from a copy, and goes on from there.
        let since = self.taken.saturating_sub(answer.taken);
        self.taken = self.taken.max(answer.taken);
        self.blocks = skip_taken(&answer.blocks, since);
        let full = u32::from(MAX_ALLOWANCE).saturating_sub(since) as u8;
        self.allowance = self.allowance.max(full);
        AnswerOutcome::Taken
    }

    /// Writes [`BadgeLease::BYTES`] bytes.
    pub fn save(&self, bytes: &mut [u8; Self::BYTES]) {
        let (body, sum) = bytes.split_at_mut(BODY_BYTES);
        let mut to = ByteWriter::new(body);
        to.bytes(&MAGIC);
        to.u16(LEASE_VERSION);
        to.u32(self.headset);
        to.u64(self.epoch);
        to.u32(self.reports);
        to.u32(self.answered);
        to.u32(self.taken);
        to.u8(self.allowance);
        to.u16(self.part_seconds as u16);
        write_blocks(&mut to, &self.blocks);
        sum.copy_from_slice(&checksum(body).to_le_bytes());
    }

    /// Reads what [`BadgeLease::save`] wrote in this headset.
    ///
    /// # Errors
    /// [`BadBytes`] for other bytes, another headset's lease, or a damaged one. Begin a new lease then.
    pub fn load(bytes: &[u8], headset: u32) -> Result<Self, BadBytes> {
        let from = &mut ByteReader::new(bytes);
        let bad = from.error_here("the magic PBLS");
        if from.bytes(4)? != MAGIC {
            return Err(bad);
        }
        let bad = from.error_here("version 1 of a lease");
        if from.u16()? != LEASE_VERSION {
            return Err(bad);
        }
        let bad = from.error_here("this headset's number");
        if from.u32()? != headset {
            return Err(bad);
        }
        let (epoch, reports) = (from.u64()?, from.u32()?);
        let bad = from.error_here("the number of a report that was made");
        let answered = from.u32()?;
        if answered > reports {
            return Err(bad);
        }
        let taken = from.u32()?;
        let bad = from.error_here("an allowance of 0 to 12");
        let allowance = from.u8()?;
        if allowance > MAX_ALLOWANCE {
            return Err(bad);
        }
        let bad = from.error_here("less than 600 seconds");
        let part_seconds = u32::from(from.u16()?);
        if part_seconds >= ALLOWANCE_SECONDS {
            return Err(bad);
        }
        let blocks = read_blocks(from)?;
        let bad = from.error_here("the checksum of the bytes before");
        if Some(from.u64()?) != bytes.get(..BODY_BYTES).map(checksum) {
            return Err(bad);
        }
        from.expect_end()?;
        Ok(BadgeLease { headset, epoch, reports, answered, taken, allowance, part_seconds, blocks })
    }
}
