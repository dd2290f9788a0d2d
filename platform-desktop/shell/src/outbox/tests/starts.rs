//! Starts, and what the one before left.

use std::fs;
use std::path::Path;

use paros_core::outbox::messages::{Heartbeat, SculptureId};
use paros_core::outbox::{EntryState, OutboxOwner};

use super::{
    BoothRequest, DiskFolder, Folder, Host, OWNER, OutboxEvent, answer, parcel, receipt_of, state,
};

#[test]
fn a_journal_that_is_damaged_costs_nothing_but_receipts() {
    let (folder, parcels) = (Folder::new("journal"), [parcel(1), parcel(2), parcel(3)]);
    let mut driver = folder.open();
    assert!(driver.outbox().was_wiped());
    parcels.iter().for_each(|parcel| driver.keep(parcel).expect("room"));
    drop(driver);
    let journal = folder.0.join("outbox.journal");
    let mut bytes = fs::read(&journal).expect("a journal");
    bytes[100] ^= 1;
    fs::write(&journal, &bytes).expect("room on the disk");
    let spoil = |number: u8, at: usize| {
        let path = folder.0.join(format!("{}.parcel", SculptureId([number; 16])));
        let mut bytes = fs::read(&path).expect("a parcel");
        bytes[at] ^= 1;
        fs::write(&path, &bytes).expect("room on the disk");
    };
    spoil(2, 80);
    let mut driver = folder.open();
    let mut host = Host::default();
    driver.step(&mut host);
    assert!(host.events.contains(&OutboxEvent::JournalDamaged));
    assert!(!driver.outbox().was_wiped(), "parcels are here");
    let states = parcels.each_ref().map(|parcel| state(&driver, parcel));
    assert_eq!(states, [Some(EntryState::Kept), None, Some(EntryState::Sending { held: 0 })]);
    assert!(folder.names().contains(&format!("{}.damaged", SculptureId([2; 16]))));
    // What is known and damaged is lost, and said so; what is gone too.
    drop(driver);
    spoil(1, 20);
    fs::remove_file(folder.0.join(format!("{}.parcel", SculptureId([3; 16])))).expect("a parcel");
    let mut driver = folder.open();
    driver.step(&mut host);
    let states = parcels.each_ref().map(|parcel| state(&driver, parcel));
    assert_eq!(states, [Some(EntryState::Lost), None, Some(EntryState::Lost)]);
    for number in [1, 3] {
        assert!(host.events.contains(&OutboxEvent::Lost(SculptureId([number; 16]))));
    }
}

#[test]
fn an_id_that_is_anothers_is_exchanged_for_the_same_one_each_time() {
    let (folder, parcel) = (Folder::new("conflict"), parcel(1));
    let mut driver = folder.open();
    let mut host = Host::default();
    driver.keep(&parcel).expect("room");
    answer(&mut driver, &mut host, 409, Vec::new());
    let renewed = parcel.renew(OWNER.headset).expect("the same");
    let (old, new) = (parcel.facts().id, renewed.facts().id);
    assert!(host.events.contains(&OutboxEvent::Renewed { old, new }));
    assert_ne!(renewed.hash(), parcel.hash());
    host.now_ms += 1;
    driver.step(&mut host);
    assert_eq!(folder.names(), [format!("{new}.parcel"), "outbox.journal".into()]);
    // The old file is back, as after a loss of power.
    drop(driver);
    fs::write(folder.0.join(format!("{old}.parcel")), parcel.to_file()).expect("room");
    let mut driver = folder.open();
    driver.step(&mut host);
    assert_eq!(driver.outbox().entries().len(), 1);
    assert_eq!(folder.names(), [format!("{new}.parcel"), "outbox.journal".into()]);
    let sent = answer(&mut driver, &mut host, 200, receipt_of(&renewed));
    assert!(matches!(sent, BoothRequest::Put { id, .. } if id == new));
    assert!(host.events.contains(&OutboxEvent::KeptAtBooth(new)));
}

/// Power went before the old file was removed, and the new one isn't what was written.
#[test]
fn what_goes_on_under_another_id_is_made_again_where_it_is_damaged() {
    for damage in [Some(&b"half a parcel"[..]), None] {
        let (folder, parcel) = (Folder::new("successor"), parcel(1));
        let mut driver = folder.open();
        let mut host = Host::default();
        driver.keep(&parcel).expect("room");
        answer(&mut driver, &mut host, 409, Vec::new());
        driver.step(&mut host);
        drop(driver);
        let renewed = parcel.renew(OWNER.headset).expect("the same");
        let [old, new] = [&parcel, &renewed]
            .map(|parcel| folder.0.join(format!("{}.parcel", parcel.facts().id)));
        fs::write(&old, parcel.to_file()).expect("room on the disk");
        match damage {
            Some(bytes) => fs::write(&new, bytes).expect("room on the disk"),
            None => fs::remove_file(&new).expect("it was written"),
        }
        let mut driver = folder.open();
        let mut host = Host::default();
        driver.step(&mut host);
        assert_eq!(fs::read(&new).expect("it is made again"), renewed.to_file());
        assert!(!old.exists(), "{damage:?}");
        assert!(!host.events.contains(&OutboxEvent::Lost(renewed.facts().id)));
        answer(&mut driver, &mut host, 200, receipt_of(&renewed));
        assert!(host.events.contains(&OutboxEvent::KeptAtBooth(renewed.facts().id)));
    }
}

/// Under its old id the booth would wait for it in vain.
#[test]
fn what_is_owed_from_before_another_number_is_told_of_under_its_new_id_alone() {
    let (folder, parcels) = (Folder::new("renumbered"), [parcel(1), parcel(2)]);
    let mut host = Host::default();
    let mut driver = folder.open();
    driver.keep(&parcels[0]).expect("room");
    answer(&mut driver, &mut host, 200, receipt_of(&parcels[0]));
    driver.keep(&parcels[1]).expect("room");
    driver.step(&mut host);
    drop(driver);
    let mut driver = folder.open_as(OutboxOwner { headset: 18, ..OWNER });
    let renewed = parcels[1].renew(18).expect("the same");
    let ids: Vec<_> = driver.outbox().entries().iter().map(|entry| entry.id).collect();
    assert_eq!(ids, [parcels[0].facts().id, renewed.facts().id], "what is signed for stays");
    host.now_ms += 10_000;
    driver.step(&mut host);
    let sent = driver.link().sent.iter();
    let beats = sent.filter_map(|request| match request {
        BoothRequest::Heartbeat { body, .. } => {
            Some(Heartbeat::from_bytes(&body[..]).expect("its own"))
        }
        BoothRequest::Put { .. } => None,
    });
    let told: Vec<_> = beats.flat_map(|beat| beat.announcements).map(|told| told.id).collect();
    assert!(told.contains(&renewed.facts().id), "{told:?}");
    assert!(!told.contains(&parcels[1].facts().id), "{told:?}");
}

#[test]
fn two_processes_never_have_one_outbox() {
    let folder = Folder::new("claim");
    let driver = folder.open();
    let error = DiskFolder::open(&folder.0).expect_err("it is open");
    assert!(error.to_string().contains("another process has it open"), "{error}");
    drop(driver);
    assert!(DiskFolder::open(&folder.0).is_ok());
    assert!(DiskFolder::open(Path::new("/dev/null/outbox")).is_err());
}
