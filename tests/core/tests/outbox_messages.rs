//! What headset and booth tell each other: every message comes back from its bytes, no two bytes are the same message,
//! and what no writer makes is refused where it stands.

use std::fmt::Debug;

use paros_core::badge::{BadgeLease, BadgeLedger, BadgeNumber, DAY_SECONDS, LeaseReport};
use paros_core::codec::BadBytes;
use paros_core::outbox::messages::{
    AgeGroup, Announcement, AnnouncementState, Announcements, BoothCommand, CommandKind,
    CommandOutcome, CommandReport, ContentHash, DeviceHint, DeviceName, DeviceToken, EnrolAnswer,
    EnrolCommit, EnrolCommitAnswer, EnrolNonce, EnrolPoll, EnrolPollAnswer, EnrolReveal,
    EnrolRevealAnswer, EnrolState, EnrolmentToken, FinishCause, FleetEnrolment, Heartbeat,
    HeartbeatAnswer, HeatLevel, ParcelKind, Receipt, ReceiptKey, ReceiptOutcome, SculptureId,
    SignedReceipt, SiteId, UploadFacts, enrolment_pictograms, enrolment_transcript,
    nonce_commitment,
};
use paros_core::session::SessionMode;
use paros_core::visit::VisitPhase;
use paros_models::random_visitor::RandomSource;
use proptest::prelude::*;

const HEADSET: u32 = 17;

fn bytes<const N: usize>(dice: &mut RandomSource) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.fill_with(|| dice.next_bits() as u8);
    bytes[0] |= 1;
    bytes
}

fn pick<T: Copy>(dice: &mut RandomSource, all: &[T]) -> T {
    all[dice.next_bits() as usize % all.len()]
}

fn any_badge(dice: &mut RandomSource) -> Option<BadgeNumber> {
    BadgeNumber::new(dice.next_bits() as u32 % (BadgeNumber::COUNT + 1))
}

fn any_facts(dice: &mut RandomSource) -> UploadFacts {
    let kind = pick(dice, &ParcelKind::ALL);
    let stl_bytes = 84 + 50 * (dice.next_bits() % 100_000);
    let volume_raw_bytes = match kind {
        ParcelKind::Volume => 1 + dice.next_bits() as u32 % (2 << 20),
        ParcelKind::Mesh => stl_bytes as u32,
    };
    let has_trace = dice.next_bits() & 1 == 1;
    let trace_raw_bytes = if has_trace { 1 + dice.next_bits() as u32 % 1_000_000 } else { 0 };
    UploadFacts {
        kind,
        id: SculptureId(bytes(dice)),
        headset: HEADSET,
        badge: any_badge(dice),
        core_version: dice.next_bits() as u16,
        side: pick(dice, &[128, 256]),
        cause: pick(dice, &FinishCause::ALL),
        language: pick(dice, &[*b"en", *b"el"]),
        mode: pick(dice, &[SessionMode::FreeForm, SessionMode::Constrained { figure: 200 }]),
        age_group: pick(dice, &AgeGroup::ALL),
        sculpting_seconds: dice.next_bits() as u32,
        finished_at: dice.next_bits(),
        height_mm_tenths: 1 + dice.next_bits() as u16 % 3000,
        stl_hash: ContentHash(bytes(dice)),
        stl_bytes,
        volume_bytes: 1 + dice.next_bits() as u32 % volume_raw_bytes,
        volume_raw_bytes,
        trace_bytes: if has_trace { 1 + dice.next_bits() as u32 % trace_raw_bytes } else { 0 },
        trace_raw_bytes,
    }
}

fn any_receipt(dice: &mut RandomSource) -> SignedReceipt {
    let receipt = Receipt {
        site: SiteId(bytes(dice)),
        headset: HEADSET,
        id: SculptureId(bytes(dice)),
        hash: ContentHash(bytes(dice)),
        badge: any_badge(dice),
        outcome: pick(dice, &ReceiptOutcome::ALL),
    };
    SignedReceipt { receipt, signature: bytes(dice) }
}

fn any_announcements(dice: &mut RandomSource) -> Announcements {
    let any = |dice: &mut RandomSource| Announcement {
        id: SculptureId(bytes(dice)),
        badge: any_badge(dice),
        state: pick(dice, &AnnouncementState::ALL),
    };
    (0..dice.next_bits() % 33).map(|_| any(dice)).collect()
}

