//! The booth's ledger: what it hands out, what returns, what it keeps, and its bytes.

use std::collections::HashSet;

use paros_core::badge::{
    AnswerOutcome, BadgeLease, BadgeLedger, BadgeNumber, DAY_SECONDS, LEASED_BLOCKS,
    LEASED_NUMBERS, LeaseReport, LedgerRefusal, LedgerTotals, MAX_LEDGER_BYTES,
};
use paros_core::internals::checksum;
use paros_core::limits::MAX_HEADSETS;
use paros_models::random_visitor::RandomSource;

const RETENTION: u32 = 90;

/// An hour that is no day's first.
const START: u64 = 100 * DAY_SECONDS + 9 * 3600;

fn new_ledger() -> Box<BadgeLedger> {
    Box::new(BadgeLedger::new(RETENTION as u16))
}

fn number(number: u32) -> BadgeNumber {
    BadgeNumber::new(number).expect("a number")
}

/// When leases begin that a wipe ends at the start.
const BEFORE: u64 = START - 3600;

/// A report and its answer, of which nothing is lost.
fn exchange(ledger: &mut BadgeLedger, lease: &mut BadgeLease, now: u64) {
    let answer = ledger.answer_report(&lease.make_report(), now).expect("an answer");
    assert_eq!(lease.take_answer(&answer), AnswerOutcome::Taken);
}

fn take(lease: &mut BadgeLease) -> BadgeNumber {
    let number = lease.take_number(0);
    assert!(!number.is_provisional(), "nothing is left");
    number
}

fn save(ledger: &BadgeLedger) -> Vec<u8> {
    let mut bytes = vec![0; MAX_LEDGER_BYTES];
    let len = ledger.save(&mut bytes);
    bytes.truncate(len);
    bytes
}

fn sum(totals: &LedgerTotals) -> u32 {
    totals.free + totals.held + totals.spent_of_held + totals.kept + totals.resting
}

#[test]
fn blocks_of_all_colours_are_handed_out_and_no_number_to_two() {
    let mut ledger = new_ledger();
    let mut leases: Vec<_> = (0..MAX_HEADSETS as u32).map(|i| BadgeLease::new(i, 5)).collect();
    leases.iter_mut().for_each(|lease| exchange(&mut ledger, lease, START));
    let mut colours = [0; 8];
    let mut seen = HashSet::new();
    for lease in &mut leases {
        while lease.left() > 0 {
            lease.pass_time(10_000);
            let number = take(lease);
            colours[number.colour() as usize] += 1;
            assert!(seen.insert(number), "{number:?} twice");
        }
    }
    assert!(colours[..7].iter().all(|count| *count > 6000) && colours[7] == 0, "{colours:?}");
    let mut other = BadgeLease::new(u32::MAX, 5);
    let refusal = ledger.answer_report(&other.make_report(), START);
    assert_eq!(refusal, Err(LedgerRefusal::TooManyHeadsets));
}

/// Another headset is wiped again and again, until blocks that it held before come round.
#[test]
fn a_block_that_a_headset_holds_is_passed_over() {
    let mut ledger = new_ledger();
    let mut ask = |headset, epoch| {
        let report = BadgeLease::new(headset, epoch).make_report();
        let answer = ledger.answer_report(&report, START + epoch * 601).expect("an answer");
        answer.blocks.iter().map(|leased| leased.block()).collect::<Vec<_>>()
    };
    let held = ask(1, 1);
    let (mut handed_out, mut count) = (HashSet::new(), 0);
    for epoch in 1..=LEASED_BLOCKS as u64 / 3 + 10 {
        let blocks = ask(2, epoch);
        assert!(blocks.iter().all(|block| !held.contains(block)), "{blocks:?} of {held:?}");
        count += blocks.len();
        handed_out.extend(blocks);
    }
    assert!(handed_out.len() < count, "no block came round");
}

#[test]
fn after_a_wipe_only_what_may_have_been_shown_is_kept() {
    // Silent for so many seconds before the new lease's first report, and numbers that are spent by then.
    for (silent, spent) in
        [(0, 15), (720, 16), (14 * 3600, 99), (30 * 3600, 192), (80 * DAY_SECONDS, 192)]
    {
        let mut ledger = new_ledger();
        let mut lease = BadgeLease::new(1, 11);
        exchange(&mut ledger, &mut lease, BEFORE);
        let taken: Vec<_> = (0..5).map(|_| take(&mut lease)).collect();
        exchange(&mut ledger, &mut lease, START);
        let held = ledger.totals().held;
        let mut wiped = BadgeLease::new(1, 12);
        exchange(&mut ledger, &mut wiped, START + silent);
        let totals = ledger.totals();
        let spent_now = totals.kept;
        assert!(taken.iter().all(|number| !ledger.is_free(*number)));
        assert_eq!(spent_now, 5 + spent.min(held), "after {silent} s");
        assert_eq!((totals.held, sum(&totals)), (192, LEASED_NUMBERS));
    }
}

