//! Folders and buckets keep parcels and files alike.

use std::io::ErrorKind;
use std::path::Path;
use std::time::{Duration, SystemTime};

use paros_booth::{DiskFiles, Files, S3Files};
use paros_booth_rules::limits::{MAX_CHUNK_BYTES, MAX_OPEN_PARCELS};
use paros_booth_rules::{
    BoothTime, KeptName, KeptPart, MemoryFiles, ParcelFiles, ParcelName, hash_of,
};
use paros_core::outbox::messages::SculptureId;

use crate::s3_server::S3Server;

fn parcel_of(headset: u32, number: u8) -> ParcelName {
    ParcelName { headset, id: SculptureId([number; 16]), hash: hash_of(&[number]) }
}

fn noise(length: usize) -> Vec<u8> {
    (0..length as u32).map(|k| (k.wrapping_mul(2_654_435_761) >> 24) as u8).collect()
}

fn open_disk(name: &str, quota: u64) -> DiskFiles {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).expect("room on the disk");
    DiskFiles::open(&folder, quota).expect("a folder")
}

fn open_bucket(server: &S3Server, prefix: &str, quota: u64) -> S3Files {
    S3Files::open(&format!("s3://booth/{prefix}"), server.settings(), quota).expect("a bucket")
}

/// What all files have to do, whether one process has them or several.
fn check_files(one: &dyn ParcelFiles, other: &dyn ParcelFiles) {
    grows_at_its_end(one, other);
    takes_any_pieces(one);
    makes_room(one);
    keeps_files(one, other);
}

fn grows_at_its_end(one: &dyn ParcelFiles, other: &dyn ParcelFiles) {
    let (parcel, bytes) = (parcel_of(1, 1), noise(3 * MAX_CHUNK_BYTES + 99));
    assert_eq!(one.held_bytes(&parcel).unwrap(), 0);
    assert_eq!(one.read_parcel(&parcel).unwrap_err().kind(), ErrorKind::NotFound);
    assert_eq!(one.append(&parcel, 5, b"ahead").unwrap(), 0, "it doesn't begin there");
    let mut held = 0;
    for (k, piece) in bytes.chunks(MAX_CHUNK_BYTES).enumerate() {
        let files = if k % 2 == 0 { one } else { other };
        held = files.append(&parcel, held, piece).unwrap();
        assert_eq!(held, (k * MAX_CHUNK_BYTES + piece.len()) as u64);
        // Doubled, and late.
        assert_eq!(other.append(&parcel, 0, piece).unwrap(), held);
        assert_eq!(one.held_bytes(&parcel).unwrap(), held);
    }
    assert!(other.read_parcel(&parcel).unwrap() == bytes);
    // Others have the same headset, sculpture or hash.
    for (headset, number) in [(2, 1), (1, 2)] {
        assert_eq!(one.held_bytes(&parcel_of(headset, number)).unwrap(), 0);
    }
    let same_id = ParcelName { hash: hash_of(b"another"), ..parcel };
    assert_eq!(one.held_bytes(&same_id).unwrap(), 0);
    other.drop_parcel(&parcel).unwrap();
    assert_eq!(one.held_bytes(&parcel).unwrap(), 0);
    one.drop_parcel(&parcel).expect("there is none");
}

fn takes_any_pieces(files: &dyn ParcelFiles) {
    let (parcel, bytes) = (parcel_of(1, 3), noise(2 * MAX_CHUNK_BYTES));
    let mut offset = 0;
    for length in [1, 2, 1000, MAX_CHUNK_BYTES, 1, MAX_CHUNK_BYTES / 2, 77] {
        let held = files.append(&parcel, offset as u64, &bytes[offset..][..length]).unwrap();
        offset += length;
        assert_eq!(held, offset as u64);
    }
    assert!(files.read_parcel(&parcel).unwrap() == bytes[..offset]);
    files.drop_parcel(&parcel).unwrap();
}

fn makes_room(files: &dyn ParcelFiles) {
    files.make_room(9, MAX_OPEN_PARCELS).expect("there is none");
    for number in 0..MAX_OPEN_PARCELS as u8 {
        files.append(&parcel_of(9, number), 0, &[number]).unwrap();
        // Their times are told apart.
        std::thread::sleep(Duration::from_millis(20));
    }
    files.append(&parcel_of(90, 0), 0, b"another's").unwrap();
    files.make_room(9, MAX_OPEN_PARCELS).unwrap();
    let held = |headset, number| files.held_bytes(&parcel_of(headset, number)).unwrap();
    assert_eq!((0..4).map(|number| held(9, number)).sum::<u64>(), 3);
    assert_eq!((held(9, 0), held(90, 0)), (0, 9), "the oldest goes, and of nobody else");
}

