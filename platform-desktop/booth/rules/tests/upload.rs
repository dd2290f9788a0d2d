//! What is taken, kept and signed for.

mod common;

use common::*;
use paros_booth_rules::limits::{MAX_CHUNK_BYTES, MAX_OPEN_PARCELS};
use paros_booth_rules::records::{BadgeClaim, ExportState};
use paros_booth_rules::{Chunk, FoundByBadge, ParcelFiles as _, ParcelName, ParcelProgress};
use paros_core::badge::BadgeNumber;
use paros_core::limits::MAX_PARCEL_BYTES;
use paros_core::outbox::messages::*;

#[test]
fn a_parcel_is_signed_for_once_it_is_kept() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(device.headset, 40, leased(9));
    let receipt = rig.upload(&device, &parcel, START).expect("a sculpture");
    let expected = Receipt {
        site: SITE,
        headset: device.headset,
        id: parcel.id,
        hash: parcel.hash,
        badge: leased(9),
        outcome: ReceiptOutcome::Kept,
    };
    assert_eq!(receipt, expected);
    let kept = rig.booth.find_sculpture(&parcel.id, START).expect("it is kept");
    assert_eq!((kept.facts.as_slice(), kept.hash), (&parcel.facts.to_bytes()[..], parcel.hash.0));
    assert_eq!(kept.export, ExportState::Queued, "the receipt doesn't wait for the mesh");
    assert_eq!(rig.booth.read_kept(&kept).expect("its file"), parcel.bytes);
    // Asked again, in any way: the same.
    assert_eq!(rig.upload(&device, &parcel, seconds(9)).unwrap(), receipt);
    let question = parcel.chunk(0, &[]);
    assert_eq!(rig.booth.take_chunk(&device, &question).unwrap(), ParcelProgress::Done(receipt));
    assert_eq!(rig.booth.list_newest(9, START).unwrap().len(), 1);
    assert_eq!(rig.files.parcel_names(), []);
}

#[test]
fn a_parcel_goes_on_where_it_was_cut() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(device.headset, 40, None);
    let take = |offset: usize, end: usize| {
        let chunk = parcel.chunk(offset as u64, &parcel.bytes[offset..end]);
        rig.booth.take_chunk(&device, &chunk).expect("a piece")
    };
    assert_eq!(take(0, 1000), ParcelProgress::Held(1000));
    // Doubled, overlapping, ahead: passed over.
    assert_eq!(take(0, 1000), ParcelProgress::Held(1000));
    assert_eq!(take(500, 1500), ParcelProgress::Held(1000));
    assert_eq!(take(2000, 3000), ParcelProgress::Held(1000));
    assert_eq!(take(1000, parcel.bytes.len()), ParcelProgress::Whole);
    // Its last answer was lost.
    assert_eq!(take(0, 1000), ParcelProgress::Whole);
    let finish = || {
        rig.booth.finish_parcel(&device, (parcel.id, parcel.hash), &decode, START).expect("kept")
    };
    assert_eq!(finish(), finish());
}

#[test]
fn another_parcel_of_a_known_sculpture_is_a_conflict() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(device.headset, 40, leased(9));
    rig.upload(&device, &parcel, START).unwrap();
    let other = Parcel::of_facts(UploadFacts { finished_at: 2, ..parcel.facts });
    assert_eq!(status(rig.upload(&device, &other, START)), 409);
    rig.booth.delete(&parcel.id, "ana", START).unwrap();
    assert_eq!(status(rig.upload(&device, &other, START)), 409);
}

#[test]
fn a_headset_is_refused_what_is_anothers() {
    let rig = Rig::new();
    let (mine, others) = (rig.enrol(1), rig.enrol(2));
    let parcel = Parcel::new(mine.headset, 40, leased(9));
    // A parcel that says it is another's.
    assert_eq!(status(rig.upload(&others, &parcel, START)), 422);
    rig.upload(&mine, &parcel, START).expect("nothing stands in its way");
    assert_eq!(status(rig.upload(&others, &parcel, START)), 409);
    let same_id = Parcel::new(others.headset, 40, leased(9));
    assert_eq!(status(rig.upload(&others, &same_id, START)), 409);
    rig.booth.delete(&parcel.id, "ana", START).unwrap();
    assert_eq!(status(rig.upload(&others, &same_id, START)), 409);
    assert_eq!(rig.upload(&mine, &parcel, START).unwrap().outcome, ReceiptOutcome::Deleted);
}

