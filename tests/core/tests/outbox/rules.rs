//! Each rule of the table and of the queue.

use paros_core::badge::BadgeNumber;
use paros_core::limits::{
    MAX_CHUNK_BYTES, MAX_OUTBOX_ENTRIES, MAX_UPLOAD_WAIT_MS, REFUSED_RETRY_MS, UPLOAD_TIMEOUT_MS,
    UPLOAD_WAIT_MS,
};
use paros_core::outbox::messages::{
    AnnouncementState, HeartbeatAnswer, ReceiptOutcome, SculptureId, SiteId, UploadFacts,
};
use paros_core::outbox::{
    EntryEvent, EntryState, OutboxLevel, OutboxRefusal, OutboxSettings, UploadAnswer,
};

use super::{BYTES, SETTINGS, answer, empty, hash_of, id, keeping, receipt, state};

const KEPT: ReceiptOutcome = ReceiptOutcome::Kept;

#[test]
fn nothing_becomes_deletable_that_the_booth_has_not_signed_for() {
    let states = [
        EntryState::Announced,
        EntryState::Kept,
        EntryState::Sending { held: 9 },
        EntryState::Refused,
        EntryState::Lost,
    ];
    let grace = 0;
    let events = [
        EntryEvent::ParcelKept,
        EntryEvent::ParcelMissing,
        EntryEvent::PartSent,
        EntryEvent::PartHeld { held: u32::MAX },
        EntryEvent::RefusedByBooth,
        EntryEvent::SiteChanged,
        EntryEvent::Forgotten,
        EntryEvent::RoomNeeded,
        EntryEvent::SecondsPassed { seconds: u32::MAX, grace },
        EntryEvent::ParcelDeleted,
    ];
    for state in states {
        for event in events {
            let next = state.next(event);
            let is_owed = next.is_none_or(EntryState::is_owed);
            assert!(is_owed, "{state:?} by {event:?} becomes {next:?}");
        }
    }
}

#[test]
fn a_sculpture_is_announced_kept_sent_signed_for_and_deleted_after_the_grace() {
    let mut outbox = empty();
    assert!(outbox.was_wiped() && outbox.is_journal_due());
    outbox.announce(id(1), None).expect("room");
    let badge = BadgeNumber::new(77);
    outbox.note_badge(id(1), badge.expect("a number")).expect("announced");
    assert_eq!((outbox.begin_upload(0), outbox.depth()), (None, 1));
    outbox.keep(id(1), badge, hash_of(id(1)), BYTES).expect("announced");
    assert_eq!(outbox.note_badge(id(1), badge.expect("a number")), Err(OutboxRefusal::WrongState));
    outbox.note_journal_written();
    let request = outbox.begin_upload(0).expect("a parcel");
    assert_eq!((request.id, request.offset, request.len), (id(1), 0, BYTES));
    assert_eq!(outbox.begin_upload(0), None, "one at a time");
    assert!(!outbox.is_journal_due(), "what is on its way isn't saved");
    let mut signed = receipt(id(1), KEPT);
    signed.badge = badge;
    answer(&mut outbox, &request, UploadAnswer::Receipt(signed));
    assert_eq!(
        (state(&outbox, 1), outbox.depth()),
        (Some(EntryState::Receipted { seconds: 0 }), 0)
    );
    assert!(outbox.is_journal_due());
    outbox.note_journal_written();
    outbox.pass_time(0);
    outbox.pass_time(3_600_000);
    assert_eq!(state(&outbox, 1), Some(EntryState::Receipted { seconds: 3600 }));
    assert_eq!(outbox.parcels_to_delete().next(), None);
    outbox.pass_time(3_601_000);
    assert!(outbox.is_journal_due());
    assert_eq!(
        outbox.parcels_to_delete().next(),
        Some(id(1)),
        "the journal says it was signed for"
    );
    outbox.note_deleted(id(1)).expect("deletable");
    assert_eq!((outbox.entries(), outbox.bytes_here()), (&[][..], 0));
}

#[test]
fn the_newest_goes_first_and_what_fails_last() {
    let mut outbox = keeping(1..=3);
    let first = outbox.begin_upload(0).expect("a parcel");
    assert_eq!(first.id, id(3));
    answer(&mut outbox, &first, UploadAnswer::Failed);
    assert!(outbox.is_waiting_for_booth());
    outbox.pass_time(UPLOAD_WAIT_MS);
    let second = outbox.begin_upload(0).expect("another");
    assert_eq!(second.id, id(2));
    answer(&mut outbox, &second, UploadAnswer::Receipt(receipt(id(2), KEPT)));
    assert!(!outbox.is_waiting_for_booth());
    let third = outbox.begin_upload(0).expect("at once");
    assert_eq!(third.id, id(1));
    answer(&mut outbox, &third, UploadAnswer::Receipt(receipt(id(1), KEPT)));
    assert_eq!(outbox.begin_upload(0).expect("the one that failed").id, id(3));
}

