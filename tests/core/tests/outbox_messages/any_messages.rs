//! Messages of dice.

use paros_core::badge::{BadgeLease, BadgeLedger, BadgeNumber, DAY_SECONDS, LeaseReport};
use paros_core::codec::BadBytes;
use paros_core::outbox::messages::{
    AgeGroup, Announcement, Announcements, BoothCommand, CommandKind, CommandOutcome,
    CommandReport, ContentHash, DeviceHint, DeviceName, EnrolAnswer, EnrolmentToken, FinishCause,
    FleetEnrolment, Heartbeat, HeartbeatAnswer, HeatLevel, SculptureId, SiteId, UploadFacts,
    UploadStatus,
};
use paros_core::session::SessionMode;
use paros_core::visit::VisitPhase;
use paros_models::random_visitor::RandomSource;

pub(crate) const HEADSET: u32 = 17;

pub(crate) fn bytes_of<const N: usize>(value: u8) -> [u8; N] {
    [value; N]
}

pub(crate) fn bytes<const N: usize>(dice: &mut RandomSource) -> [u8; N] {
    let mut bytes = [0; N];
    bytes.fill_with(|| dice.next_bits() as u8);
    bytes[0] |= 1;
    bytes
}

pub(crate) fn pick<T: Copy>(dice: &mut RandomSource, all: &[T]) -> T {
    all[dice.next_bits() as usize % all.len()]
}

pub(crate) fn any_badge(dice: &mut RandomSource) -> Option<BadgeNumber> {
    BadgeNumber::new(dice.next_bits() as u32 % (BadgeNumber::COUNT + 1))
}

pub(crate) fn any_facts(dice: &mut RandomSource) -> UploadFacts {
    let volume_raw_bytes = 1 + dice.next_bits() as u32 % (2 << 20);
    let has_trace = dice.next_bits() & 1 == 1;
    let trace_raw_bytes = if has_trace { 1 + dice.next_bits() as u32 % 1_000_000 } else { 0 };
    UploadFacts {
        id: SculptureId(bytes(dice)),
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
        volume_bytes: 1 + dice.next_bits() as u32 % volume_raw_bytes,
        volume_raw_bytes,
        trace_bytes: if has_trace { 1 + dice.next_bits() as u32 % trace_raw_bytes } else { 0 },
        trace_raw_bytes,
    }
}

pub(crate) fn any_announcements(dice: &mut RandomSource) -> Announcements {
    let any = |dice: &mut RandomSource| Announcement {
        id: SculptureId(bytes(dice)),
        badge: any_badge(dice),
        status: pick(dice, &UploadStatus::ALL),
    };
    (0..dice.next_bits() % 33).map(|_| any(dice)).collect()
}

pub(crate) fn any_heartbeat(dice: &mut RandomSource) -> Heartbeat {
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

pub(crate) fn any_answer(dice: &mut RandomSource) -> HeartbeatAnswer {
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
pub(crate) type Written = (&'static str, Vec<u8>, fn(&[u8]) -> Result<Vec<u8>, BadBytes>);

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
pub(crate) fn list_messages(dice: &mut RandomSource) -> Vec<Written> {
    let name =
        DeviceName::new(pick(dice, &["", "Red 3", "Γραμμή 3", "a name of 32 bytes, no one more"]));
    let (name, hint) = (name.expect("a name"), DeviceHint(bytes(dice)));
    let hash = ContentHash(bytes(dice));
    let site = SiteId(bytes(dice));
    let fleet = EnrolmentToken(bytes(dice));
    vec![
        written!(any_facts(dice), UploadFacts),
        written!(any_heartbeat(dice), Heartbeat),
        written!(any_answer(dice), HeartbeatAnswer),
        written!(
            FleetEnrolment { enrolment_token: fleet, token_hash: hash, hint, name },
            FleetEnrolment
        ),
        written!(EnrolAnswer { headset: HEADSET, site }, EnrolAnswer),
    ]
}
