//! The room of an outbox: what is refused, and what is let go.

use paros_core::limits::MAX_OUTBOX_ENTRIES;
use paros_core::outbox::messages::{
    AnnouncementState, HeartbeatAnswer, ReceiptOutcome, SculptureId, UploadFacts,
};
use paros_core::outbox::{EntryState, OutboxLevel, OutboxRefusal, OutboxSettings};

use super::{BYTES, SETTINGS, empty, hash_of, id, keeping, receipt, state};

const KEPT: ReceiptOutcome = ReceiptOutcome::Kept;

fn long_id(number: u16) -> SculptureId {
    let mut bytes = [1; 16];
    bytes[..2].copy_from_slice(&number.to_le_bytes());
    SculptureId(bytes)
}

#[test]
fn a_full_table_refuses_and_warns_before() {
    let mut outbox = empty();
    for number in 0..MAX_OUTBOX_ENTRIES as u16 {
        let level = outbox.level();
        let nearly = usize::from(number) * 100 / MAX_OUTBOX_ENTRIES >= 80;
        assert_eq!(level, if nearly { OutboxLevel::NearlyFull } else { OutboxLevel::Fine });
        outbox.announce(long_id(number), None).expect("room");
    }
    assert_eq!((outbox.level(), outbox.full_percent()), (OutboxLevel::Full, 100));
    let before = outbox.clone();
    assert_eq!(outbox.announce(id(9), None), Err(OutboxRefusal::Full));
    assert_eq!(outbox.keep(id(9), None, hash_of(id(9)), BYTES), Err(OutboxRefusal::Full));
    assert_eq!(outbox, before);
    // What the booth has signed for makes room.
    outbox.keep(long_id(0), None, hash_of(long_id(0)), BYTES).expect("announced");
    outbox.take_receipt(&receipt(long_id(0), ReceiptOutcome::Deleted)).expect("its own");
    outbox.note_journal_written();
    assert_eq!(outbox.parcels_to_delete().next(), Some(long_id(0)));
    outbox.note_deleted(long_id(0)).expect("deletable");
    assert_eq!(outbox.announce(id(9), None), Ok(()));
}

#[test]
fn bytes_are_bounded_too() {
    let outbox = keeping(1..=94);
    assert_eq!(outbox.bytes_here(), 94 * u64::from(BYTES));
    assert!(outbox.has_room_for(14_576) && !outbox.has_room_for(14_577));
    assert_eq!((outbox.full_percent(), outbox.level()), (98, OutboxLevel::NearlyFull));
    let nothing = OutboxSettings { max_bytes: 0, ..SETTINGS };
    let outbox = Box::new(paros_core::outbox::Outbox::new(super::OWNER, nothing, 1));
    assert_eq!(outbox.level(), OutboxLevel::Full);
}

/// What the journal on the disk doesn't call signed for may be needed at the next start; the rest makes room on a full
/// disk.
#[test]
fn what_is_deleted_is_signed_for_in_the_journal_on_the_disk() {
    let mut outbox = keeping(1..=3);
    outbox.take_receipt(&receipt(id(2), KEPT)).expect("its own");
    outbox.note_journal_written();
    outbox.take_receipt(&receipt(id(1), KEPT)).expect("its own");
    outbox.take_receipt(&receipt(id(3), ReceiptOutcome::Deleted)).expect("its own");
    outbox.pass_time(0);
    outbox.pass_time(3_601_000);
    assert_eq!(state(&outbox, 1), Some(EntryState::Deletable));
    let to_delete =
        |outbox: &paros_core::outbox::Outbox| outbox.parcels_to_delete().collect::<Vec<_>>();
    assert_eq!(to_delete(&outbox), [id(2)], "the journal that is there knows 2 alone");
    let mut started = super::journal::load(&super::journal::save(&outbox)).expect("a journal");
    assert_eq!(to_delete(&started), [id(1), id(2), id(3)]);
    started.note_deleted(id(2)).expect("deletable");
    assert_eq!(to_delete(&started), [id(1), id(3)]);
    outbox.note_journal_written();
    assert_eq!(to_delete(&outbox), [id(1), id(2), id(3)]);
}