#[test]
fn waits_double_are_spread_and_end() {
    for (random, least, most) in [(0, 1, 2), (u32::MAX, 1, 2)] {
        let mut outbox = keeping([1]);
        let mut now = 0;
        for failure in 0..9 {
            let full = (UPLOAD_WAIT_MS << failure).min(MAX_UPLOAD_WAIT_MS);
            let request = outbox.begin_upload(random).expect("it is time");
            outbox.take_upload_answer(request.number, UploadAnswer::Failed, random).expect("taken");
            let (early, late) = (full * least / 2 - 1, full * most / 2);
            outbox.pass_time(now + early);
            assert_eq!(outbox.begin_upload(random), None, "after {failure} failures");
            now += late;
            outbox.pass_time(now);
        }
    }
    // Between the two: not all come back at one moment.
    let waits = |random| {
        let mut outbox = keeping([1]);
        let request = outbox.begin_upload(0).expect("it is time");
        outbox.take_upload_answer(request.number, UploadAnswer::Failed, random).expect("taken");
        (0..).find(|&ms| {
            outbox.pass_time(ms);
            outbox.begin_upload(0).is_some()
        })
    };
    assert_ne!(waits(17), waits(400));
}

#[test]
fn a_booth_that_is_busy_is_left_alone_as_long_as_it_asks_but_not_for_ever() {
    for (asked, waited) in [(100, 100), (u32::MAX, 600)] {
        let mut outbox = keeping([1]);
        let request = outbox.begin_upload(0).expect("a parcel");
        answer(&mut outbox, &request, UploadAnswer::Failed);
        outbox.pass_time(MAX_UPLOAD_WAIT_MS);
        let request = outbox.begin_upload(0).expect("again");
        answer(&mut outbox, &request, UploadAnswer::Busy { retry_after_seconds: asked });
        assert!(!outbox.is_waiting_for_booth(), "it answers");
        outbox.pass_time(MAX_UPLOAD_WAIT_MS + waited * 1000 - 1);
        assert_eq!(outbox.begin_upload(0), None);
        outbox.pass_time(MAX_UPLOAD_WAIT_MS + waited * 1000 + UPLOAD_WAIT_MS);
        assert!(outbox.begin_upload(0).is_some());
    }
}

#[test]
fn a_parcel_goes_in_parts_from_where_the_booth_says() {
    let mut outbox = keeping([]);
    let bytes = 2 * MAX_CHUNK_BYTES + 100;
    outbox.keep(id(1), None, hash_of(id(1)), bytes).expect("room");
    let mut offsets = Vec::new();
    for held in [u64::from(MAX_CHUNK_BYTES), 5, 2 * u64::from(MAX_CHUNK_BYTES), u64::from(bytes)] {
        let request = outbox.begin_upload(0).expect("a part");
        offsets.push((request.offset, request.len));
        answer(&mut outbox, &request, UploadAnswer::Held { bytes: held });
        // It went back: that counts as a failure.
        assert_eq!(outbox.is_waiting_for_booth(), held == 5);
        if held == 5 {
            outbox.pass_time(UPLOAD_WAIT_MS);
        }
    }
    let last = outbox.begin_upload(0).expect("what brings the receipt");
    offsets.push((last.offset, last.len));
    let (chunk, rest) = (MAX_CHUNK_BYTES, 100);
    assert_eq!(offsets, [(0, chunk), (chunk, chunk), (5, chunk), (2 * chunk, rest), (bytes, 0)]);
    // More than there is is no answer.
    answer(&mut outbox, &last, UploadAnswer::Held { bytes: u64::from(bytes) + 1 });
    assert!(outbox.is_waiting_for_booth());
    assert_eq!(state(&outbox, 1), Some(EntryState::Sending { held: bytes }));
}

#[test]
fn an_answer_that_is_late_counts_for_nothing_but_a_receipt_always_does() {
    let mut outbox = keeping([1, 2]);
    let late = outbox.begin_upload(0).expect("a parcel");
    outbox.pass_time(UPLOAD_TIMEOUT_MS);
    assert_eq!(outbox.begin_upload(0), None, "it failed just now");
    answer(&mut outbox, &late, UploadAnswer::Refused);
    assert_eq!(state(&outbox, 2), Some(EntryState::Sending { held: 0 }));
    answer(&mut outbox, &late, UploadAnswer::Receipt(receipt(id(2), KEPT)));
    assert_eq!(state(&outbox, 2), Some(EntryState::Receipted { seconds: 0 }));
    let again = outbox.take_upload_answer(9, UploadAnswer::Receipt(receipt(id(2), KEPT)), 0);
    assert_eq!(again, Err(OutboxRefusal::WrongState));
}

