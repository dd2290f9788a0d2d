//! Headsets and a booth that share the badges' numbers, and beside them what was really shown: a day by number.
//!
//! Whoever drives a fleet says when visits end, what is wiped and what is lost on the way; the fleet fails where a
//! leased badge is shown while a sculpture with it is kept.

use paros_core::badge::{
    AnswerOutcome, BadgeLease, BadgeLedger, BadgeNumber, LEASED_NUMBERS, LedgerRefusal,
    MAX_LEDGER_BYTES,
};

use crate::random_visitor::RandomSource;

/// For how many days a sculpture is kept after the day on which it was made, or arrived at the booth.
pub const RETENTION_DAYS: u16 = 90;

/// A headset: its lease, and the sculptures that wait to be sent.
#[derive(Debug)]
pub struct FleetHeadset {
    /// Which survives a wipe.
    pub number: u32,
    /// What it holds.
    pub lease: BadgeLease,
    outbox: Vec<BadgeNumber>,
    /// When its clock last told the lease how much time passed, in seconds; `None` where it was off since.
    clock: Option<u64>,
}

/// How a headset reaches the booth.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Network {
    /// Everything arrives.
    Works,
    /// What is sent there is lost.
    LosesReports,
    /// What is sent back is lost.
    LosesAnswers,
}

/// A booth with its ledger, and what was really shown.
#[derive(Debug)]
pub struct Fleet {
    /// Of the booth.
    pub ledger: Box<BadgeLedger>,
    /// The last day on which a sculpture with this number is kept, and one more; 0 where it was never shown.
    kept_before: Vec<u32>,
    /// Badges shown: leased, provisional.
    pub shown: [u64; 2],
}

impl FleetHeadset {
    /// One without a lease.
    pub fn new(number: u32, dice: &mut RandomSource) -> Self {
        let lease = BadgeLease::new(number, dice.next_bits());
        FleetHeadset { number, lease, outbox: Vec::new(), clock: None }
    }

    /// Loses its data: lease and sculptures.
    pub fn wipe(&mut self, dice: &mut RandomSource) {
        *self = FleetHeadset { clock: self.clock, ..FleetHeadset::new(self.number, dice) };
    }

    /// Starts again, with the lease as it was saved. How long it was off it doesn't know.
    ///
    /// # Panics
    /// The lease doesn't come back as it was.
    pub fn restart(&mut self) {
        let mut bytes = [0; BadgeLease::BYTES];
        self.lease.save(&mut bytes);
        assert_eq!(BadgeLease::load(&bytes, self.number).as_ref(), Ok(&self.lease));
        self.clock = None;
    }

    fn pass_time(&mut self, now: u64) {
        let passed = self.clock.map_or(0, |clock| now - clock);
        self.lease.pass_time(passed as u32);
        self.clock = Some(now);
    }
}

impl Fleet {
    /// A booth at its start.
    pub fn new() -> Self {
        Fleet {
            ledger: Box::new(BadgeLedger::new(RETENTION_DAYS)),
            kept_before: vec![0; LEASED_NUMBERS as usize],
            shown: [0; 2],
        }
    }

    /// The end of a visit: a badge is shown.
    ///
    /// # Panics
    /// It is leased, and a sculpture with it is kept.
    pub fn end_visit(
        &mut self,
        headset: &mut FleetHeadset,
        now: u64,
        dice: &mut RandomSource,
    ) -> BadgeNumber {
        headset.pass_time(now);
        let number = headset.lease.take_number(dice.next_bits() as u32);
        self.shown[usize::from(number.is_provisional())] += 1;
        if !number.is_provisional() {
            let today = BadgeLedger::day_of(now);
            let kept_before = self.kept_before[number.get() as usize];
            assert!(today >= kept_before, "{number:?} is shown again on day {today}");
            self.keep(number, now);
            headset.outbox.push(number);
        }
        number
    }

    /// A headset reports, hears the answer, and sends its sculptures.
    ///
    /// # Panics
    /// The booth refuses to answer.
    pub fn exchange(
        &mut self,
        headset: &mut FleetHeadset,
        now: u64,
        network: Network,
        dice: &mut RandomSource,
    ) {
        headset.pass_time(now);
        let report = headset.lease.make_report();
        if network == Network::LosesReports {
            return;
        }
        let answer = match self.ledger.answer_report(&report, now) {
            Ok(answer) => answer,
            // It asks again with its next report.
            Err(LedgerRefusal::TooSoon) => return,
            Err(refusal) => panic!("{refusal}"),
        };
        if network == Network::LosesAnswers {
            return;
        }
        match headset.lease.take_answer(&answer) {
            AnswerOutcome::Taken => {}
            AnswerOutcome::Ignored => panic!("{answer:?} is ignored"),
            // What it showed meanwhile is sent all the same.
            AnswerOutcome::Void => {
                headset.lease = BadgeLease::new(headset.number, dice.next_bits());
            }
        }
        for number in headset.outbox.drain(..) {
            let last_day = BadgeLedger::day_of(now) + u32::from(RETENTION_DAYS);
            self.ledger.keep_until(number, last_day);
            let kept_before = &mut self.kept_before[number.get() as usize];
            *kept_before = (*kept_before).max(last_day + 1);
        }
    }

    /// The booth's disk is lost, and its ledger comes back from a copy of some time before.
    ///
    /// # Panics
    /// It is no saved ledger.
    pub fn restore(&mut self, (copy, copied_at): (&[u8], u64), now: u64) {
        self.ledger.load(copy).expect("a saved ledger");
        self.ledger.begin_generation(copied_at, now);
    }

    /// The ledger's bytes, as a backup has them.
    pub fn copy_ledger(&self) -> Vec<u8> {
        let mut bytes = vec![0; MAX_LEDGER_BYTES];
        let len = self.ledger.save(&mut bytes);
        bytes.truncate(len);
        bytes
    }

    fn keep(&mut self, number: BadgeNumber, now: u64) {
        let last_day = BadgeLedger::day_of(now) + u32::from(RETENTION_DAYS);
        let kept_before = &mut self.kept_before[number.get() as usize];
        *kept_before = (*kept_before).max(last_day + 1);
    }
}

impl Default for Fleet {
    fn default() -> Self {
        Self::new()
    }
}
