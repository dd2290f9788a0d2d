//! A courier on a real folder, with a fake booth behind its link.

use std::sync::atomic::Ordering;
use std::thread;
use std::time::Duration;

use paros_core::badge::BadgeNumber;
use paros_protocol::*;
use paros_shell::settings::BoothSettings;

use super::test_booth::{OWNER, Rig, clock, wait};
use super::{Courier, FinishedSculpture, ParcelDraft};
use crate::OutboxOwner;
use crate::enrolment::{Enrolment, NewDevice, enrolment_file};
use crate::tests::facts_of;

fn draft(id: SculptureId, badge: Option<BadgeNumber>) -> ParcelDraft {
    let facts = UploadFacts { badge, ..facts_of(id) };
    ParcelDraft { facts, volume: b"a volume".to_vec(), trace: None }
}

#[test]
fn a_sculpture_is_kept_here_and_then_at_the_booth_under_a_leased_badge() {
    let rig = Rig::new("kept");
    rig.is_down.store(true, Ordering::Relaxed);
    let courier = rig.start(None);
    let id = SculptureId([1; 16]);
    courier.announce(id, b"a volume".to_vec());
    assert_eq!(courier.upload_status(id), Some(UploadStatus::Making));
    courier.ask_badge(id);
    let badge = wait("a badge", || courier.badge_of(id));
    assert!(badge.is_provisional(), "the booth leased nothing yet");
    courier.keep(draft(id, Some(badge)));
    wait("kept here", || (courier.upload_status(id) == Some(UploadStatus::Kept)).then_some(()));
    assert_eq!(courier.summary().owed, 1);
    assert_eq!(rig.parcel_files().len(), 1);
    rig.is_down.store(false, Ordering::Relaxed);
    wait("kept at the booth", || {
        (courier.upload_status(id) == Some(UploadStatus::Sent)).then_some(())
    });
    assert_eq!(courier.summary().owed, 0);
    wait("a lease", || rig.folder.join("badges.lease").exists().then_some(()));
    let next = SculptureId([2; 16]);
    courier.ask_badge(next);
    assert!(!wait("a badge", || courier.badge_of(next)).is_provisional());
}

/// The booth was restored from a backup older than the enrolment. The courier reports that once, and sends
/// its parcels once the device has enrolled again.
#[test]
fn one_that_is_forgotten_says_so_once_and_brings_all_as_the_headset_that_it_becomes() {
    let rig = Rig::new("forgotten");
    rig.status.store(401, Ordering::Relaxed);
    let courier = rig.start(None);
    let id = SculptureId([6; 16]);
    courier.keep(draft(id, None));
    wait("a refusal", || courier.is_forgotten().then_some(()));
    let mut notes = courier.take_notes();
    // Wait for some heartbeats.
    thread::sleep(Duration::from_millis(5000));
    notes.extend(courier.take_notes());
    let told = |note: &&String| note.contains("must be enrolled anew");
    assert_eq!(notes.iter().filter(told).count(), 1, "{notes:?}");
    assert_eq!(courier.upload_status(id), Some(UploadStatus::Kept));
    rig.status.store(403, Ordering::Relaxed);
    wait("another one", || (!courier.is_forgotten()).then_some(()));
    wait("a note", || courier.take_notes().iter().any(|note| note.contains("shut")).then_some(()));
    rig.status.store(200, Ordering::Relaxed);
    drop(courier);
    let courier = rig.start_as(OWNER.headset + 1, None);
    wait("a receipt", || (courier.upload_status(id) == Some(UploadStatus::Sent)).then_some(()));
    assert!(!courier.is_forgotten());
    assert_eq!(rig.parcel_files().len(), 1);
}

#[test]
fn a_start_finds_what_was_finished_last_and_whether_it_was_kept() {
    let rig = Rig::new("found");
    rig.is_down.store(true, Ordering::Relaxed);
    let id = SculptureId([3; 16]);
    let courier = rig.start(None);
    assert_eq!(courier.last_finished(), None);
    courier.announce(id, b"a volume".to_vec());
    // The courier carries out its orders before it ends.
    drop(courier);
    let courier = rig.start(None);
    let found = *courier.last_finished().expect("it was finished");
    assert_eq!((found.id, found.is_kept), (id, false));
    assert_eq!(courier.found(), [], "its parcel isn't made");
    courier.announce(id, b"a volume".to_vec());
    courier.keep(draft(id, None));
    drop(courier);
    let courier = rig.start(None);
    assert_eq!(courier.last_finished(), Some(&FinishedSculpture { is_kept: true, ..found }));
    assert_eq!(courier.found(), [(id, UploadStatus::Kept)]);
}

/// The badge says *kept at the booth* for as long as it is shown, even after the grace period.
#[test]
fn what_has_left_the_outbox_is_kept_at_the_booth_still() {
    let mut rig = Rig::new("left");
    rig.grace_seconds = 0;
    let courier = rig.start(None);
    let id = SculptureId([8; 16]);
    courier.keep(draft(id, None));
    wait("kept at the booth", || {
        (courier.upload_status(id) == Some(UploadStatus::Sent)).then_some(())
    });
    wait("it leaves", || (rig.parcel_files().is_empty()).then_some(()));
    thread::sleep(Duration::from_millis(500));
    assert_eq!(courier.upload_status(id), Some(UploadStatus::Sent));
}