#[test]
fn receipts_of_other_sites_headsets_parcels_and_badges_are_refused() {
    let mut outbox = keeping([1]);
    let right = receipt(id(1), KEPT);
    let mut wrong = [right; 4];
    wrong[0].site = SiteId([8; 16]);
    wrong[1].headset += 1;
    wrong[2].hash = hash_of(id(2));
    wrong[3].badge = BadgeNumber::new(1);
    for receipt in wrong {
        let before = outbox.clone();
        assert_eq!(outbox.take_receipt(&receipt), Err(OutboxRefusal::WrongReceipt));
        assert_eq!(outbox, before);
    }
    assert_eq!(outbox.take_receipt(&receipt(id(2), KEPT)), Err(OutboxRefusal::UnknownId));
    let request = outbox.begin_upload(0).expect("a parcel");
    let refused = outbox.take_upload_answer(request.number, UploadAnswer::Receipt(wrong[2]), 0);
    assert_eq!(refused, Err(OutboxRefusal::WrongReceipt));
    assert!(outbox.is_waiting_for_booth(), "the request came to nothing");
    assert_eq!(outbox.take_receipt(&right), Ok(()));
}

#[test]
fn what_the_booth_deleted_is_deleted_here_without_a_grace() {
    let mut outbox = keeping([1]);
    outbox.take_receipt(&receipt(id(1), ReceiptOutcome::Deleted)).expect("its own");
    assert_eq!((state(&outbox, 1), outbox.depth()), (Some(EntryState::Deletable), 0));
    outbox.note_journal_written();
    assert_eq!(outbox.parcels_to_delete().next(), Some(id(1)));
}

#[test]
fn what_the_booth_refuses_stays_and_is_tried_again_rarely() {
    let mut outbox = keeping([1, 2]);
    let request = outbox.begin_upload(0).expect("a parcel");
    answer(&mut outbox, &request, UploadAnswer::Refused);
    assert_eq!(state(&outbox, 2), Some(EntryState::Refused));
    assert!(!outbox.is_waiting_for_booth(), "the booth is there");
    let other = outbox.begin_upload(0).expect("the other, at once");
    assert_eq!(other.id, id(1));
    answer(&mut outbox, &other, UploadAnswer::Receipt(receipt(id(1), KEPT)));
    outbox.pass_time(REFUSED_RETRY_MS / 2 - 1);
    assert_eq!((outbox.begin_upload(0), outbox.depth()), (None, 1));
    outbox.pass_time(REFUSED_RETRY_MS / 2);
    assert_eq!(outbox.begin_upload(0).expect("once more").id, id(2));
}

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

#[test]
fn an_id_that_is_anothers_is_given_up_once_and_for_all() {
    let mut outbox = keeping([1, 2]);
    let request = outbox.begin_upload(0).expect("a parcel");
    outbox.renew(id(2), id(3), hash_of(id(3))).expect("it waits");
    answer(&mut outbox, &request, UploadAnswer::Failed);
    assert_eq!((state(&outbox, 2), state(&outbox, 3)), (None, Some(EntryState::Kept)));
    assert_eq!(outbox.find(id(3)).and_then(|entry| entry.replaced), Some(id(2)));
    let mut given_up = outbox.clone();
    assert_eq!(given_up.keep(id(2), None, hash_of(id(2)), BYTES), Err(OutboxRefusal::KnownId));
    assert_eq!(given_up.renew(id(1), id(1), hash_of(id(1))), Err(OutboxRefusal::KnownId));
    // A parcel that is back though its sculpture went on, twice since.
    given_up.renew(id(1), id(2), hash_of(id(2))).expect("it goes on as 3 already");
    assert_eq!(given_up.entries().iter().map(|entry| entry.id).collect::<Vec<_>>(), [id(3)]);
    // A start in between: both are there, and become one.
    let mut both = keeping([2, 3]);
    both.renew(id(2), id(3), hash_of(id(3))).expect("it waits");
    assert_eq!((both.entries().len(), state(&both, 3)), (1, Some(EntryState::Kept)));
    // Not where it is signed for.
    both.take_receipt(&receipt(id(3), KEPT)).expect("its own");
    assert_eq!(both.renew(id(3), id(4), hash_of(id(4))), Err(OutboxRefusal::WrongState));
}

#[test]
fn a_clock_that_is_set_back_stands_still() {
    let mut outbox = keeping([1]);
    outbox.take_receipt(&receipt(id(1), KEPT)).expect("its own");
    for now in [1000, 5000, 4000, 5000, 0, 500, 999, 1000] {
        outbox.pass_time(now);
    }
    // 5 s, 1 s, 1 s.
    assert_eq!(state(&outbox, 1), Some(EntryState::Receipted { seconds: 7 }));
    outbox.pass_time(u64::MAX);
    assert_eq!(state(&outbox, 1), Some(EntryState::Deletable));
    outbox.pass_time(0);
    assert!(outbox.begin_upload(0).is_none());
}
