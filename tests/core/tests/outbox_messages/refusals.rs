//! Messages that nobody writes.

use std::fmt::Debug;

use paros_core::badge::{BadgeLease, BadgeLedger, BadgeNumber, DAY_SECONDS, LeaseReport};
use paros_core::codec::BadBytes;
use paros_core::outbox::messages::{
    Announcement, Announcements, BoothCommand, CommandKind, Heartbeat, HeartbeatAnswer,
    SculptureId, UploadFacts, UploadStatus,
};
use paros_models::random_visitor::RandomSource;

use super::any_messages::{HEADSET, any_answer, any_facts, any_heartbeat, bytes_of};

/// Refused: the byte at `at` of a message set to `value`, where something else is `expected`.
pub(crate) fn check_refused<T: Debug>(
    bytes: &[u8],
    read: fn(&[u8]) -> Result<T, BadBytes>,
    faults: &[(usize, &[u8], &str)],
) {
    for &(at, values, expected) in faults {
        let mut bytes = bytes.to_vec();
        bytes[at..at + values.len()].copy_from_slice(values);
        let bad = read(&bytes).expect_err(expected);
        assert!(bad.expected.contains(expected), "at {at}: expected {expected}, not {bad:?}");
        assert!(bad.offset <= bytes.len(), "at {at}: {bad:?}");
    }
}

#[test]
fn facts_that_no_headset_has_are_refused() {
    let facts = UploadFacts {
        volume_bytes: 50,
        volume_raw_bytes: 134,
        trace_bytes: 0,
        trace_raw_bytes: 0,
        ..any_facts(&mut RandomSource::new(1))
    };
    let faults: &[(usize, &[u8], &str)] = &[
        (1, &[0; 16], "a sculpture's id"),
        (17, &BadgeNumber::COUNT.to_le_bytes(), "the number of a badge"),
        (23, &[64, 0], "128 or 256"),
        (25, &[3], "how a session ended"),
        (26, b"En", "two small letters"),
        (28, &[0, 0], "starts from"),
        (28, &[1, 7], "starts from"),
        (30, &[3], "an age group"),
        (43, &[0, 0], "a height"),
        (45, &[0; 4], "a volume's lengths"),
        (45, &199u32.to_le_bytes(), "a volume's lengths"),
        (49, &[0; 4], "a volume's lengths"),
        (53, &[1], "a trace's lengths"),
        (57, &[1], "a trace's lengths"),
        (53, &[66, 0, 0, 0, 1, 0, 0, 0], "a trace's lengths"),
    ];
    check_refused(&facts.to_bytes(), UploadFacts::from_bytes, faults);
    let volume = facts;
    let bomb = UploadFacts { volume_raw_bytes: (2 << 20) + 1, ..volume };
    assert!(UploadFacts::from_bytes(&bomb.to_bytes()).is_err(), "it unpacks to more than a volume");
    let whole = UploadFacts { trace_bytes: 33 << 20, trace_raw_bytes: 64 << 20, ..volume };
    assert!(UploadFacts::from_bytes(&whole.to_bytes()).is_err(), "it is larger than a parcel");
    assert_eq!(volume.parcel_bytes(), 61 + 50);
}

#[test]
fn heartbeats_that_no_headset_sends_are_refused() {
    let dice = &mut RandomSource::new(2);
    let heartbeat = Heartbeat {
        lease: None,
        last_command: None,
        announcements: Announcements::new(),
        ..any_heartbeat(dice)
    };
    let bytes = heartbeat.to_bytes();
    let faults: &[(usize, &[u8], &str)] = &[
        (1, &[0; 4], "a headset's number"),
        (5, &[0; 8], "the bits of a start"),
        (13, &[0; 4], "a heartbeat's number"),
        (25, &[64], "flags"),
        (26, &[101], "a charge"),
        (27, &[3], "heat"),
        (28, &[11], "a visit's phase"),
        (35, &[101], "how full"),
        (44, &[1], "zeros where no lease"),
        (65, &[1], "zeros where no command"),
        (74, &[33], "up to 32"),
        (75, &[1], "zeros after the last"),
        (74, &[1], "a sculpture's id"),
        (25, &[16], "version 1 of a lease"),
        (25, &[32], "a command's id"),
    ];
    check_refused(&bytes, Heartbeat::from_bytes, faults);
    let announcement =
        Announcement { id: SculptureId(bytes_of(9)), badge: None, status: UploadStatus::Lost };
    let twice = Heartbeat { announcements: [announcement; 2].into_iter().collect(), ..heartbeat };
    let bad = Heartbeat::from_bytes(&twice.to_bytes()).expect_err("it is there twice");
    assert_eq!(bad.expected, "another sculpture's id");
    let mut other = any_heartbeat(dice);
    other.lease = Some(LeaseReport { headset: HEADSET + 1, epoch: 1, report: 1, taken: 0 });
    let bad = Heartbeat::from_bytes(&other.to_bytes()).expect_err("another headset's lease");
    assert_eq!(bad.expected, "the lease of the same headset");
}

#[test]
fn answers_that_no_booth_sends_are_refused() {
    let dice = &mut RandomSource::new(3);
    let command = BoothCommand {
        id: 1,
        boot_id: 2,
        session_id: 3,
        kind: CommandKind::Identify,
        lives_ms: 10_000,
    };
    let answer = HeartbeatAnswer { lease: None, command: Some(command), ..any_answer(dice) };
    let at = HeartbeatAnswer::BYTES - (1 + 32 * 21) - 27;
    let faults: &[(usize, &[u8], &str)] = &[
        (1, &[0; 16], "a site's id"),
        (17, &[0; 4], "a headset's number"),
        (41, &[4], "flags of an answer"),
        (at, &[0; 8], "a command's id"),
        (at + 24, &[5], "a command, 0 to 4"),
        (at + 25, &[0, 0], "a command's life"),
        (at + 25, &10_001u16.to_le_bytes(), "a command's life"),
        (41, &[0], "zeros where there is no command"),
    ];
    check_refused(&answer.to_bytes(), HeartbeatAnswer::from_bytes, faults);
    let mut lease = BadgeLease::new(HEADSET + 1, 5);
    let mut ledger = Box::new(BadgeLedger::new(90));
    let other = ledger.answer_report(&lease.make_report(), DAY_SECONDS).expect("an answer");
    let answer = HeartbeatAnswer { lease: Some(other), ..answer };
    let bad = HeartbeatAnswer::from_bytes(&answer.to_bytes()).expect_err("another's lease");
    assert_eq!(bad.expected, "the lease of the same headset");
}
