//! Uploads of parcels.

use super::common::*;
use paros_booth_rules::ImportOutcome;
use paros_booth_rules::records::ExportState;
use paros_protocol::ContentHash;
use paros_protocol::limits::MAX_PARCEL_BYTES;

#[test]
fn a_parcel_is_kept_once_however_often_it_comes() {
    let rig = Rig::new();
    let (device, other) = (rig.enrol(1), rig.enrol(2));
    let parcel = Parcel::new(40, leased(9));
    assert_eq!(rig.upload(&device, &parcel, START).expect("a sculpture"), ParcelOutcome::Kept);
    let kept = rig.booth.find_sculpture(&parcel.id).expect("it is kept");
    assert_eq!((kept.facts.as_slice(), kept.hash), (&parcel.facts.to_json()[..], parcel.hash.0));
    assert_eq!(kept.export, ExportState::Queued, "the answer doesn't wait for the mesh");
    assert_eq!(rig.booth.read_kept(&kept).expect("its file"), parcel.bytes);
    // The answer was lost, or the device enrolled again and has another number.
    for sender in [&device, &other] {
        assert_eq!(rig.upload(sender, &parcel, seconds(9)).unwrap(), ParcelOutcome::Kept);
    }
    let newest = rig.list(false);
    assert_eq!((newest.len(), newest[0].headset), (1, device.headset));
    rig.booth.delete(&parcel.id, "ana", START).unwrap();
    for sender in [&device, &other] {
        assert_eq!(rig.upload(sender, &parcel, seconds(9)).unwrap(), ParcelOutcome::Deleted);
    }
}

#[test]
fn another_parcel_of_a_known_sculpture_is_a_conflict() {
    let rig = Rig::new();
    let (device, liar) = (rig.enrol(1), rig.enrol(2));
    let parcel = Parcel::new(40, leased(9));
    rig.upload(&device, &parcel, START).unwrap();
    let other = Parcel::of_facts(UploadFacts { finished_at: 2, ..parcel.facts });
    for sender in [&device, &liar] {
        assert_eq!(status(rig.upload(sender, &other, START)), 409);
    }
    rig.booth.delete(&parcel.id, "ana", START).unwrap();
    assert_eq!(status(rig.upload(&device, &other, START)), 409);
}

#[test]
fn no_sculpture_is_refused_and_nothing_of_it_stays() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let hashed = |mut parcel: Parcel| {
        parcel.hash = ContentHash::of(&parcel.bytes);
        parcel
    };
    let mut wrong_bytes = Parcel::new(40, None);
    *wrong_bytes.bytes.last_mut().unwrap() ^= 1;
    let mut other_id = Parcel::new(42, None);
    other_id.id = SculptureId([43; 16]);
    let mut short = Parcel::new(44, None);
    short.bytes.pop();
    let mut no_head = Parcel::new(45, None);
    no_head.bytes[5] = b'?';
    let mut stub = Parcel::new(46, None);
    stub.bytes.truncate(20);
    for parcel in [wrong_bytes, other_id, short, no_head, stub].map(hashed) {
        assert_eq!(status(rig.upload(&device, &parcel, START)), 422);
    }
    assert_eq!(rig.files.kept_names(), []);
    assert_eq!(rig.list(false), []);
    rig.upload(&device, &Parcel::new(40, None), START).expect("the id isn't spent");
}

/// Corrupted bytes are a bad request, so that the parcel is sent again; they aren't refused for good.
#[test]
fn a_parcel_with_another_hash_is_no_request() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let mut parcel = Parcel::new(40, None);
    parcel.bytes[300] ^= 1;
    assert_eq!(status(rig.upload(&device, &parcel, START)), 400);
    let take = |file: &[u8]| rig.booth.take_parcel(device.headset, parcel.id, file, &decode, START);
    assert_eq!(status(take(&[])), 400);
    assert_eq!(status(take(&vec![0; MAX_PARCEL_BYTES as usize + 33])), 413);
}

#[test]
fn what_staff_copied_from_a_headset_is_taken_as_if_that_had_sent_it() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(40, leased(9));
    let import = |headset: u32, parcel: &Parcel| {
        rig.booth.import_parcel(headset, (parcel.id, &parcel.file()), &decode, "ana", seconds(5))
    };
    assert_eq!(status(import(device.headset + 1, &parcel)), 404);
    rig.booth.revoke_device(device.headset, "ana", START).unwrap();
    assert_eq!(import(device.headset, &parcel).unwrap(), ImportOutcome::Taken);
    assert_eq!(rig.booth.list_audit(1).unwrap()[0].action, "import");
    assert_eq!(import(device.headset, &parcel).unwrap(), ImportOutcome::Known);
    let kept = rig.booth.find_sculpture(&parcel.id).expect("it is kept");
    assert_eq!((kept.headset, kept.hash), (device.headset, parcel.hash.0));
    let other = Parcel::of_facts(UploadFacts { finished_at: 2, ..parcel.facts });
    assert_eq!(status(import(device.headset, &other)), 409);
    rig.booth.delete(&parcel.id, "ana", START).unwrap();
    assert_eq!(import(device.headset, &parcel).unwrap(), ImportOutcome::Deleted);
    assert_eq!(
        rig.booth.list_audit(99).unwrap().iter().filter(|entry| entry.action == "import").count(),
        1
    );
}
