//! What the outbox reads: the booth's messages and parcels. Refused at an offset within the bytes, or read as
//! what they are: written again they are the same.

use paros_core::codec::BadBytes;
use paros_core::outbox::messages::{
    AgeGroup, Announcement, Announcements, ContentHash, EnrolAnswer, FinishCause, FleetEnrolment,
    Heartbeat, HeartbeatAnswer, HeatLevel, SculptureId, UploadFacts, UploadStatus,
};
use paros_core::session::SessionMode;
use paros_core::visit::VisitPhase;
use paros_shell::outbox::{Parcel, ParcelFault};
use sha2::{Digest as _, Sha256};

use crate::engine::FuzzTarget;

/// An input is a byte that says which message, and the message.
pub(super) const MESSAGE: FuzzTarget = FuzzTarget {
    name: "message",
    seeds: message_seeds,
    words: &[b"\x01", b"\x01\0\0\0", b"\xff\xff\xff\xff", b"\0\0\x20\0", b"\x10\x27", b"en"],
    longest: 1 + HeartbeatAnswer::BYTES,
    runs: 30_000,
    run: run_message,
};

/// An input is a parcel without its hash.
pub(super) const PARCEL: FuzzTarget = FuzzTarget {
    name: "parcel",
    seeds: parcel_seeds,
    words: &[b"\x01", b"\0\0\0\0", b"\xff\xff\xff\xff", b"el"],
    longest: 400,
    runs: 20_000,
    run: run_parcel,
};

const HEARTBEAT: Heartbeat = Heartbeat {
    headset: 17,
    boot_id: 3,
    number: 1,
    session_id: 5,
    is_charging: true,
    is_worn: false,
    is_glowing: false,
    was_wiped: true,
    battery_percent: Some(50),
    heat: HeatLevel::Warm,
    phase: VisitPhase::Attract,
    worn_seconds: 0,
    outbox_depth: 2,
    outbox_full_percent: 1,
    app_version: [0, 1, 0],
    core_version: 12,
    lease: None,
    last_command: None,
    announcements: Announcements::new(),
};

const FACTS: UploadFacts = UploadFacts {
    id: SculptureId([1; 16]),
    badge: None,
    core_version: 12,
    side: 128,
    cause: FinishCause::Left,
    language: *b"el",
    mode: SessionMode::Constrained { figure: 2 },
    age_group: AgeGroup::OfAge,
    sculpting_seconds: 540,
    finished_at: 1_790_000_000,
    height_mm_tenths: 1200,
    volume_bytes: 20,
    volume_raw_bytes: 30,
    trace_bytes: 0,
    trace_raw_bytes: 0,
};

/// Reads a message; its bytes again.
type ReadAgain = fn(&[u8]) -> Result<Vec<u8>, BadBytes>;

macro_rules! messages {
    ($($message:ident)*) => {
        [$(|bytes: &[u8]| $message::from_bytes(bytes).map(|read| read.to_bytes().to_vec())),*]
    };
}

const MESSAGES: [ReadAgain; 5] = messages! {
    UploadFacts Heartbeat HeartbeatAnswer FleetEnrolment EnrolAnswer
};

fn message_seeds() -> Vec<Vec<u8>> {
    let statuses = [UploadStatus::Making, UploadStatus::Kept, UploadStatus::Sent];
    let announced = statuses.map(|status| Announcement {
        id: SculptureId([1 + status as u8; 16]),
        badge: None,
        status,
    });
    let heartbeat = Heartbeat { announcements: announced.into_iter().collect(), ..HEARTBEAT };
    let lengths = [HeartbeatAnswer::BYTES, FleetEnrolment::BYTES];
    let ones = lengths.iter().zip([2, 3]).map(|(&len, kind)| {
        let mut seed = vec![1; 1 + len];
        seed[0] = kind;
        seed
    });
    let made = [[&[0][..], &FACTS.to_bytes()].concat(), [&[1][..], &heartbeat.to_bytes()].concat()];
    ones.chain(made).collect()
}

fn run_message(bytes: &[u8]) -> String {
    let Some((&kind, message)) = bytes.split_first() else { return "nothing".into() };
    let kind = usize::from(kind) % MESSAGES.len();
    match MESSAGES[kind](message) {
        Ok(again) => {
            assert_eq!(again, message);
            format!("message {kind}")
        }
        Err(bad) => {
            assert!(bad.offset <= message.len());
            format!("{kind}: {}", bad.expected)
        }
    }
}

fn parcel_seeds() -> Vec<Vec<u8>> {
    let packed = Parcel::pack(&FACTS, b"not quite a volume", Some(b"nor a trace"));
    let mut bytes = packed.expect("a parcel").into_file();
    bytes.truncate(bytes.len() - ContentHash::BYTES);
    vec![bytes]
}

fn run_parcel(bytes: &[u8]) -> String {
    let file = [bytes, &Sha256::digest(bytes)[..]].concat();
    match Parcel::from_file(file.clone()) {
        Ok(parcel) => {
            assert_eq!(parcel.file_bytes(), file);
            "a parcel".into()
        }
        Err(ParcelFault::Head(bad)) => {
            assert!(bad.offset <= bytes.len());
            bad.expected.into()
        }
        Err(fault) => fault.to_string(),
    }
}
