//! The life cycle of sculptures.

use super::common::*;
use paros_booth_rules::records::{ExportState, MailOrder, MailState, Tombstone};
use paros_booth_rules::{BoothPlan, KeptPart, SweepReport, update};

fn kept_parts(rig: &Rig) -> Vec<KeptPart> {
    rig.files.kept_names().into_iter().map(|name| name.part).collect()
}

#[test]
fn withdrawn_is_hidden_and_undone_for_seven_days() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(1, leased(9));
    rig.upload(&device, &parcel, START).unwrap();
    rig.booth.withdraw(&parcel.id, "ana", START).unwrap();
    assert_eq!(rig.list(false), []);
    assert_eq!(rig.list(true).len(), 1);
    // A second withdrawal doesn't extend the time.
    rig.booth.withdraw(&parcel.id, "ana", days(3)).unwrap();
    rig.sweep(days(6));
    rig.booth.bring_back(&parcel.id, "ana", days(6)).expect("in time");
    assert_eq!(rig.list(false).len(), 1);
    rig.booth.withdraw(&parcel.id, "ana", days(7)).unwrap();
    assert_eq!(rig.sweep(days(12)).deleted, 0);
    assert_eq!(rig.sweep(days(13)).deleted, 1, "the booth had seen six days pass");
    assert_eq!(status(rig.booth.bring_back(&parcel.id, "ana", days(13))), 404);
    assert_eq!(rig.list(true), []);
    assert_eq!(kept_parts(&rig), []);
}

#[test]
fn what_is_deleted_leaves_a_tombstone_until_the_horizon() {
    let rig = Rig::with_plan(BoothPlan { horizon_days: 50, ..BoothPlan::default() });
    let device = rig.enrol(1);
    let parcel = Parcel::with_trace(1);
    rig.upload(&device, &parcel, START).unwrap();
    let order = MailOrder {
        order: 1,
        sculpture: parcel.id.0,
        address: Some("eleni@example.org".into()),
        language: 1,
        asked_at: START,
        state: MailState::Queued,
        tries: 0,
        next_try_at: START,
        why: String::new(),
        keeps_address: false,
    };
    update(rig.store.as_ref(), |tx| tx.put(&order)).unwrap();
    rig.booth.delete(&parcel.id, "ana", START).unwrap();
    assert_eq!(status(rig.booth.find_sculpture(&parcel.id)), 404);
    assert_eq!(kept_parts(&rig), []);
    let orders = rig.booth.count::<MailOrder>("", &[]).unwrap();
    assert_eq!(orders, 0, "an address stays");
    let late = rig.upload(&device, &parcel, days(49)).unwrap();
    assert_eq!(late, ParcelOutcome::Deleted);
    assert_eq!(kept_parts(&rig), []);
    assert_eq!(rig.sweep(days(49)).tombstones, 0);
    assert_eq!(rig.sweep(days(50)).tombstones, 1);
    assert_eq!(status(rig.booth.delete(&parcel.id, "ana", START)), 404);
}

#[test]
fn sculptures_go_by_age() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let early = Parcel::new(1, leased(100_000));
    let late = Parcel::new(2, leased(200_000));
    rig.upload(&device, &early, START).unwrap();
    rig.upload(&device, &late, days(1)).unwrap();
    assert_eq!(rig.sweep(days(23)).withdrawn, 0);
    assert_eq!(rig.sweep(days(24)).withdrawn, 1, "its last seven days");
    assert_eq!(rig.list(false)[0].id, late.id.0);
    assert_eq!(rig.sweep(days(30)), SweepReport { withdrawn: 1, ..SweepReport::default() });
    assert_eq!(rig.sweep(days(31)).deleted, 1);
    let sent = rig.upload(&device, &early, days(31)).unwrap();
    assert_eq!(sent, ParcelOutcome::Deleted);
}

