//! Headsets and a booth to which anything happens in any order: messages are lost, late and doubled, data is wiped,
//! clocks stand still. No number is free as long as a sculpture with it is kept, and none is lost.

use std::collections::HashMap;

use paros_core::badge::{
    AnswerOutcome, BadgeLease, BadgeLedger, BadgeNumber, DAY_SECONDS, LEASED_NUMBERS, LeaseAnswer,
    LeaseReport, LedgerRefusal, LedgerTotals,
};
use paros_core::limits::{MAX_ALLOWANCE, MAX_LEASED_BLOCKS, RESERVE_NUMBERS};
use paros_models::random_visitor::RandomSource;

const RETENTION: u32 = 90;

/// Some headsets and a booth, and what was shown, by number: the first day on which no sculpture with it is kept.
struct Turmoil {
    ledger: Box<BadgeLedger>,
    leases: Vec<BadgeLease>,
    now: u64,
    shown: HashMap<BadgeNumber, u32>,
    /// With when it was made.
    reports: Vec<(LeaseReport, u64)>,
    answers: Vec<LeaseAnswer>,
    dice: RandomSource,
}

impl Turmoil {
    fn new(seed: u64) -> Self {
        let mut dice = RandomSource::new(seed);
        let leases = (0..4).map(|i| BadgeLease::new(i, dice.next_bits())).collect();
        let (reports, answers) = (Vec::new(), Vec::new());
        Turmoil {
            ledger: Box::new(BadgeLedger::new(RETENTION as u16)),
            leases,
            now: 100 * DAY_SECONDS,
            shown: HashMap::new(),
            reports,
            answers,
            dice,
        }
    }

    fn act(&mut self) {
        let i = self.dice.below(4) as usize;
        match self.dice.below(20) {
            0..8 => self.show(i),
            8..11 => {
                let report = self.leases[i].make_report();
                self.reports.push((report, self.now));
            }
            11..14 => self.deliver_report(),
            14..17 => self.deliver_answer(),
            17 => self.pass_time(),
            18 if self.dice.one_in(3) => {
                self.leases[i] = BadgeLease::new(i as u32, self.dice.next_bits());
            }
            19 if self.dice.one_in(10) => _ = self.ledger.retire_headset(i as u32, self.now),
            _ => {
                let mut bytes = [0; BadgeLease::BYTES];
                self.leases[i].save(&mut bytes);
                assert_eq!(BadgeLease::load(&bytes, i as u32).as_ref(), Ok(&self.leases[i]));
            }
        }
    }

    fn show(&mut self, i: usize) {
        // A rush now and then.
        for _ in 0..self.dice.below(3) * self.dice.below(8) {
            let number = self.leases[i].take_number(0);
            if !number.is_provisional() {
                let today = BadgeLedger::day_of(self.now);
                let before = self.shown.insert(number, today + RETENTION + 1);
                assert!(before.is_none_or(|day| day <= today), "{number:?} is shown again");
            }
        }
    }

    /// Any that is on its way, in any order, once or twice; those that are older than ten minutes never.
    fn deliver_report(&mut self) {
        self.reports.retain(|(_, made)| self.now - made <= 600);
        if self.reports.is_empty() {
            return;
        }
        let at = self.dice.below(self.reports.len() as u64) as usize;
        let report = self.reports[at].0;
        if !self.dice.one_in(4) {
            self.reports.swap_remove(at);
        }
        match self.ledger.answer_report(&report, self.now) {
            Ok(answer) => self.answers.push(answer),
            Err(refusal) => {
                assert!(matches!(refusal, LedgerRefusal::Stale | LedgerRefusal::TooSoon));
            }
        }
    }

    fn deliver_answer(&mut self) {
        if self.answers.is_empty() {
            return;
        }
        let at = self.dice.below(self.answers.len() as u64) as usize;
        let answer = self.answers.swap_remove(at);
        let lease = &mut self.leases[answer.headset as usize];
        if lease.take_answer(&answer) == AnswerOutcome::Void {
            *lease = BadgeLease::new(answer.headset, self.dice.next_bits());
        }
        assert!(lease.left() <= RESERVE_NUMBERS + 64 * MAX_LEASED_BLOCKS as u32);
    }

    /// Some seconds, minutes or hours, seldom days; some headsets are off meanwhile.
    fn pass_time(&mut self) {
        let longest = [10, 900, 20_000, 400_000][self.dice.below(4) as usize];
        let seconds = self.dice.below(longest);
        self.now += seconds;
        for lease in &mut self.leases {
            if !self.dice.one_in(3) {
                lease.pass_time(seconds as u32);
            }
        }
    }

    /// Nothing that is kept is free, and no number is lost.
    fn check(&self) {
        let ledger_day = BadgeLedger::day_of(self.now);
        for (number, kept_before) in &self.shown {
            let is_kept = ledger_day < *kept_before;
            assert!(!is_kept || !self.ledger.is_free(*number), "{number:?} is free");
        }
    }
}

#[test]
fn whatever_is_lost_no_number_is_free_while_it_is_kept() {
    for seed in 0..300 {
        let mut turmoil = Turmoil::new(seed);
        for act in 0..600 {
            turmoil.act();
            // What was freed too early stays free for a while.
            if act % 5 == 0 {
                turmoil.check();
            }
        }
        let LedgerTotals { free, held, spent_of_held, kept, resting } = turmoil.ledger.totals();
        assert_eq!(free + held + spent_of_held + kept + resting, LEASED_NUMBERS);
        assert!(turmoil.shown.len() > usize::from(MAX_ALLOWANCE), "seed {seed}");
    }
}