fn keeps_files(one: &dyn ParcelFiles, other: &dyn ParcelFiles) {
    let name_of = |number, part| {
        let ParcelName { id, hash, .. } = parcel_of(1, number);
        KeptName { id, hash, part }
    };
    for part in KeptPart::ALL {
        let bytes = noise(100_000 + part as usize);
        one.keep(&name_of(1, part), &bytes).unwrap();
        assert!(other.read_kept(&name_of(1, part)).unwrap() == bytes);
        one.keep(&name_of(1, part), b"anew").unwrap();
        assert_eq!(other.read_kept(&name_of(1, part)).unwrap(), b"anew");
        let none = other.read_kept(&name_of(2, part)).unwrap_err();
        assert_eq!(none.kind(), ErrorKind::NotFound);
    }
    other.remove_kept(&name_of(1, KeptPart::Trace)).unwrap();
    other.remove_kept(&name_of(1, KeptPart::Trace)).expect("there is none");
    assert!(one.read_kept(&name_of(1, KeptPart::Trace)).is_err());
    assert_eq!(one.read_kept(&name_of(1, KeptPart::Sculpture)).unwrap(), b"anew");
}

/// What is past its time goes, what is in use stays, and as much is counted as there is.
fn check_ages_and_quota(files: &dyn Files, other: &dyn Files) {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap();
    let at = |seconds: u64| BoothTime(now.as_millis() as u64 + 1000 * seconds);
    files.append(&parcel_of(1, 1), 0, b"begun").unwrap();
    files.drop_parcels_before(BoothTime(at(0).0 - 60_000)).unwrap();
    assert_eq!(files.held_bytes(&parcel_of(1, 1)).unwrap(), 5);
    files.drop_parcels_before(at(60)).unwrap();
    assert_eq!(files.held_bytes(&parcel_of(1, 1)).unwrap(), 0);
    let ParcelName { id, hash, .. } = parcel_of(1, 1);
    let name = KeptName { id, hash, part: KeptPart::Sculpture };
    files.keep(&name, &noise(400)).unwrap();
    files.keep(&name, &noise(500)).unwrap();
    assert_eq!(files.used_bytes(), 500);
    other.drop_parcels_before(at(0)).unwrap();
    let full = files.append(&parcel_of(1, 1), 0, &noise(600)).unwrap_err();
    assert_eq!(full.kind(), ErrorKind::StorageFull);
    let trace = KeptName { part: KeptPart::Trace, ..name };
    assert_eq!(other.keep(&trace, &noise(600)).unwrap_err().kind(), ErrorKind::StorageFull);
    files.remove_kept(&name).unwrap();
    assert_eq!(files.used_bytes(), 0);
    files.keep(&trace, &noise(400)).unwrap();
}

#[test]
fn files_in_memory_are_some() {
    let files = MemoryFiles::new();
    check_files(&files, &files);
}

#[test]
fn a_folder_has_files() {
    let files = open_disk("folder-files", u64::MAX);
    check_files(&files, &files);
    let files = open_disk("folder-quota", 1000);
    check_ages_and_quota(&files, &files);
}

#[test]
fn a_bucket_has_files_that_several_share() {
    let server = S3Server::start("bucket-files");
    check_files(&open_bucket(&server, "site", u64::MAX), &open_bucket(&server, "site/", u64::MAX));
    let quota = |prefix| open_bucket(&server, prefix, 1000);
    check_ages_and_quota(&quota("other"), &quota("other"));
    // Without a prefix, and counted when it is opened.
    let bare = open_bucket(&server, "", u64::MAX);
    check_files(&bare, &bare);
    assert_eq!(open_bucket(&server, "other", u64::MAX).used_bytes(), 400);
}

/// However small the pieces are in which a parcel comes, few objects are made of them.
#[test]
fn a_parcel_in_a_bucket_is_few_objects() {
    let server = S3Server::start("bucket-pieces");
    let files = open_bucket(&server, "site", u64::MAX);
    let (parcel, bytes) = (parcel_of(1, 1), noise(2 * MAX_CHUNK_BYTES));
    for (k, piece) in bytes.chunks(5000).enumerate() {
        files.append(&parcel, 5000 * k as u64, piece).unwrap();
    }
    assert!(files.read_parcel(&parcel).unwrap() == bytes);
    let folder = server.folder("site/parcels/1").join(format!("{}-{}", parcel.id, parcel.hash));
    let objects = std::fs::read_dir(folder).expect("its folder").count();
    assert!(objects <= 4, "{objects} objects");
}

#[test]
fn what_is_wrong_with_a_bucket_is_told() {
    let server = S3Server::start("bucket-errors");
    let open = |address: &str, settings: Vec<(String, String)>| {
        S3Files::open(address, settings, u64::MAX).err().expect("nothing to open").to_string()
    };
    for bad in ["", "booth/site", "s3:///site", "s3://boo th", "s3://booth/a?b", "s3://u:p@booth/a"]
    {
        let error = open(bad, server.settings());
        assert!(error.contains("expected"), "{error}");
    }
    assert!(!open("s3://nowhere/site", server.settings()).is_empty());
    let mut far = server.settings();
    far[0].1 = "http://s3.example".into();
    let error = open("s3://booth/site", far);
    assert!(error.contains("expected AWS_ENDPOINT_URL with https://"), "{error}");
    let mut wrong = server.settings();
    wrong[2].1 = "hunter2".into();
    let error = open("s3://booth/site", wrong);
    assert!(error.starts_with("s3://booth/site: "), "{error}");
    assert!(!error.contains("hunter2"), "{error}");
}