#[test]
fn a_number_is_free_when_no_sculpture_with_it_is_kept() {
    let mut ledger = new_ledger();
    let mut lease = BadgeLease::new(1, 11);
    exchange(&mut ledger, &mut lease, BEFORE);
    let first = take(&mut lease);
    exchange(&mut ledger, &mut lease, START);
    let mut wiped = BadgeLease::new(1, 12);
    exchange(&mut ledger, &mut wiped, START);
    // The last second of the last day, and the first of the next.
    let last_day = BadgeLedger::day_of(START) + RETENTION;
    let midnight = u64::from(last_day + 1) * DAY_SECONDS;
    for (now, is_free) in [(midnight - 1, false), (midnight, true)] {
        exchange(&mut ledger, &mut wiped, now);
        assert_eq!(ledger.is_free(first), is_free);
    }
    // A sculpture that somebody keeps longer.
    ledger.keep_until(first, last_day + 10);
    for (now, is_free) in
        [(midnight + 10 * DAY_SECONDS - 1, false), (midnight + 10 * DAY_SECONDS, true)]
    {
        exchange(&mut ledger, &mut wiped, now);
        assert_eq!(ledger.is_free(first), is_free);
    }
    assert!(!ledger.is_free(BadgeNumber::provisional(3)));
    ledger.keep_until(BadgeNumber::provisional(3), u32::MAX);
}

/// A clean slate in which somebody's sculpture turns up, as where the booth began a new ledger.
#[test]
fn a_sculpture_of_an_unknown_number_keeps_it() {
    let mut ledger = new_ledger();
    ledger.keep_until(number(70), 100);
    assert!(
        !ledger.is_free(number(70)) && !ledger.is_free(number(64)) && ledger.is_free(number(71))
    );
}

#[test]
fn a_clock_that_was_set_back_costs_numbers_and_repeats_none() {
    let mut ledger = new_ledger();
    let mut lease = BadgeLease::new(1, 11);
    exchange(&mut ledger, &mut lease, START);
    let mut other = BadgeLease::new(2, 11);
    exchange(&mut ledger, &mut other, START - 3600);
    exchange(&mut ledger, &mut BadgeLease::new(1, 12), START - 2000);
    assert_eq!(ledger.totals().kept, 192, "all that it held");
}

#[test]
fn a_retired_headset_gives_nothing_back_and_its_lease_is_void() {
    let mut ledger = new_ledger();
    let mut lease = BadgeLease::new(1, 11);
    exchange(&mut ledger, &mut lease, START);
    _ = take(&mut lease);
    exchange(&mut ledger, &mut lease, START);
    assert!(ledger.retire_headset(1, START) && !ledger.retire_headset(1, START));
    assert_eq!((ledger.totals().kept, ledger.totals().held), (192, 0));
    // It may come back on the last day on which a sculpture is kept that it made on the first.
    let shown = take(&mut lease);
    let mut other = BadgeLease::new(2, 11);
    let last_day = BadgeLedger::day_of(START) + 2 * RETENTION;
    for (day, is_free) in [(last_day, false), (last_day + 1, true)] {
        exchange(&mut ledger, &mut other, u64::from(day) * DAY_SECONDS);
        assert_eq!(ledger.is_free(shown), is_free);
    }
    let answer = ledger.answer_report(&lease.make_report(), START).expect("an answer");
    assert!(answer.is_void);
    assert_eq!(lease.take_answer(&answer), AnswerOutcome::Void);
}

