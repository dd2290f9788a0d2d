//! The outbox's inputs: the booth's messages and parcels. They are rejected at an offset within the bytes, or
//! unchanged by a round trip.

use paros_core::session::SessionMode;
use paros_protocol::{
    AgeGroup, Announcement, BadgeReport, BlockSerial, ContentHash, DeviceHint, DeviceName,
    EnrolAnswer, EnrolmentToken, FinishCause, FleetEnrolment, Heartbeat, HeartbeatAnswer,
    HeldBlock, Parcel, ParcelFault, ProtocolError, SculptureId, SiteId, UploadFacts, UploadStatus,
    append_hash,
};

use crate::engine::FuzzTarget;

/// The input is a byte that selects the message, and the message.
pub(super) const MESSAGE: FuzzTarget = FuzzTarget {
    name: "message",
    seeds: message_seeds,
    words: &[
        b"null",
        b"[]",
        b"-1",
        b"1e99",
        b"18446744073709551615",
        b"\"\"",
        b"{",
        b"\\u0000",
        b"true",
    ],
    longest: 4096,
    runs: 30_000,
    run: run_message,
};

/// The input is a parcel without its hash.
pub(super) const PARCEL: FuzzTarget = FuzzTarget {
    name: "parcel",
    seeds: parcel_seeds,
    words: &[b"\x01", b"\0\0\0\0", b"\xff\xff\xff\xff", b"el"],
    longest: 1000,
    runs: 20_000,
    run: run_parcel,
};

const FACTS: UploadFacts = UploadFacts {
    id: SculptureId([1; 16]),
    badge: None,
    badge_serial: None,
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

/// Reads a message and encodes it again.
type ReadAgain = fn(&[u8]) -> Result<Vec<u8>, ProtocolError>;

macro_rules! messages {
    ($($message:ident)*) => {
        [$(|bytes: &[u8]| $message::from_json(bytes).map(|read| read.to_json())),*]
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
    let badges = BadgeReport { epoch: 9, blocks: Vec::new() };
    let first = Heartbeat::first(17, 3, badges);
    let heartbeat = Heartbeat { announcements: announced.to_vec(), ..first };
    let answer = HeartbeatAnswer {
        site: SiteId([7; 16]),
        headset: 17,
        boot_id: 3,
        number: 1,
        booth_time: 1_790_000_000,
        store_epoch: 1,
        badges: vec![HeldBlock { block: 5, serial: BlockSerial([4; 8]), next: 63 }],
        command: None,
        noted: heartbeat.announcements.clone(),
    };
    let enrolment = FleetEnrolment {
        enrolment_token: EnrolmentToken([1; 32]),
        token_hash: ContentHash([2; 32]),
        hint: DeviceHint([3; 16]),
        name: DeviceName::new("Red 3").expect("a name"),
    };
    let enrolled = EnrolAnswer { headset: 17, site: SiteId([7; 16]) };
    let messages = [
        FACTS.to_json(),
        heartbeat.to_json(),
        answer.to_json(),
        enrolment.to_json(),
        enrolled.to_json(),
    ];
    let seed = |(kind, json): (usize, Vec<u8>)| [&[kind as u8][..], &json].concat();
    messages.into_iter().enumerate().map(seed).collect()
}

fn run_message(bytes: &[u8]) -> String {
    let Some((&kind, message)) = bytes.split_first() else { return "nothing".into() };
    let kind = usize::from(kind) % MESSAGES.len();
    match MESSAGES[kind](message) {
        Ok(json) => {
            let again = MESSAGES[kind](&json);
            assert_eq!(again.expect("it was written"), json);
            format!("message {kind}")
        }
        // The place within the JSON differs with each input.
        Err(ProtocolError::Json(why)) => format!("{kind}: {:?}", why.classify()),
        Err(why) => format!("{kind}: {why}"),
    }
}

fn parcel_seeds() -> Vec<Vec<u8>> {
    let packed = Parcel::pack(&FACTS, b"not quite a volume", Some(b"nor a trace"));
    let mut bytes = packed.expect("a parcel").into_file();
    bytes.truncate(bytes.len() - ContentHash::BYTES);
    vec![bytes]
}

fn run_parcel(bytes: &[u8]) -> String {
    match Parcel::read(append_hash(bytes.to_vec())) {
        Ok(parcel) => {
            assert_eq!([parcel.sculpture(), parcel.trace()].concat(), bytes);
            "a parcel".into()
        }
        Err(ParcelFault::Head(ProtocolError::Json(why))) => format!("{:?}", why.classify()),
        // Places and lengths differ with each input.
        Err(ParcelFault::Length { part, .. }) => part.into(),
        Err(ParcelFault::HeadLength { .. }) => "a long head".into(),
        Err(fault) => fault.to_string(),
    }
}