fn any_heartbeat(dice: &mut RandomSource) -> Heartbeat {
    let flag = |dice: &mut RandomSource| dice.next_bits() & 1 == 1;
    let lease = LeaseReport {
        headset: HEADSET,
        epoch: dice.next_bits(),
        report: dice.next_bits() as u32,
        taken: dice.next_bits() as u32,
    };
    let outcome = pick(dice, &CommandOutcome::ALL);
    let report = CommandReport { id: 1 + dice.next_bits() / 2, outcome };
    Heartbeat {
        headset: HEADSET,
        boot_id: dice.next_bits() | 1,
        number: dice.next_bits() as u32 | 1,
        session_id: dice.next_bits(),
        is_charging: flag(dice),
        is_worn: flag(dice),
        is_glowing: flag(dice),
        was_wiped: flag(dice),
        battery_percent: Some(dice.next_bits() as u8 % 101).filter(|_| flag(dice)),
        heat: pick(dice, &HeatLevel::ALL),
        phase: pick(dice, &VisitPhase::ALL),
        worn_seconds: dice.next_bits() as u32,
        outbox_depth: dice.next_bits() as u16,
        outbox_full_percent: dice.next_bits() as u8 % 101,
        app_version: [1, 2, dice.next_bits() as u16],
        core_version: dice.next_bits() as u16,
        lease: Some(lease).filter(|_| flag(dice)),
        last_command: Some(report).filter(|_| flag(dice)),
        announcements: any_announcements(dice),
    }
}

fn any_answer(dice: &mut RandomSource) -> HeartbeatAnswer {
    let mut lease = BadgeLease::new(HEADSET, dice.next_bits() | 1);
    let mut ledger = Box::new(BadgeLedger::new(90));
    let lease_answer = ledger.answer_report(&lease.make_report(), DAY_SECONDS).expect("an answer");
    let command = BoothCommand {
        id: 1 + dice.next_bits() / 2,
        boot_id: dice.next_bits(),
        session_id: dice.next_bits(),
        kind: pick(dice, &CommandKind::ALL),
        lives_ms: 1 + dice.next_bits() as u16 % 10_000,
    };
    HeartbeatAnswer {
        site: SiteId(bytes(dice)),
        headset: HEADSET,
        boot_id: dice.next_bits() | 1,
        number: dice.next_bits() as u32 | 1,
        booth_time: dice.next_bits(),
        lease: Some(lease_answer).filter(|_| dice.next_bits() & 1 == 1),
        command: Some(command).filter(|_| dice.next_bits() & 1 == 1),
        noted: any_announcements(dice),
    }
}

