//! Tests that folders and buckets store files in the same way.

use std::io::ErrorKind;
use std::path::Path;

use paros_booth::{DiskFiles, Files, S3Files};
use paros_booth_rules::{BoothTime, KeptName, KeptPart, ParcelFiles};
use paros_protocol::{ContentHash, SculptureId};

use crate::rules::common::MemoryFiles;
use crate::s3_server::S3Server;

fn name_of(number: u8, part: KeptPart) -> KeptName {
    KeptName { id: SculptureId([number; 16]), hash: ContentHash::of(&[number]), part }
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

/// Checks what all file stores have to do. `one` and `other` may be the same store, or one store in two
/// processes.
fn check_files(one: &dyn ParcelFiles, other: &dyn ParcelFiles) {
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

/// Checks that the used bytes are counted, and the quota is enforced.
fn check_quota(files: &dyn Files, other: &dyn Files) {
    let name = name_of(1, KeptPart::Sculpture);
    files.keep(&name, &noise(400)).unwrap();
    files.keep(&name, &noise(500)).unwrap();
    assert_eq!(files.used_bytes(), 500);
    other.forget_deletions_before(BoothTime(0)).unwrap();
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
    check_quota(&files, &files);
}

#[test]
fn a_bucket_has_files_that_several_share() {
    let server = S3Server::start("bucket-files");
    check_files(&open_bucket(&server, "site", u64::MAX), &open_bucket(&server, "site/", u64::MAX));
    let objects = std::fs::read_dir(server.folder("site/sculptures")).expect("a folder");
    assert_eq!(objects.count(), 2, "a file is an object");
    let quota = |prefix| open_bucket(&server, prefix, 1000);
    check_quota(&quota("other"), &quota("other"));
    // Without a prefix; and used bytes are counted when a store is opened.
    let bare = open_bucket(&server, "", u64::MAX);
    check_files(&bare, &bare);
    assert_eq!(open_bucket(&server, "other", u64::MAX).used_bytes(), 400);
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
