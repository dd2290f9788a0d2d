//! A headset's lease: what it gives next, what it keeps, and which bytes it refuses.

use paros_core::badge::{
    AnswerOutcome, BadgeLease, BadgeLedger, BadgeNumber, DAY_SECONDS, LEASED_NUMBERS, LeaseAnswer,
    LeaseReport, LeasedBlock,
};
use paros_core::internals::checksum;
use paros_core::limits::{ALLOWANCE_SECONDS, MAX_ALLOWANCE, RESERVE_NUMBERS};

const HEADSET: u32 = 7;
const EPOCH: u64 = 0x1234_5678_9abc_def0;

/// An answer to the newest report, after so many numbers.
fn answer_with(report: LeaseReport, blocks: &[(u16, u8)]) -> LeaseAnswer {
    let LeaseReport { headset, epoch, report, taken } = report;
    let leased = blocks.iter().map(|(block, first)| LeasedBlock::new(*block, *first));
    let blocks = leased.collect::<Option<_>>().expect("blocks that there are");
    LeaseAnswer { headset, epoch, report, taken, is_void: false, blocks }
}

fn lease_of(blocks: &[(u16, u8)]) -> BadgeLease {
    let mut lease = BadgeLease::new(HEADSET, EPOCH);
    let report = lease.make_report();
    assert_eq!(lease.take_answer(&answer_with(report, blocks)), AnswerOutcome::Taken);
    lease
}

fn take(lease: &mut BadgeLease) -> Option<u32> {
    let number = lease.take_number(0);
    (!number.is_provisional()).then(|| number.get())
}

fn save(lease: &BadgeLease) -> [u8; BadgeLease::BYTES] {
    let mut bytes = [0; BadgeLease::BYTES];
    lease.save(&mut bytes);
    bytes
}

#[test]
fn without_a_lease_a_number_is_provisional_and_random() {
    let mut lease = BadgeLease::new(HEADSET, EPOCH);
    lease.pass_time(100_000);
    for bits in [0, 1, 0x3_ffff, u32::MAX] {
        assert_eq!(lease.take_number(bits), BadgeNumber::provisional(bits));
    }
    assert_eq!((lease.left(), lease.make_report().taken), (0, 0));
}

#[test]
fn numbers_are_used_in_order_block_after_block() {
    let mut lease = lease_of(&[(3, 60), (28_671, 0), (5, 62)]);
    assert_eq!(lease.left(), 4 + 64 + 2);
    let expected =
        (3 * 64 + 60..4 * 64).chain(28_671 * 64..LEASED_NUMBERS).chain(5 * 64 + 62..6 * 64);
    for (i, number) in (0..).zip(expected) {
        assert_eq!((lease.left(), take(&mut lease)), (70 - i, Some(number)));
        assert_eq!(lease.make_report().taken, i + 1);
        lease.pass_time(ALLOWANCE_SECONDS);
    }
    assert_eq!((lease.left(), take(&mut lease)), (0, None));
}

#[test]
fn the_allowance_is_spent_and_made_up_by_time_and_answers() {
    let mut lease = lease_of(&[(0, 0), (1, 0)]);
    let most = u32::from(MAX_ALLOWANCE);
    assert_eq!(lease.left_now(), most);
    (0..most).for_each(|i| assert_eq!(take(&mut lease), Some(i)));
    assert_eq!((lease.left_now(), take(&mut lease)), (0, None));
    // Ten minutes in parts, and no more however long it waits.
    lease.pass_time(ALLOWANCE_SECONDS - 1);
    assert_eq!(take(&mut lease), None);
    lease.pass_time(1);
    assert_eq!((take(&mut lease), take(&mut lease)), (Some(most), None));
    lease.pass_time(u32::MAX);
    assert_eq!(lease.left_now(), most);
    // An answer fills it, less what was taken since its report.
    (0..most).for_each(|_| _ = take(&mut lease));
    let report = lease.make_report();
    lease.pass_time(2 * ALLOWANCE_SECONDS);
    (0..2).for_each(|_| _ = take(&mut lease));
    let answer = answer_with(report, &[(0, 25), (1, 0)]);
    assert_eq!((lease.left_now(), lease.take_answer(&answer)), (0, AnswerOutcome::Taken));
    assert_eq!((lease.left_now(), take(&mut lease)), (most - 2, Some(27)));
}