#[test]
fn what_is_no_sculpture_is_refused_and_forgotten() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let good = Parcel::new(device.headset, 40, None);
    let mut wrong_bytes = Parcel::new(device.headset, 40, None);
    *wrong_bytes.bytes.last_mut().unwrap() ^= 1;
    wrong_bytes.hash = paros_booth_rules::hash_of(&wrong_bytes.bytes);
    let mut other_id = Parcel::new(device.headset, 42, None);
    other_id.id = SculptureId([43; 16]);
    let mut short = Parcel::new(device.headset, 44, None);
    short.bytes.pop();
    short.hash = paros_booth_rules::hash_of(&short.bytes);
    let mut no_head = Parcel::new(device.headset, 45, None);
    no_head.bytes[0] = 9;
    no_head.hash = paros_booth_rules::hash_of(&no_head.bytes);
    for parcel in [wrong_bytes, other_id, short, no_head] {
        assert_eq!(status(rig.upload(&device, &parcel, START)), 422);
        let (headset, id, hash) = (device.headset, parcel.id, parcel.hash);
        assert_eq!(rig.files.held_bytes(&ParcelName { headset, id, hash }).unwrap(), 0);
    }
    assert_eq!(rig.files.kept_names(), []);
    assert_eq!(rig.booth.list_newest(9, START).unwrap(), []);
    rig.upload(&device, &good, START).expect("the id isn't spent");
}

#[test]
fn too_much_is_refused() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(device.headset, 40, None);
    let take = |chunk: Chunk<'_>| rig.booth.take_chunk(&device, &chunk);
    let claimed = Chunk { parcel_bytes: 10 << 30, ..parcel.chunk(0, b"x") };
    assert_eq!(status(take(claimed)), 413);
    assert_eq!(status(take(Chunk { parcel_bytes: MAX_PARCEL_BYTES + 1, ..claimed })), 413);
    let long = vec![0; MAX_CHUNK_BYTES + 1];
    assert_eq!(status(take(Chunk { parcel_bytes: 1 << 20, ..parcel.chunk(0, &long) })), 413);
    assert_eq!(status(take(Chunk { offset: u64::MAX, ..parcel.chunk(0, b"x") })), 400);
    assert_eq!(status(take(Chunk { parcel_bytes: 3, ..parcel.chunk(0, b"xxx") })), 400);
    let longer = [&parcel.bytes[..], b"x"].concat();
    assert_eq!(status(take(parcel.chunk(0, &longer))), 400);
}

#[test]
fn a_headset_has_so_many_parcels_under_way_and_others_have_theirs() {
    let rig = Rig::new();
    let (device, other) = (rig.enrol(1), rig.enrol(2));
    let others = Parcel::new(other.headset, 99, None);
    rig.booth.take_chunk(&other, &others.chunk(0, &others.bytes[..9])).unwrap();
    let parcel = |id| Parcel::new(device.headset, id, None);
    for id in 1..=MAX_OPEN_PARCELS as u8 + 1 {
        let parcel = parcel(id);
        rig.booth.take_chunk(&device, &parcel.chunk(0, &parcel.bytes[..9])).expect("room");
        // The first one goes on while others begin.
        if id == 2 {
            let first = self::Parcel::new(device.headset, 1, None);
            rig.booth.take_chunk(&device, &first.chunk(9, &first.bytes[9..20])).expect("room");
        }
    }
    let held = |id| match rig.booth.take_chunk(&device, &parcel(id).chunk(0, &[])).unwrap() {
        ParcelProgress::Held(held) => held,
        other => panic!("{other:?}"),
    };
    assert_eq!([held(1), held(2), held(3)], [20, 0, 9], "the one that stood still begins anew");
    assert_eq!(rig.files.parcel_names().len(), MAX_OPEN_PARCELS + 1);
    rig.upload(&device, &parcel(2), START).expect("it comes again");
}