#[test]
fn a_sweep_takes_any_number() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    for id in 1..=150 {
        rig.upload(&device, &Parcel::new(id, None), START).unwrap();
    }
    assert_eq!(rig.sweep(days(40)).withdrawn, 150);
    assert_eq!(rig.sweep(days(47)).deleted, 150);
    assert_eq!(kept_parts(&rig), []);
    assert_eq!(rig.booth.count::<Tombstone>("WHERE has_files = 1", &[]).unwrap(), 0);
}

#[test]
fn traces_are_kept_for_fourteen_days() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::with_trace(1);
    let signed = rig.upload(&device, &parcel, START).unwrap();
    assert_eq!(kept_parts(&rig), [KeptPart::Sculpture, KeptPart::Trace]);
    assert_eq!(rig.sweep(days(14)).traces, 0);
    assert_eq!(rig.sweep(days(15)).traces, 1);
    assert_eq!(kept_parts(&rig), [KeptPart::Sculpture]);
    assert!(!rig.booth.find_sculpture(&parcel.id).unwrap().has_trace);
    assert_eq!(rig.upload(&device, &parcel, days(15)).unwrap(), signed, "it is known");
}

#[test]
fn a_picture_goes_with_its_sculpture() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(1, None);
    rig.upload(&device, &parcel, START).unwrap();
    let sculpture = rig.booth.find_sculpture(&parcel.id).unwrap();
    assert_eq!(rig.booth.read_picture(&sculpture).unwrap(), None);
    rig.booth.keep_picture(&sculpture, b"png").unwrap();
    assert_eq!(rig.booth.read_picture(&sculpture).unwrap().as_deref(), Some(&b"png"[..]));
    rig.booth.delete(&parcel.id, "ana", START).unwrap();
    assert_eq!(kept_parts(&rig), []);
    // The picture was drawn while the sculpture was deleted.
    rig.booth.keep_picture(&sculpture, b"png").unwrap();
    assert_eq!(kept_parts(&rig), []);
}

#[test]
fn announcements_are_forgotten_when_nobody_waits_any_more() {
    let rig = Rig::with_plan(BoothPlan { horizon_days: 50, ..BoothPlan::default() });
    let device = rig.enrol(1);
    let announced = Parcel::new(1, None).announcement(UploadStatus::Kept);
    rig.beat(&device, &announcing(&heartbeat(device.headset), &[announced]), START);
    assert_eq!(rig.sweep(days(50)).announcements, 0);
    assert_eq!(rig.sweep(days(51)).announcements, 1);
}

#[test]
fn meshes_are_compared_in_the_order_of_arrival() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    for id in [3, 1, 2] {
        rig.upload(&device, &Parcel::new(id, None), seconds(id.into())).unwrap();
    }
    for id in [1, 2, 3] {
        let next = rig.booth.next_export(START).unwrap().expect("one waits");
        assert_eq!(next.id, [id; 16]);
        rig.booth.note_export(&SculptureId(next.id), ExportState::Made).unwrap();
    }
    assert_eq!(rig.booth.next_export(START).unwrap(), None);
    rig.booth.note_export(&SculptureId([9; 16]), ExportState::Failed).expect("it was deleted");
    let newest = rig.list(false);
    assert!(newest.iter().all(|kept| kept.export == ExportState::Made));
}

#[test]
fn the_audit_says_who_did_what() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(1, leased(9));
    rig.upload(&device, &parcel, START).unwrap();
    rig.booth.withdraw(&parcel.id, "ana", seconds(1)).unwrap();
    rig.booth.bring_back(&parcel.id, "bob", seconds(1)).unwrap();
    rig.booth.delete(&parcel.id, "ana", seconds(2)).unwrap();
    let audit = rig.booth.list_audit(3).unwrap();
    let told: Vec<_> = audit
        .iter()
        .map(|entry| (entry.account.as_deref().unwrap_or(""), entry.action.as_str()))
        .collect();
    assert_eq!(told, [("ana", "delete"), ("ana", "withdraw"), ("bob", "bring back")]);
    assert!(audit.iter().all(|entry| entry.sculpture == Some(parcel.id.0)));
}
