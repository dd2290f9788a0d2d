//! The outbox: against its model, whatever happens in any order, and each of its rules by itself.

mod heartbeats;
mod journal;
mod model;
mod room;
mod rules;

use paros_core::outbox::messages::{
    ContentHash, HeatLevel, Receipt, ReceiptOutcome, SculptureId, SiteId,
};
use paros_core::outbox::{
    EntryState, HeadsetStatus, Outbox, OutboxOwner, OutboxSettings, UploadAnswer, UploadRequest,
};
use paros_core::visit::VisitPhase;

const OWNER: OutboxOwner = OutboxOwner { site: SiteId([7; 16]), headset: 17 };
const SETTINGS: OutboxSettings = OutboxSettings { grace_seconds: 3600, max_bytes: 1 << 20 };
const BOOT: u64 = 0xb007;
const BYTES: u32 = 11_000;

const STATUS: HeadsetStatus = HeadsetStatus {
    session_id: 5,
    is_charging: true,
    is_worn: true,
    is_glowing: false,
    battery_percent: Some(80),
    heat: HeatLevel::Normal,
    phase: VisitPhase::Sculpting,
    worn_seconds: 60,
    app_version: [1, 2, 3],
};

fn id(number: u8) -> SculptureId {
    SculptureId([number; 16])
}

fn hash_of(id: SculptureId) -> ContentHash {
    let mut hash = [0xaa; 32];
    hash[..16].copy_from_slice(&id.0);
    ContentHash(hash)
}

fn empty() -> Box<Outbox> {
    Box::new(Outbox::new(OWNER, SETTINGS, BOOT))
}

/// An outbox that keeps these, the journal written.
fn keeping(numbers: impl IntoIterator<Item = u8>) -> Box<Outbox> {
    let mut outbox = empty();
    for number in numbers {
        let id = id(number);
        outbox.announce(id, None).expect("room");
        outbox.keep(id, None, hash_of(id), BYTES).expect("announced");
    }
    outbox.note_journal_written();
    outbox.pass_time(0);
    outbox
}

fn state(outbox: &Outbox, number: u8) -> Option<EntryState> {
    outbox.find(id(number)).map(|entry| entry.state)
}

fn receipt(id: SculptureId, outcome: ReceiptOutcome) -> Receipt {
    let OutboxOwner { site, headset } = OWNER;
    Receipt { site, headset, id, hash: hash_of(id), badge: None, outcome }
}

/// Answers a request, without luck in the waits: they are as short as they may be.
fn answer(outbox: &mut Outbox, request: &UploadRequest, answer: UploadAnswer) {
    outbox.take_upload_answer(request.number, answer, 0).expect("an answer to this request");
}
