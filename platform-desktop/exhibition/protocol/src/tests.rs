//! Checks that messages survive a round trip through JSON, and that invalid fields are rejected by name.

use paros_core::badge::{BadgeNumber, LEASED_BLOCKS};
use paros_core::session::SessionMode;
use paros_core::visit::VisitPhase;
use proptest::prelude::*;
use serde_json::{Value, json};

use super::*;

const HEADSET: u32 = 17;

/// A pseudorandom generator (splitmix64).
struct RandomSource(u64);

impl RandomSource {
    const fn new(seed: u64) -> Self {
        RandomSource(seed)
    }

    const fn next_bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let bits = (self.0 ^ self.0 >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let bits = (bits ^ bits >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^ bits >> 31
    }
}

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
    let volume_raw_bytes = 1 + dice.next_bits() as u32 % (2 << 20);
    let has_trace = dice.next_bits() & 1 == 1;
    let trace_raw_bytes = if has_trace { 1 + dice.next_bits() as u32 % 1_000_000 } else { 0 };
    let badge = any_badge(dice);
    let is_leased = badge.is_some_and(|badge| !badge.is_provisional());
    UploadFacts {
        id: SculptureId(bytes(dice)),
        badge,
        badge_serial: Some(BlockSerial(bytes(dice))).filter(|_| is_leased),
        core_version: dice.next_bits() as u16,
        side: pick(dice, &[128, 256]),
        cause: pick(dice, &[FinishCause::Finished, FinishCause::Left, FinishCause::CutOff]),
        language: pick(dice, &[*b"en", *b"el"]),
        mode: pick(dice, &[SessionMode::FreeForm, SessionMode::Constrained { figure: 200 }]),
        age_group: pick(dice, &[AgeGroup::Unknown, AgeGroup::UnderAge, AgeGroup::OfAge]),
        sculpting_seconds: dice.next_bits() as u32,
        finished_at: dice.next_bits(),
        height_mm_tenths: 1 + dice.next_bits() as u16 % 3000,
        volume_bytes: 1 + dice.next_bits() as u32 % volume_raw_bytes,
        volume_raw_bytes,
        trace_bytes: if has_trace { 1 + dice.next_bits() as u32 % trace_raw_bytes } else { 0 },
        trace_raw_bytes,
    }
}

fn any_announcements(dice: &mut RandomSource) -> Vec<Announcement> {
    let any = |dice: &mut RandomSource| Announcement {
        id: SculptureId(bytes(dice)),
        badge: any_badge(dice),
        status: pick(dice, &UploadStatus::ALL),
    };
    (0..dice.next_bits() % 65).map(|_| any(dice)).collect()
}

/// Makes up to two different blocks.
fn any_blocks(dice: &mut RandomSource) -> Vec<HeldBlock> {
    let half = LEASED_BLOCKS as u64 / 2;
    let any = |at: u64, dice: &mut RandomSource| HeldBlock {
        block: (at * half + dice.next_bits() % half) as u16,
        serial: BlockSerial(bytes(dice)),
        next: (dice.next_bits() % 65) as u8,
    };
    (0..dice.next_bits() % 3).map(|at| any(at, dice)).collect()
}

fn any_heartbeat(dice: &mut RandomSource) -> Heartbeat {
    let flag = |dice: &mut RandomSource| dice.next_bits() & 1 == 1;
    let outcomes = [CommandOutcome::Done, CommandOutcome::Expired, CommandOutcome::Refused];
    let report = CommandReport { id: 1 + dice.next_bits() / 2, outcome: pick(dice, &outcomes) };
    let badges = BadgeReport { epoch: dice.next_bits() | 1, blocks: any_blocks(dice) };
    Heartbeat {
        number: dice.next_bits() as u32 | 1,
        status: HeadsetStatus {
            session_id: dice.next_bits(),
            is_charging: flag(dice),
            is_worn: flag(dice),
            is_glowing: flag(dice),
            battery_percent: Some(dice.next_bits() as u8 % 101).filter(|_| flag(dice)),
            heat: pick(dice, &[HeatLevel::Normal, HeatLevel::Warm, HeatLevel::Hot]),
            phase: pick(dice, &VisitPhase::ALL),
            worn_seconds: dice.next_bits() as u32,
            app_version: [1, 2, dice.next_bits() as u16],
        },
        was_wiped: flag(dice),
        outbox_depth: dice.next_bits() as u16,
        outbox_full_percent: dice.next_bits() as u8 % 101,
        core_version: dice.next_bits() as u16,
        last_command: Some(report).filter(|_| flag(dice)),
        announcements: any_announcements(dice),
        ..Heartbeat::first(HEADSET, dice.next_bits() | 1, badges)
    }
}

