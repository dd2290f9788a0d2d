//! The lease of badges on the disk: it is there before a badge of it is shown, and before the booth hears of it.

use std::path::PathBuf;

use paros_core::badge::{AnswerOutcome, BadgeLease, BadgeNumber, LeaseAnswer, LeaseReport};
use paros_protocol::SiteId;

use super::events::OutboxOwner;
use crate::durable;

/// The lease's file, beside the parcels.
const LEASE: &str = "badges.lease";

/// The site, and its lease.
const FILE_BYTES: usize = SiteId::BYTES + BadgeLease::BYTES;

/// Milliseconds after a report until the next one that is due: its heartbeat has failed by then.
const REPORT_RETRY_MS: u64 = 10_000;

/// Reports without an answer after which the next ones wait for longer: the booth refuses them as too soon, say.
const QUICK_REPORTS: u32 = 3;

/// Milliseconds until a report is tried again that the booth didn't answer, and until one is made though no badge was
/// taken: ten minutes, and an hour.
const SLOW_RETRY_MS: u64 = 600_000;
const IDLE_REPORT_MS: u64 = 3_600_000;

/// A lease and its file.
#[derive(Debug)]
pub(super) struct LeaseKeeper {
    path: PathBuf,
    site: SiteId,
    lease: BadgeLease,
    /// When the next report is due.
    due_ms: u64,
    /// Reports that weren't answered.
    unanswered: u32,
    /// When time was last counted.
    counted_ms: Option<u64>,
}

/// Random bits that aren't zero.
fn draw_epoch() -> u64 {
    getrandom::u64().unwrap_or_default() | 1
}

impl LeaseKeeper {
    /// Opens a headset's lease in a folder. One that can't be read, or is another site's, is given up: its numbers are lost
    /// to this headset alone, and the booth gives others.
    pub(super) fn open(folder: &std::path::Path, owner: OutboxOwner) -> Self {
        let OutboxOwner { site, headset } = owner;
        let path = folder.join(LEASE);
        let bytes = durable::read_regular_file_up_to(&path, FILE_BYTES as u64);
        let bytes = bytes.ok().filter(|bytes| bytes.starts_with(&site.0));
        let lease = bytes.and_then(|bytes| BadgeLease::load(&bytes[SiteId::BYTES..], headset).ok());
        let lease = lease.unwrap_or_else(|| BadgeLease::new(headset, draw_epoch()));
        LeaseKeeper { path, site, lease, due_ms: 0, unanswered: 0, counted_ms: None }
    }

    /// Leased numbers that could be taken now.
    pub(super) fn left_now(&self) -> u32 {
        self.lease.left_now()
    }

    /// Takes a badge's number. One that is leased is on the disk as taken; where that can't be written, it is a
    /// provisional one.
    pub(super) fn take_number(&mut self, now_ms: u64) -> BadgeNumber {
        let random = getrandom::u32().unwrap_or_default();
        let number = self.lease.take_number(random);
        (self.due_ms, self.unanswered) = (now_ms, 0);
        if self.save() { number } else { BadgeNumber::provisional(random) }
    }

    /// A report, if one is due and the lease is on the disk.
    pub(super) fn make_due_report(&mut self, now_ms: u64) -> Option<LeaseReport> {
        self.pass_time(now_ms);
        if now_ms < self.due_ms {
            return None;
        }
        let is_quick = self.unanswered < QUICK_REPORTS;
        self.due_ms = now_ms + if is_quick { REPORT_RETRY_MS } else { SLOW_RETRY_MS };
        self.unanswered = self.unanswered.saturating_add(1);
        let report = self.lease.make_report();
        self.save().then_some(report)
    }

    /// Takes the booth's answer.
    pub(super) fn take_answer(&mut self, answer: &LeaseAnswer, now_ms: u64) {
        match self.lease.take_answer(answer) {
            AnswerOutcome::Ignored => return,
            AnswerOutcome::Taken => self.due_ms = now_ms + IDLE_REPORT_MS,
            AnswerOutcome::Void => {
                self.lease = BadgeLease::new(answer.headset, draw_epoch());
                self.due_ms = now_ms;
            }
        }
        self.unanswered = 0;
        // What isn't saved now is saved with the next badge, before that is shown.
        let _ = self.save();
    }

    fn pass_time(&mut self, now_ms: u64) {
        let counted_ms = *self.counted_ms.get_or_insert(now_ms);
        let seconds = now_ms.saturating_sub(counted_ms) / 1000;
        self.counted_ms =
            Some(if now_ms < counted_ms { now_ms } else { counted_ms + seconds * 1000 });
        self.lease.pass_time(u32::try_from(seconds).unwrap_or(u32::MAX));
    }

    fn save(&self) -> bool {
        let mut bytes = [0; BadgeLease::BYTES];
        self.lease.save(&mut bytes);
        durable::write_file(&self.path, &[&self.site.0[..], &bytes].concat()).is_ok()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use paros_core::badge::BadgeLedger;

    use super::*;

    #[test]
    fn a_lease_outlives_the_program_and_no_number_is_taken_twice() {
        let folder = std::env::temp_dir().join(format!("paros-lease-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("room on the disk");
        let mut ledger = Box::new(BadgeLedger::new(90));
        let owner = OutboxOwner { site: SiteId([7; 16]), headset: 17 };
        let mut keeper = LeaseKeeper::open(&folder, owner);
        assert!(keeper.take_number(0).is_provisional(), "nothing is leased yet");
        let report = keeper.make_due_report(0).expect("one is due at the start");
        assert_eq!(keeper.make_due_report(REPORT_RETRY_MS - 1), None, "it is on its way");
        let answer = ledger.answer_report(&report, 1_790_000_000).expect("a lease");
        keeper.take_answer(&answer, 5);
        assert_eq!(keeper.make_due_report(IDLE_REPORT_MS), None);
        let first = keeper.take_number(6);
        assert!(!first.is_provisional() && keeper.left_now() > 0);
        assert!(keeper.make_due_report(6).is_some(), "after each badge");
        drop(keeper);
        let of_another = OutboxOwner { site: SiteId([8; 16]), ..owner };
        assert_eq!(LeaseKeeper::open(&folder, of_another).left_now(), 0);
        let mut again = LeaseKeeper::open(&folder, owner);
        assert_ne!(again.take_number(0), first);
        // Where the disk takes nothing, no leased number is shown.
        fs::remove_dir_all(&folder).expect("it is there");
        assert!(again.take_number(0).is_provisional());
    }
}
