//! What the outbox reads: the booth's messages, its journal, parcels. Refused at an offset within the bytes, or read as
//! what they are: written again they are the same.

use paros_core::codec::BadBytes;
use paros_core::internals::checksum;
use paros_core::outbox::messages::{
    AgeGroup, ContentHash, EnrolAnswer, FinishCause, FleetEnrolment, Heartbeat, HeartbeatAnswer,
    HeatLevel, Receipt, SculptureId, SiteId, UploadFacts,
};
use paros_core::outbox::{HeadsetStatus, Outbox, OutboxOwner, OutboxSettings};
use paros_core::session::SessionMode;
use paros_core::visit::VisitPhase;
use paros_shell::outbox::{Parcel, ParcelFault};

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

/// An input is a journal without its checksum.
pub(super) const JOURNAL: FuzzTarget = FuzzTarget {
    name: "journal",
    seeds: journal_seeds,
    words: &[b"PBOX", b"\x05", b"\0\0\0\0", b"\xff\xff\xff\xff", b"\0\x01"],
    longest: Outbox::JOURNAL_BYTES,
    runs: 3_000,
    run: run_journal,
};

/// An input is a parcel.
pub(super) const PARCEL: FuzzTarget = FuzzTarget {
    name: "parcel",
    seeds: parcel_seeds,
    words: &[b"\x01", b"\0\0\0\0", b"\xff\xff\xff\xff", b"el"],
    longest: 400,
    runs: 20_000,
    run: run_parcel,
};

const OWNER: OutboxOwner = OutboxOwner { site: SiteId([7; 16]), headset: 17 };
const SETTINGS: OutboxSettings = OutboxSettings { grace_seconds: 60, max_bytes: 1 << 20 };

const STATUS: HeadsetStatus = HeadsetStatus {
    session_id: 5,
    is_charging: true,
    is_worn: false,
    is_glowing: false,
    battery_percent: Some(50),
    heat: HeatLevel::Warm,
    phase: VisitPhase::Attract,
    worn_seconds: 0,
    app_version: [0, 1, 0],
};

const FACTS: UploadFacts = UploadFacts {
    id: SculptureId([1; 16]),
    headset: 17,
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

const MESSAGES: [ReadAgain; 6] = messages! {
    UploadFacts Receipt Heartbeat HeartbeatAnswer FleetEnrolment EnrolAnswer
};

fn outbox() -> Box<Outbox> {
    let mut outbox = Box::new(Outbox::new(OWNER, SETTINGS, 3));
    for number in 1..5 {
        let id = SculptureId([number; 16]);
        outbox.announce(id, None).expect("room");
        if number > 2 {
            outbox.keep(id, None, ContentHash([number; 32]), 500).expect("announced");
        }
    }
    outbox
}

fn message_seeds() -> Vec<Vec<u8>> {
    let heartbeat = outbox().begin_heartbeat(&STATUS, None, 0);
    let lengths = [Receipt::BYTES, HeartbeatAnswer::BYTES, FleetEnrolment::BYTES];
    let ones = lengths.iter().zip([1, 3, 4]).map(|(&len, kind)| {
        let mut seed = vec![1; 1 + len];
        seed[0] = kind;
        seed
    });
    let made = [[&[0][..], &FACTS.to_bytes()].concat(), [&[2][..], &heartbeat.to_bytes()].concat()];
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

fn save(outbox: &Outbox) -> Vec<u8> {
    let mut bytes = Box::new([0; Outbox::JOURNAL_BYTES]);
    outbox.save(&mut bytes);
    bytes.to_vec()
}

fn journal_seeds() -> Vec<Vec<u8>> {
    let mut bytes = save(&outbox());
    bytes.truncate(Outbox::JOURNAL_BYTES - 8);
    vec![bytes]
}

fn run_journal(bytes: &[u8]) -> String {
    let saved = [bytes, &checksum(bytes).to_le_bytes()].concat();
    let mut outbox = match Outbox::load(&saved, OWNER, SETTINGS, 9) {
        Ok(outbox) => Box::new(outbox),
        Err(bad) => {
            assert!(bad.offset <= saved.len());
            return bad.expected.into();
        }
    };
    if !outbox.is_journal_due() {
        let again = save(&outbox);
        // All but the headset's number, which is this one's now.
        assert_eq!(
            (&again[..22], &again[26..saved.len() - 8]),
            (&saved[..22], &saved[26..saved.len() - 8])
        );
    }
    outbox.note_journal_written();
    outbox.pass_time(0);
    outbox.pass_time(10_000_000);
    let heartbeat = outbox.begin_heartbeat(&STATUS, None, 7);
    assert_eq!(Heartbeat::from_bytes(&heartbeat.to_bytes()).as_ref(), Ok(&heartbeat));
    let is_sending = outbox.begin_upload(7).is_some();
    format!("{} owed, {is_sending}, {:?}", outbox.depth(), outbox.level())
}

fn parcel_seeds() -> Vec<Vec<u8>> {
    let packed = Parcel::pack(&FACTS, b"not quite a volume", Some(b"nor a trace"));
    vec![packed.expect("a parcel").bytes().to_vec()]
}

fn run_parcel(bytes: &[u8]) -> String {
    match Parcel::read(bytes.to_vec()) {
        Ok(parcel) => {
            assert_eq!(parcel.bytes(), bytes);
            let renewed = parcel.renew(parcel.facts().headset).expect("only its id is another");
            assert_eq!(renewed.bytes()[18..], bytes[18..]);
            assert_eq!(Parcel::read_file(parcel.to_file()).as_ref(), Ok(&parcel));
            "a parcel".into()
        }
        Err(ParcelFault::Head(bad)) => {
            assert!(bad.offset <= bytes.len());
            bad.expected.into()
        }
        Err(fault) => fault.to_string(),
    }
}