fn any_answer(dice: &mut RandomSource) -> HeartbeatAnswer {
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
        store_epoch: dice.next_bits(),
        badges: any_blocks(dice),
        command: Some(command).filter(|_| dice.next_bits() & 1 == 1),
        noted: any_announcements(dice),
    }
}

fn any_enrolment(dice: &mut RandomSource) -> FleetEnrolment {
    let name = pick(dice, &["", "Red 3", "Γραμμή 3", "a name of 32 bytes, no one more"]);
    FleetEnrolment {
        enrolment_token: EnrolmentToken(bytes(dice)),
        token_hash: ContentHash(bytes(dice)),
        hint: DeviceHint(bytes(dice)),
        name: DeviceName::new(name).expect("a name"),
    }
}

type Read<M> = fn(&[u8]) -> Result<M, ProtocolError>;

fn check<M: PartialEq + std::fmt::Debug>(message: &M, json: &[u8], read: Read<M>) {
    assert_eq!(&read(json).expect("its own"), message);
    // A later program's message has more fields.
    let mut value: Value = serde_json::from_slice(json).expect("JSON");
    value["later"] = json!({"deep": [1, 2, 3]});
    let more = serde_json::to_vec(&value).expect("JSON");
    assert_eq!(&read(&more).expect("the rest is ignored"), message);
    assert!(read(&json[..json.len() - 1]).is_err(), "it is cut");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn messages_come_back_from_their_json(seed: u64) {
        let dice = &mut RandomSource::new(seed);
        let (facts, beat, answer) = (any_facts(dice), any_heartbeat(dice), any_answer(dice));
        check(&facts, &facts.to_json(), UploadFacts::from_json);
        check(&beat, &beat.to_json(), Heartbeat::from_json);
        check(&answer, &answer.to_json(), HeartbeatAnswer::from_json);
        let enrolment = any_enrolment(dice);
        check(&enrolment, &enrolment.to_json(), FleetEnrolment::from_json);
        let enrolled = EnrolAnswer { headset: HEADSET, site: SiteId(bytes(dice)) };
        check(&enrolled, &enrolled.to_json(), EnrolAnswer::from_json);
    }

    /// Checks that no altered parcel is accepted, whatever its hash.
    #[test]
    fn parcels_come_back_and_spoilt_ones_are_refused(seed: u64) {
        let dice = &mut RandomSource::new(seed);
        let trace = b"nor a trace".repeat(dice.next_bits() as usize % 9);
        let parcel = Parcel::pack(&any_facts(dice), b"not quite a volume", Some(&trace)).unwrap();
        let file = parcel.file_bytes();
        let read = Parcel::read(file).expect("its own");
        prop_assert_eq!((read.facts(), read.hash()), (parcel.facts(), parcel.hash()));
        let head = [&parcel.facts().to_head()[..], parcel.volume()].concat();
        prop_assert_eq!(read.sculpture(), &head[..]);
        prop_assert_eq!([read.sculpture(), read.trace(), &read.hash().0].concat(), file);
        let at = dice.next_bits() as usize % file.len();
        let mut spoilt = file.to_vec();
        spoilt[at] ^= 1 + dice.next_bits() as u8 % 255;
        for bytes in [&spoilt[..], &file[..at], &[file, b"x"].concat()] {
            let is_damaged = matches!(Parcel::read(bytes), Err(ParcelFault::Damaged { .. }));
            prop_assert!(is_damaged);
        }
        let bytes = &file[..file.len() - ContentHash::BYTES];
        let at = at.min(bytes.len() - 1);
        prop_assert!(Parcel::read(append_hash(bytes[..at].to_vec())).is_err(), "cut at {at}");
        spoilt.truncate(bytes.len());
        // Other facts, or other packed files: reading them doesn't panic.
        if let Ok(read) = Parcel::read(append_hash(spoilt)) {
            prop_assert_eq!(read.sculpture().len() + read.trace().len(), bytes.len());
        }
    }
}