/// A headset on its two hundredth visit of the days of grace takes in the next ones all the same.
#[test]
fn what_is_signed_for_makes_room_the_oldest_first() {
    let mut outbox = empty();
    for number in 0..2 * MAX_OUTBOX_ENTRIES as u16 {
        let id = long_id(number);
        outbox.announce(id, None).expect("room");
        outbox.keep(id, None, hash_of(id), 1).expect("announced");
        outbox.take_receipt(&receipt(id, KEPT)).expect("its own");
        outbox.pass_time(u64::from(number));
        outbox.note_journal_written();
        assert_eq!(outbox.level(), OutboxLevel::Fine, "nothing is owed");
        let oldest = outbox.parcels_to_delete().next();
        if let Some(oldest) = oldest {
            assert_eq!(oldest, outbox.entries()[0].id);
            outbox.note_deleted(oldest).expect("deletable");
        }
        // Not one before it is needed.
        let here = usize::from(number + 1).min(207);
        assert_eq!(outbox.entries().len(), here, "207 of 256 are 80 percent");
    }
}

#[test]
fn what_is_signed_for_makes_room_for_bytes_and_what_is_owed_never_does() {
    let mut outbox = keeping(1..=94);
    for number in [30, 20, 10] {
        outbox.take_receipt(&receipt(id(number), KEPT)).expect("its own");
    }
    outbox.pass_time(1);
    let deletable = |outbox: &paros_core::outbox::Outbox| {
        let entries = outbox.entries().iter();
        entries.filter(|entry| entry.state == EntryState::Deletable).count()
    };
    assert_eq!((outbox.depth(), deletable(&outbox)), (91, 3), "the others are 95 percent");
    let mut outbox = keeping(1..=80);
    (1..=80).for_each(|number| outbox.take_receipt(&receipt(id(number), KEPT)).expect("its own"));
    outbox.pass_time(1);
    outbox.note_journal_written();
    // 43 parcels of 11,000 bytes are 45 percent of a MiB.
    assert_eq!((deletable(&outbox), outbox.parcels_to_delete().next()), (37, Some(id(1))));
    assert_eq!(state(&outbox, 38), Some(EntryState::Receipted { seconds: 0 }));
}

/// A booth that came back from a copy may lack it: it is asked before the last parcel goes.
#[test]
fn what_makes_room_is_what_the_booth_said_it_has_in_this_start() {
    let mut outbox = empty();
    for number in 0..230 {
        let id = long_id(number);
        outbox.announce(id, None).expect("room");
        outbox.keep(id, None, hash_of(id), UploadFacts::BYTES as u32).expect("announced");
        outbox.take_receipt(&receipt(id, KEPT)).expect("its own");
    }
    let mut started = super::journal::load(&super::journal::save(&outbox)).expect("a journal");
    let count_here = |outbox: &paros_core::outbox::Outbox| {
        let entries = outbox.entries().iter();
        entries.filter(|entry| entry.state != EntryState::Deletable).count()
    };
    started.pass_time(0);
    assert_eq!(count_here(&started), 230, "89 percent, and none was asked for");
    for number in 230..250 {
        started.announce(long_id(number), None).expect("room");
    }
    started.pass_time(1);
    assert_eq!(count_here(&started), 245, "95 percent: what is owed comes first");
    assert_eq!(started.depth(), 20);
    let asked = started.begin_heartbeat(&super::STATUS, None, 0);
    started.pass_time(2);
    assert_eq!(count_here(&started), 245, "it is being asked");
    let first =
        asked.announcements.iter().find(|asked| asked.state == AnnouncementState::SignedFor);
    let answer = HeartbeatAnswer {
        site: super::OWNER.site,
        headset: super::OWNER.headset,
        boot_id: super::BOOT + 1,
        number: asked.number,
        booth_time: 0,
        lease: None,
        command: None,
        noted: first.copied().into_iter().collect(),
    };
    assert_eq!(started.take_heartbeat_answer(&answer, 0), Some(None));
    started.pass_time(3);
    assert_eq!(count_here(&started), 244, "the one that it has");
}
