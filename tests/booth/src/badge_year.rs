//! Months of badge leases: headsets that are wiped, silent or stuck, and a booth that is restored from
//! backups. The devices are minimal protocol clients: each shows the next free number that the last answer
//! reported.

use std::time::Duration;

use paros_booth_rules::BoothTime;
use paros_booth_rules::limits::LATE_DAYS;
use paros_booth_rules::records::Device;
use paros_core::badge::BadgeNumber;
use paros_models::random_visitor::RandomSource;
use paros_protocol::{
    BadgeReport, BlockSerial, ContentHash, Heartbeat, ParcelOutcome, SculptureId, UploadFacts,
};

use crate::booth::{OPENING, SimBackup, SimBooth, decode};
use crate::truth::{Made, facts_of};

/// A day, in milliseconds.
const DAY_MS: u64 = 86_400_000;

/// Retention of sent sculptures in a headset, in days.
const GRACE_DAYS: u32 = 9;

/// Days between two backups, and the number of backups that are kept.
const BACKUP_DAYS: u32 = 3;
const BACKUPS: usize = 3;

/// The size of a simulated badge year.
#[derive(Clone, Copy, Debug)]
pub struct YearPlan {
    /// Number of headsets.
    pub headsets: u8,
    /// Number of days.
    pub days: u32,
    /// Visits a day and headset.
    pub visits: u32,
    /// Percentage of headsets that lose their data each night.
    pub wiped_percent: u64,
}

/// The counts of a simulated badge year.
#[derive(Clone, Copy, Default, Debug)]
pub struct YearSums {
    /// Number of visits.
    pub visits: u64,
    /// Visits whose badge was provisional.
    pub provisional: u64,
    /// Sculptures that arrived after their badge had lapsed.
    pub lapsed: u64,
    /// Restores of the booth from a backup.
    pub restores: u64,
    /// Sculptures sent again after a restore.
    pub returned: u64,
    /// Leased numbers shown again to a later visitor.
    pub shown_again: u64,
}

/// A finished sculpture, sent or waiting to be sent.
#[derive(Clone)]
struct Finished {
    facts: UploadFacts,
    made_on: u32,
    /// The day of the upload.
    due_on: u32,
}

struct Headset {
    device: Device,
    badges: BadgeReport,
    /// The first day on which the headset reaches the booth again.
    returns_on: u32,
    waiting: Vec<Finished>,
    sent: Vec<Finished>,
}

struct Year {
    plan: YearPlan,
    booth: SimBooth,
    headsets: Vec<Headset>,
    backups: Vec<SimBackup>,
    shown: Vec<bool>,
    today: u32,
    dice: RandomSource,
    sums: YearSums,
}

/// Simulates a badge year.
///
/// # Panics
/// A badge lapses although its sculpture was at most [`LATE_DAYS`] late, or a headset that reaches the booth
/// lacks its two leased blocks or shows a provisional badge.
#[must_use]
pub fn run_year(seed: u64, plan: YearPlan) -> YearSums {
    let booth = SimBooth::new(seed);
    let headsets = (0..plan.headsets).map(|at| Headset {
        device: booth.enrol_device(at, OPENING),
        badges: BadgeReport { epoch: 1, blocks: Vec::new() },
        returns_on: 0,
        waiting: Vec::new(),
        sent: Vec::new(),
    });
    let mut year = Year {
        plan,
        headsets: headsets.collect(),
        booth,
        backups: Vec::new(),
        shown: vec![false; BadgeNumber::COUNT as usize],
        today: 0,
        dice: RandomSource::new(seed),
        sums: YearSums::default(),
    };
    for today in 0..plan.days {
        year.today = today;
        year.run_day();
    }
    year.sums
}

impl Year {
    fn now(&self) -> BoothTime {
        BoothTime(OPENING.0 + u64::from(self.today) * DAY_MS)
    }

    fn run_day(&mut self) {
        if self.dice.one_in(12) && !self.backups.is_empty() {
            self.restore();
        }
        for at in 0..self.headsets.len() {
            self.run_headset(at);
        }
        self.booth.booth.sweep(self.now(), Duration::MAX).expect("nothing fails");
        if self.today.is_multiple_of(BACKUP_DAYS) {
            self.backups.push(self.booth.back_up(self.now()));
            self.backups.drain(..self.backups.len().saturating_sub(BACKUPS));
        }
    }