/// Pins the format: headsets and booths of different versions exchange these bytes.
#[test]
fn a_parcel_has_the_same_bytes_as_ever() {
    let facts = UploadFacts {
        id: SculptureId([1; 16]),
        badge: BadgeNumber::new(77),
        badge_serial: Some(BlockSerial([7; 8])),
        core_version: 12,
        side: 128,
        cause: FinishCause::Left,
        language: *b"el",
        mode: SessionMode::Constrained { figure: 2 },
        age_group: AgeGroup::OfAge,
        sculpting_seconds: 540,
        finished_at: 1_790_000_000,
        height_mm_tenths: 1200,
        volume_bytes: 0,
        volume_raw_bytes: 0,
        trace_bytes: 0,
        trace_raw_bytes: 0,
    };
    let (volume, trace) = (b"not quite a volume".repeat(40), b"nor a trace".repeat(50));
    let parcel = Parcel::pack(&facts, &volume, Some(&trace)).expect("a parcel");
    let hash = "1743cf44a149ea94717ccb69c9743dfe0140d992017157aa972dda13e1727465";
    assert_eq!((parcel.file_bytes().len(), parcel.hash().to_string().as_str()), (470, hash));
}

#[test]
fn what_is_no_parcel_is_refused_with_a_place() {
    let facts =
        UploadFacts { trace_bytes: 0, trace_raw_bytes: 0, ..any_facts(&mut RandomSource::new(3)) };
    let parcel = Parcel::pack(&facts, b"not quite a volume", None).expect("a parcel");
    let file = parcel.file_bytes();
    let (bytes, head) = (&file[..file.len() - 32], parcel.facts().to_head().len());
    let fault = |bytes: &[u8]| Parcel::read(bytes).expect_err("no parcel").to_string();
    let hashed = |bytes: &[u8]| fault(&append_hash(bytes.to_vec()));
    let packed = parcel.volume().len();
    let short =
        format!("byte {head}: expected {packed} bytes of packed files, found {}", packed - 1);
    assert_eq!(hashed(&bytes[..bytes.len() - 1]), short);
    assert_eq!(hashed(&[1, 0]), "byte 0: expected 4 bytes of a head's length, found 2");
    assert_eq!(hashed(&[9, 0, 0, 0, 7]), "byte 4: expected 9 bytes of head, found 1");
    let long = "byte 0: expected the length of a head, at most 4096, found 4294967295";
    assert_eq!(hashed(&[0xff; 4]), long);
    assert!(hashed(&[2, 0, 0, 0, b'{', b'}']).starts_with("byte 4: no message"));
    assert_eq!(fault(b"short"), "byte 0: expected the SHA-256 of the bytes before");
    let end = limits::MAX_PARCEL_FILE_BYTES;
    let large = vec![0; end as usize + 1];
    assert_eq!(
        fault(&large),
        format!("byte {end}: expected the end of the parcel, found {} bytes", end + 1)
    );
}

/// Checks that a link accepts the longest answer of a booth.
#[test]
fn a_link_reads_the_longest_answer() {
    let dice = &mut RandomSource::new(1);
    let answer = loop {
        let answer = any_answer(dice);
        if answer.noted.len() == limits::MAX_ANNOUNCEMENTS
            && answer.badges.len() == 2
            && answer.command.is_some()
        {
            break answer;
        }
    };
    let length = answer.to_json().len();
    assert!((5000..limits::MAX_ANSWER_BYTES).contains(&length), "{length}");
}

#[test]
fn another_version_says_which_program_to_update() {
    let refused = |version: u16| {
        let answer = json!({ "version": version, "headset": 1, "site": "05".repeat(16) });
        let error = EnrolAnswer::from_json(answer.to_string().as_bytes());
        error.expect_err("another version").to_string()
    };
    assert_eq!(refused(2), "version 2 of the protocol, expected 1: update this program");
    assert_eq!(
        refused(0),
        "version 0 of the protocol, expected 1: update the program that sent it"
    );
}

/// Checks that a message with one of these values in a field is rejected.
fn refuse<M>(message: &[u8], read: Read<M>, faults: &[(&str, Value)]) {
    for (field, value) in faults {
        let mut json: Value = serde_json::from_slice(message).expect("JSON");
        let place = json.pointer_mut(field).unwrap_or_else(|| panic!("{field}: no such field"));
        *place = value.clone();
        let bytes = serde_json::to_vec(&json).expect("JSON");
        assert!(read(&bytes).is_err(), "{field}: {value}");
    }
}

