//! Starts with the leftovers of the previous start.

use std::fs;
use std::path::Path;

use paros_protocol::append_hash;

use super::*;

#[test]
fn damaged_parcels_are_set_aside_and_reported_lost() {
    let folder = Folder::new("damaged");
    let mut host = Host::default();
    let mut sender = send_all(&folder, &mut host, &[1]);
    (2..=4).for_each(|number| sender.keep(&parcel(number)).expect("room"));
    drop(sender);
    [name_of(1, "sent"), name_of(2, "parcel")].iter().for_each(|name| folder.spoil(name));
    fs::write(folder.0.join(".paros-12-3.part"), b"half").expect("room on the disk");
    let mut sender = folder.open();
    // A parcel that the booth has isn't missed.
    assert_eq!([1, 2].map(|number| status(&sender, number)), [None, Some(UploadStatus::Lost)]);
    // Also while the program runs.
    folder.spoil(&name_of(4, "parcel"));
    fs::remove_file(folder.0.join(name_of(3, "parcel"))).expect("it was kept");
    host.events.clear();
    for _ in 0..10 {
        host.now_ms += 60_000;
        sender.step(&mut host);
    }
    let lost = [2, 4, 3].map(|number| OutboxEvent::Lost(id_of(number)));
    assert_eq!(host.events, lost);
    assert_eq!(folder.names(), [2, 4].map(|number| name_of(number, "damaged")));
    // The loss is reported to the booth at each start, until staff have looked.
    drop(sender);
    let sender = folder.open();
    assert_eq!([2, 4].map(|number| status(&sender, number)), [Some(UploadStatus::Lost); 2]);
}

/// A power cut during a rename left both names, on a storage where that can happen.
#[test]
fn a_parcel_under_two_names_is_sent_again() {
    let folder = Folder::new("names");
    let mut host = Host::default();
    drop(send_all(&folder, &mut host, &[1]));
    fs::write(folder.0.join(name_of(1, "parcel")), parcel(1).file_bytes()).expect("room");
    let mut sender = folder.open();
    assert_eq!(status(&sender, 1), Some(UploadStatus::Kept));
    answer(&mut sender, &mut host, 200, KEPT);
    assert_eq!(folder.names(), [name_of(1, "sent")]);
}

/// A file that can't be read doesn't count as kept, and is loaded once it can be read.
#[test]
fn a_parcel_that_cant_be_read_is_taken_in_later() {
    let folder = Folder::new("unreadable");
    let mut host = Host::default();
    drop(folder.open());
    let path = folder.0.join(name_of(1, "parcel"));
    fs::create_dir(&path).expect("room on the disk");
    let mut sender = folder.open();
    assert!(matches!(sender.keep(&parcel(1)), Err(SpoolError::Disk { .. })));
    assert_eq!(status(&sender, 1), None);
    fs::remove_dir(&path).expect("it is empty");
    fs::write(&path, parcel(1).file_bytes()).expect("room on the disk");
    sender.step(&mut host);
    host.now_ms += 61_000;
    sender.step(&mut host);
    assert_eq!(status(&sender, 1), Some(UploadStatus::Kept));
}

/// A parcel of another version isn't damaged: it stays unchanged.
#[test]
fn a_parcel_of_another_version_stays_for_that() {
    let folder = Folder::new("versions");
    drop(folder.open());
    let bytes = append_hash([&9u32.to_le_bytes()[..], b"{\"new\":2}"].concat());
    let names = [name_of(1, "parcel"), name_of(2, "sent")];
    names.iter().for_each(|name| fs::write(folder.0.join(name), &bytes).expect("room"));
    let sender = folder.open();
    assert!(sender.spool().entries().is_empty());
    assert_eq!(folder.names(), names);
}

#[test]
fn files_of_others_stay_where_they_are() {
    let folder = Folder::new("others");
    drop(folder.open());
    let names = ["badges.lease", "note.txt", "0101.parcel", "UP.parcel"];
    names.iter().for_each(|name| fs::write(folder.0.join(name), b"x").expect("room"));
    let sender = folder.open();
    assert!(sender.spool().entries().is_empty() && !sender.was_wiped());
    let mut expected = names.map(String::from).to_vec();
    expected.sort();
    assert_eq!(folder.names(), expected);
}

#[test]
fn two_processes_never_have_one_outbox() {
    let folder = Folder::new("claim");
    let sender = folder.open();
    let error = DiskFolder::open(&folder.0).expect_err("it is open");
    assert!(error.to_string().contains("another process has it open"), "{error}");
    drop(sender);
    assert!(DiskFolder::open(&folder.0).is_ok());
    assert!(DiskFolder::open(Path::new("/dev/null/outbox")).is_err());
}