    fn run_headset(&mut self, at: usize) {
        if self.dice.below(100) < self.plan.wiped_percent {
            let headset = &mut self.headsets[at];
            let epoch = self.dice.next_bits() | 1;
            headset.badges = BadgeReport { epoch, blocks: Vec::new() };
            headset.waiting.clear();
            headset.sent.clear();
        }
        if self.dice.one_in(2000) {
            self.headsets[at].returns_on = self.today + self.dice.below(130) as u32;
        }
        let is_reached = self.headsets[at].returns_on <= self.today;
        if is_reached {
            self.exchange(at);
            assert_eq!(self.headsets[at].badges.blocks.len(), 2, "day {}: no lease", self.today);
        }
        (0..self.plan.visits).for_each(|_| self.visit(at, is_reached));
        if is_reached {
            self.send(at);
            self.exchange(at);
        }
    }

    fn exchange(&mut self, at: usize) {
        let now = self.now();
        let headset = &mut self.headsets[at];
        let beat = Heartbeat::first(headset.device.headset, 1, headset.badges.clone());
        let answer = self.booth.booth.take_heartbeat(&headset.device, &beat, now);
        headset.badges.blocks = answer.expect("nothing fails").badges;
    }

    /// A visitor finishes a sculpture and is shown a badge.
    fn visit(&mut self, at: usize, is_reached: bool) {
        let blocks = &mut self.headsets[at].badges.blocks;
        let shown = blocks.iter_mut().find(|held| !held.is_used_up()).map(|held| {
            held.next += 1;
            (BadgeNumber::of_block(held.block, held.next - 1).expect("a number"), held.serial)
        });
        assert!(shown.is_some() || !is_reached, "day {}: a provisional badge", self.today);
        self.sums.visits += 1;
        self.sums.provisional += u64::from(shown.is_none());
        if let Some((number, _)) = shown {
            let was_shown = std::mem::replace(&mut self.shown[number.get() as usize], true);
            self.sums.shown_again += u64::from(was_shown);
        }
        let waits = match self.dice.below(1000) {
            0 => 30 + self.dice.below(60),
            1..40 => self.dice.below(u64::from(LATE_DAYS) + 1),
            _ => 0,
        };
        let facts = self.facts(shown);
        let due_on = self.today + waits as u32;
        self.headsets[at].waiting.push(Finished { facts, made_on: self.today, due_on });
    }

    fn facts(&mut self, shown: Option<(BadgeNumber, BlockSerial)>) -> UploadFacts {
        let mut id = [1; 16];
        id[..8].copy_from_slice(&self.sums.visits.to_le_bytes());
        let made = Made::new(0, SculptureId(id), shown.map(|(number, _)| number));
        let serial = shown.map(|(_, serial)| serial);
        let facts = facts_of(1, &Made { serial, ..made });
        UploadFacts { volume_bytes: 1, volume_raw_bytes: 1, ..facts }
    }

    fn send(&mut self, at: usize) {
        let (now, today) = (self.now(), self.today);
        let headset = &mut self.headsets[at];
        let is_due = |finished: &mut Finished| finished.due_on <= today;
        let due: Vec<Finished> = headset.waiting.extract_if(.., is_due).collect();
        headset.sent.retain(|sent| sent.due_on + GRACE_DAYS > today);
        for finished in due {
            let Finished { facts, made_on, .. } = finished;
            let mut file = facts.to_head();
            file.push(7);
            let hash = ContentHash::of(&file);
            file.extend(hash.0);
            let booth = &self.booth.booth;
            let kept = booth.take_parcel(headset.device.headset, facts.id, &file, &decode, now);
            let waited = today - made_on;
            if kept.expect("nothing fails") == ParcelOutcome::Kept {
                let kept = booth.find_sculpture(&facts.id).expect("it was kept");
                let is_lapsed = kept.is_badge_lapsed();
                assert!(
                    !is_lapsed || waited > LATE_DAYS,
                    "day {today}: lapsed after {waited} days"
                );
                self.sums.lapsed += u64::from(is_lapsed);
            }
            headset.sent.push(Finished { due_on: today, ..finished });
        }
    }

    /// Restores the booth from one of the last backups. Headsets send the sculptures that it lost.
    fn restore(&mut self) {
        let from = self.dice.below(self.backups.len() as u64) as usize;
        self.backups.truncate(from + 1);
        let backup = self.backups.pop().expect("one of them");
        let now = self.now();
        self.booth.restore(backup, now);
        self.sums.restores += 1;
        for headset in &mut self.headsets {
            let booth = &self.booth.booth;
            let is_lacking = |sent: &mut Finished| booth.find_sculpture(&sent.facts.id).is_err();
            let lacking: Vec<Finished> = headset.sent.extract_if(.., is_lacking).collect();
            self.sums.returned += lacking.len() as u64;
            headset.waiting.extend(lacking);
        }
    }
}