#[test]
fn values_that_nobody_writes_are_refused() {
    let dice = &mut RandomSource::new(2);
    let facts = UploadFacts {
        badge: BadgeNumber::new(77),
        badge_serial: Some(BlockSerial([7; 8])),
        trace_bytes: 0,
        trace_raw_bytes: 0,
        ..any_facts(dice)
    };
    refuse(
        &facts.to_json(),
        UploadFacts::from_json,
        &[
            ("/id", json!("00".repeat(16))),
            ("/id", json!("5".repeat(31))),
            ("/badge", json!(BadgeNumber::COUNT)),
            ("/badge", json!(BadgeNumber::provisional(1).get())),
            ("/side", json!(64)),
            ("/cause", json!("ran_away")),
            ("/language", json!("En")),
            ("/language", json!("eng")),
            ("/mode", json!("none")),
            ("/mode", json!({"constrained": {"figure": 256}})),
            ("/height_mm_tenths", json!(0)),
            ("/volume_bytes", json!(0)),
            ("/volume_bytes", json!(-1)),
            ("/volume_raw_bytes", json!(0)),
            ("/volume_raw_bytes", json!((2 << 20) + 1)),
            ("/trace_bytes", json!(1)),
            ("/trace_raw_bytes", json!(1)),
        ],
    );
    let whole = UploadFacts { trace_bytes: 33 << 20, trace_raw_bytes: 64 << 20, ..facts };
    assert!(whole.check().is_err(), "it is larger than a parcel");
    let command = BoothCommand {
        id: 1,
        boot_id: 2,
        session_id: 3,
        kind: CommandKind::Identify,
        lives_ms: 10_000,
    };
    let announced =
        Announcement { id: SculptureId([9; 16]), badge: None, status: UploadStatus::Lost };
    let held = HeldBlock { block: 1, serial: BlockSerial([7; 8]), next: 64 };
    let badges = BadgeReport { epoch: 1, blocks: vec![held, HeldBlock { block: 2, ..held }] };
    let beat = Heartbeat {
        badges,
        last_command: Some(CommandReport { id: 1, outcome: CommandOutcome::Done }),
        announcements: vec![announced],
        ..any_heartbeat(dice)
    };
    refuse(
        &beat.to_json(),
        Heartbeat::from_json,
        &[
            ("/headset", json!(0)),
            ("/boot_id", json!(0)),
            ("/number", json!(0)),
            ("/battery_percent", json!(101)),
            ("/outbox_full_percent", json!(101)),
            ("/heat", json!("boiling")),
            ("/phase", json!(11)),
            ("/badges/epoch", json!(0)),
            ("/badges/blocks/0/block", json!(LEASED_BLOCKS)),
            ("/badges/blocks/0/block", json!(2)),
            ("/badges/blocks/0/next", json!(65)),
            ("/badges/blocks/0/serial", json!("0000000000000000")),
            ("/badges/blocks", json!([held, held, held])),
            ("/last_command/id", json!(0)),
            ("/announcements/0/status", json!("eaten")),
        ],
    );
    let many = |list: Vec<Announcement>| Heartbeat { announcements: list, ..beat.clone() };
    assert!(many(vec![announced; 2]).check().is_err(), "an id is there twice");
    let other = |k: u8| Announcement { id: SculptureId([k; 16]), ..announced };
    assert!(many((1..=64).map(other).collect()).check().is_ok());
    assert!(many((1..=65).map(other).collect()).check().is_err());
    let answer = HeartbeatAnswer {
        command: Some(command),
        badges: vec![held, HeldBlock { block: 2, ..held }],
        ..any_answer(dice)
    };
    refuse(
        &answer.to_json(),
        HeartbeatAnswer::from_json,
        &[
            ("/site", json!("00".repeat(16))),
            ("/headset", json!(0)),
            ("/badges/0/block", json!(LEASED_BLOCKS)),
            ("/badges/0/block", json!(2)),
            ("/badges/0/next", json!(65)),
            ("/badges", json!([held, held, held])),
            ("/command/id", json!(0)),
            ("/command/lives_ms", json!(0)),
            ("/command/lives_ms", json!(10_001)),
        ],
    );
    refuse(
        &any_enrolment(dice).to_json(),
        FleetEnrolment::from_json,
        &[("/name", json!("a\nb")), ("/hint", json!("zz"))],
    );
}

#[test]
fn names_are_text_that_fits() {
    let cut = DeviceName::new("Ακρόπολη, τρίτη αίθουσα").expect("a name");
    assert_eq!(cut.as_str(), "Ακρόπολη, τρίτη α", "whole characters alone");
    assert_eq!(DeviceName::new("a\nb"), None);
    assert_eq!(DeviceName::new("a\0b"), None);
}

#[test]
fn ids_are_read_as_they_are_shown_and_secrets_are_not_shown() {
    let id = SculptureId([0xa5; 16]);
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