#[test]
fn reports_that_are_late_doubled_or_forged_change_nothing() {
    let mut ledger = new_ledger();
    let mut lease = BadgeLease::new(1, 11);
    let first = lease.make_report();
    let answer = ledger.answer_report(&first, BEFORE).expect("an answer");
    assert_eq!(lease.take_answer(&answer), AnswerOutcome::Taken);
    _ = take(&mut lease);
    let second = lease.make_report();
    let answer = ledger.answer_report(&second, START).expect("an answer");
    // The newest one again has the same answer.
    let saved = save(&ledger);
    assert_eq!(ledger.answer_report(&second, START), Ok(answer));
    assert_eq!(ledger.answer_report(&first, START), Err(LedgerRefusal::Stale));
    let forged = LeaseReport { taken: 194, report: 3, ..second };
    assert_eq!(ledger.answer_report(&forged, START), Err(LedgerRefusal::NeverLeased));
    let forged = LeaseReport { taken: 2, ..second };
    assert_eq!(ledger.answer_report(&forged, START), Err(LedgerRefusal::Stale));
    let unknown = LeaseReport { epoch: 99, ..second };
    assert!(ledger.answer_report(&unknown, START).is_ok_and(|answer| answer.is_void));
    assert!(save(&ledger) == saved);
    // The first report of an epoch that was wiped since, which looks as one of a new epoch does.
    let mut wiped = BadgeLease::new(1, 12);
    exchange(&mut ledger, &mut wiped, START);
    let saved = save(&ledger);
    assert!(ledger.answer_report(&first, START).is_ok_and(|answer| answer.is_void));
    assert!(save(&ledger) == saved);
    // One of an epoch that never came here, of a headset that was wiped twice within minutes.
    let unheard = BadgeLease::new(1, 13).make_report();
    assert_eq!(ledger.answer_report(&unheard, START), Err(LedgerRefusal::TooSoon));
    assert!(save(&ledger) == saved);
    assert!(ledger.answer_report(&unheard, START + 601).is_ok_and(|answer| !answer.is_void));
}

#[test]
fn a_ledger_comes_back_from_its_bytes_and_a_damaged_one_does_not() {
    let mut ledger = new_ledger();
    for i in 0..40 {
        let mut lease = BadgeLease::new(i * 3, 11);
        exchange(&mut ledger, &mut lease, BEFORE);
        (0..i % 8).for_each(|_| _ = take(&mut lease));
        exchange(&mut ledger, &mut lease, START);
        if i % 4 == 0 {
            exchange(&mut ledger, &mut BadgeLease::new(i * 3, 12), START);
        }
    }
    let bytes = save(&ledger);
    let mut other = new_ledger();
    other.load(&bytes).expect("what was saved");
    assert!(save(&other) == bytes && other.totals() == ledger.totals());
    assert_eq!(ledger.save(&mut []), bytes.len());

    let mut dice = RandomSource::new(3);
    for case in 0..300 {
        let mut damaged = bytes.clone();
        // Most of it are blocks that were never used: mostly the rest is damaged, its ends.
        let at =
            [dice.below(300), 24 + 5 * 28_672 + dice.below(1500), dice.below(bytes.len() as u64)];
        damaged[at[case % 3] as usize] ^= 1 << dice.below(8);
        assert!(other.load(&damaged).is_err());
        let body = bytes.len() - 8;
        let sum = checksum(&damaged[..body]).to_le_bytes();
        damaged[body..].copy_from_slice(&sum);
        // With a checksum that is right it is refused, or is a ledger that holds together.
        match other.load(&damaged) {
            Ok(()) => assert!(save(&other) == damaged && sum_is_all(&other)),
            Err(bad) => assert!(bad.offset < bytes.len(), "{bad:?}"),
        }
        other.load(&bytes).expect("what was saved");
    }
    for len in [0, 3, 8, 24, bytes.len() - 1] {
        assert!(other.load(&bytes[..len]).is_err(), "{len} bytes");
    }
    assert!(save(&other) == bytes, "what is refused changes nothing");
}

/// Bytes that are right but for what a headset holds: the first two hold the same.
#[test]
fn a_block_that_two_hold_is_refused() {
    let mut ledger = new_ledger();
    (0..2).for_each(|i| exchange(&mut ledger, &mut BadgeLease::new(i, 11), START));
    let mut bytes = save(&ledger);
    // A headset's blocks are its last twelve bytes, and the checksum is the last eight of all.
    let body = bytes.len() - 8;
    let headset = (body - 24 - 5 * 28_672 - 2) / 2;
    bytes.copy_within(body - headset - 12..body - headset - 10, body - 12);
    let sum = checksum(&bytes[..body]).to_le_bytes();
    bytes[body..].copy_from_slice(&sum);
    let bad = ledger.load(&bytes).expect_err("a block that is held twice");
    assert_eq!(bad.expected, "each block that is held with one headset");
}

fn sum_is_all(ledger: &BadgeLedger) -> bool {
    sum(&ledger.totals()) == LEASED_NUMBERS
}