/// Bytes that turned into others on the booth's disk are asked for again, not refused.
#[test]
fn a_parcel_that_was_spoilt_here_comes_again() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let mut short = Parcel::new(device.headset, 41, None);
    let right = std::mem::replace(&mut short.bytes[300], 77);
    rig.booth.take_chunk(&device, &short.chunk(0, &short.bytes)).unwrap();
    let name = (short.id, short.hash);
    let done = rig.booth.finish_parcel(&device, name, &decode, START).unwrap();
    assert_eq!(done, ParcelProgress::Held(0), "it may be what was sent, and may not");
    short.bytes[300] = right;
    rig.upload(&device, &short, START).expect("the same again");
    let facts = Parcel::new(device.headset, 40, None).facts;
    let length = 2 * MAX_CHUNK_BYTES as u32;
    let long = UploadFacts { volume_bytes: length, volume_raw_bytes: length, ..facts };
    let mut parcel = Parcel::of_facts(long);
    let (right, hash) = (parcel.bytes.clone(), parcel.hash);
    parcel.bytes[300_000] ^= 1;
    for (k, bytes) in parcel.bytes.chunks(MAX_CHUNK_BYTES).enumerate() {
        let chunk = parcel.chunk((k * MAX_CHUNK_BYTES) as u64, bytes);
        rig.booth.take_chunk(&device, &chunk).unwrap();
    }
    let done = rig.booth.finish_parcel(&device, (parcel.id, hash), &decode, START).unwrap();
    assert_eq!(done, ParcelProgress::Held(0));
    parcel.bytes = right;
    rig.upload_in(&device, &parcel, MAX_CHUNK_BYTES, START).expect("the same again");
}

#[test]
fn a_leased_badge_names_one_sculpture_and_a_provisional_one_any() {
    let rig = Rig::new();
    let first = rig.enrol(1);
    let claim = |device: &_, parcel: &Parcel, now| {
        rig.upload(device, parcel, now).expect("it is kept all the same");
        rig.booth.find_sculpture(&parcel.id, now).expect("it is kept").claim
    };
    let number = rig.lease(&first, 11)[0];
    let sole = Parcel::new(first.headset, 1, number);
    assert_eq!(claim(&first, &sole, START), BadgeClaim::Sole);
    let twice = Parcel::new(first.headset, 2, number);
    assert_eq!(claim(&first, &twice, START), BadgeClaim::Disputed);
    let provisional = Some(BadgeNumber::provisional(5));
    for id in [3, 4] {
        let parcel = Parcel::new(first.headset, id, provisional);
        assert_eq!(claim(&first, &parcel, START), BadgeClaim::Shared);
    }
    // Past its last day a sculpture stands in nobody's way, swept or not.
    let later = Parcel::new(first.headset, 5, number);
    assert_eq!(claim(&first, &later, days(31)), BadgeClaim::Sole);
}

/// A headset that is enrolled and lies: it says a badge first that another one was handed.
#[test]
fn a_badge_that_a_headset_was_never_handed_is_in_doubt_and_in_nobodys_way() {
    let rig = Rig::new();
    let (honest, liar) = (rig.enrol(1), rig.enrol(2));
    let number = rig.lease(&honest, 11)[3];
    let theirs = rig.lease(&liar, 12)[3];
    assert_ne!(number, theirs);
    let claim = |device: &_, parcel: &Parcel, now| {
        rig.upload(device, parcel, now).expect("it is kept all the same");
        rig.booth.find_sculpture(&parcel.id, now).expect("it is kept").claim
    };
    let stolen = Parcel::new(liar.headset, 1, number);
    assert_eq!(claim(&liar, &stolen, START), BadgeClaim::Unleased);
    let owned = Parcel::new(honest.headset, 2, number);
    assert_eq!(claim(&honest, &owned, seconds(1)), BadgeClaim::Sole);
    let nobodys = leased(6_000);
    assert_eq!(claim(&liar, &Parcel::new(liar.headset, 3, nobodys), START), BadgeClaim::Unleased);
    assert_eq!(claim(&liar, &Parcel::new(liar.headset, 4, theirs), START), BadgeClaim::Sole);
    // Who says the badge finds the visitor's sculpture first.
    let badge = number.expect("a number").badge();
    let FoundByBadge::Exact(found) = rig.booth.find_by_badge(&badge.into(), seconds(2)).unwrap()
    else {
        panic!("a right badge")
    };
    let ids: Vec<u8> = found.kept.iter().map(|kept| kept.id[0]).collect();
    assert_eq!(ids, [2, 1]);
    // The ledger hears nothing of what was never handed out: a liar spends no numbers.
    let free = rig.ledger().totals().free;
    rig.lease(&honest, 11);
    assert_eq!(rig.ledger().totals().free, free);
    assert!(nobodys.is_some_and(|number| rig.ledger().is_free(number)));
}