#[test]
fn a_parcel_without_room_waits_and_is_kept_once_there_is() {
    let rig = Rig::new("full");
    let courier = rig.start(None);
    let id = SculptureId([5; 16]);
    // A folder in place of the parcel's file makes the write fail.
    let place = rig.folder.join(format!("{id}.parcel"));
    std::fs::create_dir(&place).expect("a folder");
    courier.keep(draft(id, None));
    wait("a refusal", || (courier.upload_status(id) == Some(UploadStatus::Waiting)).then_some(()));
    assert!(courier.take_notes().iter().any(|note| note.contains("isn't kept yet")));
    std::fs::remove_dir(&place).expect("it is empty");
    wait("kept", || (courier.upload_status(id) == Some(UploadStatus::Sent)).then_some(()));
}

/// A headset enrols again while its outbox is full: the parcel exists only in memory.
#[test]
fn a_parcel_without_room_goes_on_to_the_next_courier() {
    let rig = Rig::new("handed-on");
    let courier = rig.start(None);
    let id = SculptureId([5; 16]);
    courier.announce(id, b"a volume".to_vec());
    let place = rig.folder.join(format!("{id}.parcel"));
    std::fs::create_dir(&place).expect("a folder");
    courier.keep(draft(id, None));
    wait("a refusal", || (courier.upload_status(id) == Some(UploadStatus::Waiting)).then_some(()));
    let without_room = courier.close();
    assert_eq!(without_room.len(), 1);
    let courier = rig.start_as(OWNER.headset + 1, None);
    courier.keep_parcels(without_room);
    wait("a refusal", || (courier.upload_status(id) == Some(UploadStatus::Waiting)).then_some(()));
    std::fs::remove_dir(&place).expect("it is empty");
    wait("kept", || (courier.upload_status(id) == Some(UploadStatus::Sent)).then_some(()));
}

#[test]
fn a_command_is_taken_once_and_not_when_its_life_is_over() {
    let command = BoothCommand {
        id: 1,
        boot_id: 1,
        session_id: 0,
        kind: CommandKind::Identify,
        lives_ms: 10_000,
    };
    let rig = Rig::new("commands");
    let courier = rig.start(Some(command));
    let taken = wait("a command", || courier.take_command());
    assert_eq!((taken.id, taken.kind), (1, CommandKind::Identify));
    thread::sleep(Duration::from_millis(2300));
    assert_eq!(courier.take_command(), None, "it rides on each answer until it is reported");
    drop(courier);
    let courier = rig.start(Some(BoothCommand { lives_ms: 300, ..command }));
    thread::sleep(Duration::from_millis(1000));
    assert_eq!(courier.take_command(), None, "nobody took it while it lived");
}

#[test]
fn another_process_has_no_outbox_beside_it() {
    let rig = Rig::new("two");
    let _first = rig.start(None);
    let opened = std::panic::catch_unwind(|| rig.start(None));
    assert!(opened.is_err());
}

/// A device that enrolled at another site keeps the first site's unsent sculptures, and reports their folder.
#[test]
fn each_site_has_its_own_outbox_and_an_old_one_is_refused() {
    let rig = Rig::new("sites");
    let settings = BoothSettings { grace_days: 1, space_mb: 1, ..BoothSettings::default() };
    let sessions = &rig.folder;
    let open = |site: u8| {
        let device = NewDevice::draw(None, DeviceName::new("t").expect("a name"));
        let enrolment = Enrolment {
            address: "https://b:1".into(),
            ca: vec![1],
            token: device.expect("random bits").token,
            owner: OutboxOwner { site: SiteId([site; 16]), headset: 1 },
        };
        enrolment.write(&enrolment_file(sessions)).expect("room on the disk");
        let link = |_: &Enrolment| Ok(rig.link(1, None));
        Courier::open_enrolled(&settings, sessions, clock, link)
    };
    let id = SculptureId([4; 16]);
    rig.is_down.store(true, Ordering::Relaxed);
    let courier = open(1).expect("an outbox").expect("it is enrolled");
    courier.keep(draft(id, None));
    wait("kept", || (courier.upload_status(id) == Some(UploadStatus::Kept)).then_some(()));
    drop(courier);
    let courier = open(2).expect("an outbox").expect("it is enrolled");
    assert_eq!((courier.found(), courier.upload_status(id)), (&[][..], None));
    let notes = courier.take_notes();
    let left = sessions.join("outbox").join("01".repeat(16));
    let expected = format!("1 sculptures wait for the booth of another site in {}", left.display());
    assert_eq!(notes, [expected]);
    drop(courier);
    std::fs::write(sessions.join("outbox/outbox.journal"), b"PBOX").expect("room on the disk");
    let why = open(1).expect_err("it is an old one");
    assert!(why.contains("an outbox of another version"), "{why}");
}