#[test]
fn what_was_taken_since_a_report_is_not_in_its_answer() {
    let mut lease = lease_of(&[(0, 60), (9, 0)]);
    let report = lease.make_report();
    (0..5).for_each(|_| _ = take(&mut lease));
    let answer = answer_with(report, &[(0, 60), (9, 0), (4, 0)]);
    assert_eq!(lease.take_answer(&answer), AnswerOutcome::Taken);
    assert_eq!((lease.left(), take(&mut lease)), (63 + 64, Some(9 * 64 + 1)));
    // The same again, an older one, one that nobody asked for, and those of others.
    let before = lease.clone();
    let next = lease.make_report();
    for (change, report) in [(0, report), (1, next), (2, next), (3, next)] {
        let mut answer = answer_with(report, &[(8, 0)]);
        match change {
            0 => {}
            1 => answer.report += 1,
            2 => answer.headset += 1,
            _ => answer.epoch += 1,
        }
        assert_eq!(lease.take_answer(&answer), AnswerOutcome::Ignored);
    }
    assert_eq!(lease.left(), before.left());
}

#[test]
fn a_void_lease_gives_nothing_more() {
    let mut lease = lease_of(&[(0, 0)]);
    let mut answer = answer_with(lease.make_report(), &[]);
    answer.is_void = true;
    assert_eq!(lease.take_answer(&answer), AnswerOutcome::Void);
    assert_eq!((lease.left(), take(&mut lease)), (0, None));
}

#[test]
fn a_lease_comes_back_from_its_bytes_in_its_own_headset_alone() {
    let mut lease = lease_of(&[(3, 60), (28_671, 0), (5, 62), (6, 0), (7, 0), (8, 0)]);
    lease.pass_time(599);
    (0..7).for_each(|_| _ = take(&mut lease));
    assert_eq!(BadgeLease::load(&save(&lease), HEADSET), Ok(lease.clone()));
    let bad = BadgeLease::load(&save(&lease), HEADSET + 1).expect_err("another headset's");
    assert_eq!((bad.offset, bad.expected), (6, "this headset's number"));
}

#[test]
fn damaged_bytes_are_refused_at_their_place() {
    let bytes = save(&lease_of(&[(3, 60), (28_671, 0)]));
    for i in 0..bytes.len() {
        assert!(BadgeLease::load(&bytes[..i], HEADSET).is_err(), "{i} bytes");
        let mut damaged = bytes;
        damaged[i] ^= 0x10;
        let bad = BadgeLease::load(&damaged, HEADSET).expect_err("a damaged byte");
        assert!(bad.offset <= bytes.len() - 8, "{bad:?}");
    }
    let longer = [&bytes[..], &[0]].concat();
    assert_eq!(BadgeLease::load(&longer, HEADSET).map_err(|bad| bad.expected), Err("the end"));
    // With a checksum that is right: where, what is written there, and where that is told.
    let forged = [
        (0, 0, 0, "the magic PBLS"),
        (4, 2, 4, "version 1 of a lease"),
        (22, 2, 22, "the number of a report that was made"),
        (30, 13, 30, "an allowance of 0 to 12"),
        (32, 3, 31, "less than 600 seconds"),
        (33, 7, 33, "up to 6 blocks"),
        (33, 1, 37, "another block, a place in it, and zeros after the last one"),
        (35, 0x70, 34, "another block, a place in it, and zeros after the last one"),
        (36, 64, 34, "another block, a place in it, and zeros after the last one"),
    ];
    for (at, byte, offset, expected) in forged {
        let mut forged = bytes;
        forged[at] = byte;
        let sum = checksum(&forged[..bytes.len() - 8]).to_le_bytes();
        forged[bytes.len() - 8..].copy_from_slice(&sum);
        let bad = BadgeLease::load(&forged, HEADSET).expect_err(expected);
        assert_eq!((bad.offset, bad.expected), (offset, expected), "byte {at}");
    }
}

#[test]
fn a_reserve_lasts_for_three_days_without_the_booth() {
    let mut ledger = Box::new(BadgeLedger::new(90));
    let mut lease = BadgeLease::new(HEADSET, EPOCH);
    let answer = ledger.answer_report(&lease.make_report(), DAY_SECONDS).expect("an answer");
    assert_eq!(lease.take_answer(&answer), AnswerOutcome::Taken);
    assert!(lease.left() >= RESERVE_NUMBERS, "{} are left", lease.left());
    for day in 0..3 {
        // A visit every twelve minutes, and the headset is off at night.
        for visit in 0..50 {
            assert!(take(&mut lease).is_some(), "visit {visit} of day {day}");
            lease.pass_time(720);
        }
    }
}