/// Bytes of a message, what reads them, and that as bytes again.
type Written = (&'static str, Vec<u8>, fn(&[u8]) -> Result<Vec<u8>, BadBytes>);

macro_rules! written {
    ($message:expr, $kind:ident) => {{
        let message = $message;
        let bytes = message.to_bytes();
        assert_eq!(bytes.len(), $kind::BYTES);
        assert_eq!($kind::from_bytes(&bytes).as_ref(), Ok(&message));
        let again: fn(&[u8]) -> Result<Vec<u8>, BadBytes> =
            |bytes| $kind::from_bytes(bytes).map(|message| message.to_bytes().to_vec());
        (stringify!($kind), bytes.to_vec(), again)
    }};
}

/// One of each message, of these dice.
fn list_messages(dice: &mut RandomSource) -> Vec<Written> {
    let name =
        DeviceName::new(pick(dice, &["", "Red 3", "Γραμμή 3", "a name of 32 bytes, no one more"]));
    let (name, hint) = (name.expect("a name"), DeviceHint(bytes(dice)));
    let (hash, nonce) = (ContentHash(bytes(dice)), EnrolNonce(bytes(dice)));
    let (site, key) = (SiteId(bytes(dice)), ReceiptKey(bytes(dice)));
    let (attempt, state) = (dice.next_bits(), pick(dice, &EnrolState::ALL));
    let fleet = EnrolmentToken(bytes(dice));
    let number = if state == EnrolState::Accepted { HEADSET } else { 0 };
    vec![
        written!(any_facts(dice), UploadFacts),
        written!(any_receipt(dice).receipt, Receipt),
        written!(any_receipt(dice), SignedReceipt),
        written!(any_heartbeat(dice), Heartbeat),
        written!(any_answer(dice), HeartbeatAnswer),
        written!(
            FleetEnrolment { enrolment_token: fleet, token_hash: hash, hint, name },
            FleetEnrolment
        ),
        written!(EnrolAnswer { headset: HEADSET, site, receipt_key: key }, EnrolAnswer),
        written!(EnrolCommit { commitment: hash, hint, name }, EnrolCommit),
        written!(
            EnrolCommitAnswer {
                attempt,
                booth_nonce: nonce,
                ca_hash: hash,
                receipt_key: key,
                site
            },
            EnrolCommitAnswer
        ),
        written!(EnrolReveal { attempt, nonce, token_hash: hash }, EnrolReveal),
        written!(EnrolRevealAnswer { state }, EnrolRevealAnswer),
        written!(EnrolPoll { attempt, token_hash: hash }, EnrolPoll),
        written!(EnrolPollAnswer { state, headset: number }, EnrolPollAnswer),
    ]
}

/// What is read is written as it was; what is refused is refused within the bytes.
fn check_read((name, _, again): &Written, bytes: &[u8]) {
    match again(bytes) {
        Ok(written) => assert_eq!(written, bytes, "{name}"),
        Err(bad) => assert!(bad.offset <= bytes.len() && !bad.expected.is_empty(), "{name}"),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn messages_come_back_from_their_bytes_and_from_no_others(seed: u64) {
        let dice = &mut RandomSource::new(seed);
        for message in list_messages(dice) {
            let (name, bytes, again) = &message;
            prop_assert_eq!(&again(bytes), &Ok(bytes.clone()), "{}", name);
            let cut = dice.next_bits() as usize % bytes.len();
            prop_assert!(again(&bytes[..cut]).is_err(), "{} of {} bytes", name, cut);
            let mut longer = bytes.clone();
            longer.push(0);
            let end = BadBytes { offset: bytes.len(), expected: "the end" };
            prop_assert_eq!(again(&longer), Err(end), "{}", name);
            let mut other = bytes.clone();
            other[0] = 2;
            prop_assert_eq!(again(&other).map_err(|bad| bad.offset), Err(0), "{}", name);
        }
    }

    #[test]
    fn bytes_of_any_kind_are_refused_or_read_as_what_they_are(seed: u64) {
        let dice = &mut RandomSource::new(seed);
        for mut message in list_messages(dice) {
            for _ in 0..20 {
                let at = dice.next_bits() as usize % message.1.len();
                let before = message.1[at];
                message.1[at] = pick(dice, &[0, 1, before ^ 1 << (seed % 8), 128, 255]);
                let bytes = message.1.clone();
                check_read(&message, &bytes);
                if dice.next_bits() & 3 != 0 {
                    message.1[at] = before;
                }
            }
            let mut noise = message.1.clone();
            noise.iter_mut().skip(1).for_each(|byte| *byte = dice.next_bits() as u8);
            check_read(&message, &noise);
        }
    }
}

/// Refused: the byte at `at` of a message set to `value`, where something else is `expected`.
fn check_refused<T: Debug>(
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
        kind: ParcelKind::Mesh,
        volume_bytes: 50,
        volume_raw_bytes: 134,
        stl_bytes: 134,
        trace_bytes: 0,
        trace_raw_bytes: 0,
        ..any_facts(&mut RandomSource::new(1))
    };
    let faults: &[(usize, &[u8], &str)] = &[
        (1, &[2], "0 for a volume"),
        (2, &[0; 16], "a sculpture's id"),
        (18, &[0; 4], "a headset's number"),
        (22, &BadgeNumber::COUNT.to_le_bytes(), "the number of a badge"),
        (28, &[64, 0], "128 or 256"),
        (30, &[3], "how a session ended"),
        (31, b"En", "two small letters"),
        (33, &[0, 0], "starts from"),
        (33, &[1, 7], "starts from"),
        (35, &[3], "an age group"),
        (48, &[0, 0], "a height"),
        (50, &[0; 32], "a SHA-256"),
        (82, &[83, 0], "an STL's length"),
        (82, &[135, 0], "an STL's length"),
        (82, &[184, 0], "a first file's lengths"),
        (90, &[0; 4], "a first file's lengths"),
        (90, &199u32.to_le_bytes(), "a first file's lengths"),
        (94, &133u32.to_le_bytes(), "a first file's lengths"),
        (98, &[1], "a trace's lengths"),
        (102, &[1], "a trace's lengths"),
        (98, &[66, 0, 0, 0, 1, 0, 0, 0], "a trace's lengths"),
    ];
    check_refused(&facts.to_bytes(), UploadFacts::from_bytes, faults);
    let volume = UploadFacts { kind: ParcelKind::Volume, ..facts };
    assert!(UploadFacts::from_bytes(&volume.to_bytes()).is_ok());
    let bomb = UploadFacts { volume_raw_bytes: (2 << 20) + 1, ..volume };
    assert!(UploadFacts::from_bytes(&bomb.to_bytes()).is_err(), "it unpacks to more than a volume");
    let whole = UploadFacts { trace_bytes: 33 << 20, trace_raw_bytes: 64 << 20, ..volume };
    assert!(UploadFacts::from_bytes(&whole.to_bytes()).is_err(), "it is larger than a parcel");
    assert_eq!(volume.parcel_bytes(), 106 + 50);
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
        Announcement { id: SculptureId(bytes_of(9)), badge: None, state: AnnouncementState::Lost };
    let twice = Heartbeat { announcements: [announcement; 2].into_iter().collect(), ..heartbeat };
    let bad = Heartbeat::from_bytes(&twice.to_bytes()).expect_err("it is there twice");
    assert_eq!(bad.expected, "another sculpture's id");
    let mut other = any_heartbeat(dice);
    other.lease = Some(LeaseReport { headset: HEADSET + 1, epoch: 1, report: 1, taken: 0 });
    let bad = Heartbeat::from_bytes(&other.to_bytes()).expect_err("another headset's lease");
    assert_eq!(bad.expected, "the lease of the same headset");
}

fn bytes_of<const N: usize>(value: u8) -> [u8; N] {
    [value; N]
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

#[test]
fn receipts_are_signed_under_a_context_of_their_own() {
    let SignedReceipt { receipt, .. } = any_receipt(&mut RandomSource::new(4));
    let signed = receipt.signed_bytes();
    assert!(signed.starts_with(b"paros receipt v1\0"));
    assert_eq!(signed[17..], receipt.to_bytes());
    let faults: &[(usize, &[u8], &str)] = &[(17, &[0; 4], "a headset's"), (73, &[2], "0 for kept")];
    check_refused(&receipt.to_bytes(), Receipt::from_bytes, faults);
}

#[test]
fn enrolments_by_hand_show_24_bits_of_all_that_was_said() {
    let dice = &mut RandomSource::new(5);
    let (nonce, token_hash) = (EnrolNonce(bytes(dice)), ContentHash(bytes(dice)));
    let name = DeviceName::new("Red 3").expect("a name");
    let committed = nonce_commitment(&nonce, &token_hash);
    assert_eq!(committed, [nonce.0, token_hash.0].concat()[..]);
    let commit =
        EnrolCommit { commitment: ContentHash(bytes(dice)), hint: DeviceHint([1; 16]), name };
    let answer = EnrolCommitAnswer {
        attempt: 6,
        booth_nonce: EnrolNonce(bytes(dice)),
        ca_hash: ContentHash(bytes(dice)),
        receipt_key: ReceiptKey(bytes(dice)),
        site: SiteId(bytes(dice)),
    };
    let reveal = EnrolReveal { attempt: 6, nonce, token_hash };
    let said =
        [&b"paros enrol v1\0"[..], &commit.to_bytes(), &answer.to_bytes(), &reveal.to_bytes()];
    assert_eq!(enrolment_transcript(&commit, &answer, &reveal)[..], said.concat());
    let mut hash = [0; 32];
    hash[..4].copy_from_slice(&[0b0000_0100, 0b0010_0000, 0b1111_1111, 0b1111_1111]);
    let shown = enrolment_pictograms(&ContentHash(hash)).map(|pictogram| pictogram.number());
    assert_eq!(shown, [1, 2, 3, 63]);
    let accepted = EnrolPollAnswer { state: EnrolState::Accepted, headset: HEADSET };
    let faults: &[(usize, &[u8], &str)] = &[
        (1, &[0], "where it is accepted"),
        (2, &[0; 4], "where it is accepted"),
        (1, &[4], "stands"),
    ];
    check_refused(&accepted.to_bytes(), EnrolPollAnswer::from_bytes, faults);
}

#[test]
fn names_are_text_that_fits() {
    let cut = DeviceName::new("Ακρόπολη, τρίτη αίθουσα").expect("a name");
    assert_eq!(cut.as_str(), "Ακρόπολη, τρίτη α", "whole characters alone");
    assert_eq!(DeviceName::new("a\nb"), None);
    assert_eq!(DeviceName::new("a\0b"), None);
    let commit =
        EnrolCommit { commitment: ContentHash([1; 32]), hint: DeviceHint([1; 16]), name: cut };
    let faults: &[(usize, &[u8], &str)] = &[
        (49, &[0xff], "a name"),
        (49, b"\n", "a name"),
        (50, b"\0a\0b", "a name"),
        (80, &[0xc3], "a name"),
    ];
    check_refused(&commit.to_bytes(), EnrolCommit::from_bytes, faults);
}

#[test]
fn ids_are_read_as_they_are_shown_and_secrets_are_not_shown() {
    let id = SculptureId(bytes_of(0xa5));
    assert_eq!(id.to_string(), "a5".repeat(16));
    assert_eq!(SculptureId::parse_hex(&id.to_string()), Some(id));
    assert_eq!(SculptureId::parse_hex(&"A5".repeat(16)), Some(id));
    assert_eq!(format!("{id:?}"), format!("SculptureId({id})"));
    for text in ["", "a5", &"a5".repeat(17), &"g5".repeat(16), &"é".repeat(16), &"+5".repeat(16)] {
        assert_eq!(SculptureId::parse_hex(text), None, "{text}");
    }
    let token = DeviceToken([0xb7; 32]);
    assert_eq!(format!("{token:?}"), "DeviceToken(not shown)");
    assert_eq!(token.reveal().to_string(), "b7".repeat(32));
}
