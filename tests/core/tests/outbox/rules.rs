//! Each rule of the table and of the queue.

use paros_core::badge::BadgeNumber;
use paros_core::limits::{
    MAX_CHUNK_BYTES, MAX_UPLOAD_WAIT_MS, REFUSED_RETRY_MS, UPLOAD_TIMEOUT_MS, UPLOAD_WAIT_MS,
};
use paros_core::outbox::messages::{ReceiptOutcome, SiteId};
use paros_core::outbox::{EntryEvent, EntryState, OutboxRefusal, UploadAnswer};

use super::{BYTES, answer, empty, hash_of, id, keeping, receipt, state};

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
