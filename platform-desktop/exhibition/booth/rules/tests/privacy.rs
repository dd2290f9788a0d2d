//! The records of a visitor, and their deletion.

use super::common::*;
use paros_booth_rules::limits::AUDIT_DAYS;
use paros_booth_rules::records::{MailOrder, PrintOrder};
use paros_booth_rules::{BadgeRecords, MailOutcome, PrintSize, PrintWish};
use paros_core::badge::BadgeNumber;

#[test]
fn all_that_is_known_of_a_badge_is_listed_and_deleted() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let number = leased(9).unwrap();
    let parcel = Parcel::with_trace(1);
    let parcel = Parcel::of_facts(UploadFacts { badge: Some(number), ..parcel.facts });
    rig.upload(&device, &parcel, START).unwrap();
    let other = Parcel::new(2, leased(10));
    rig.upload(&device, &other, START).unwrap();
    let late = Parcel::new(3, Some(number));
    let announced = late.announcement(UploadStatus::Kept);
    rig.beat(&device, &announcing(&heartbeat(device.headset), &[announced]), START);
    rig.booth.ask_mail(&parcel.id, ("eleni@example.org", true), 5, "ana", START).unwrap();
    rig.booth.note_mail(5, &MailOutcome::Accepted, START).unwrap();
    let size = PrintSize::Height(900);
    let wish = PrintWish { size, filament: "white".into(), note: "for Eleni".into() };
    rig.booth.ask_print(&parcel.id, &wish, (6, false), "ana", START).unwrap();
    rig.booth.withdraw(&parcel.id, "ana", seconds(1)).unwrap();

    let known = rig.booth.list_known(number).unwrap();
    assert_eq!((known.sculptures.len(), known.announced.len(), known.deleted.len()), (1, 1, 0));
    let of_one = &known.sculptures[0];
    assert_eq!(of_one.sculpture.id, parcel.id.0);
    assert_eq!((of_one.mails.len(), of_one.prints.len()), (1, 1));
    assert_eq!(of_one.prints[0].note, "for Eleni");
    let actions: Vec<_> = of_one.audit.iter().map(|entry| entry.action.as_str()).collect();
    assert_eq!(actions, ["mail", "print", "withdraw"]);

    let deleted = rig.booth.delete_known(number, "ana", seconds(2)).unwrap();
    assert_eq!(deleted, [parcel.id]);
    let known = rig.booth.list_known(number).unwrap();
    assert_eq!((&known.sculptures, known.announced.len(), known.deleted.len()), (&vec![], 0, 1));
    assert_eq!(rig.booth.count::<MailOrder>("", &[]).unwrap(), 0);
    assert_eq!(rig.booth.count::<PrintOrder>("", &[]).unwrap(), 0);
    assert!(rig.files.kept_names().iter().all(|name| name.id == other.id));
    let audit = rig.booth.list_audit(99).unwrap();
    assert!(audit.iter().all(|entry| entry.badge.is_none_or(|badge| badge == 10)), "{audit:?}");
    assert_eq!(rig.booth.list_known(leased(10).unwrap()).unwrap().sculptures.len(), 1);
    // Once no headset can have the sculpture, its tombstone is removed too.
    rig.sweep(days(181));
    assert_eq!(rig.booth.list_known(number).unwrap(), BadgeRecords::default());
    assert!(rig.files.deletions().iter().all(|deletion| deletion.id == other.id), "in the log");
}

#[test]
fn the_audit_is_kept_for_a_time_and_read_in_pages() {
    let rig = Rig::new();
    rig.booth.add_first_admin("ana", "hash", START).unwrap();
    for k in 1..=5 {
        let name = format!("bob-{k}");
        let role = paros_booth_rules::records::StaffRole::Attendant;
        rig.booth.add_account(&name, "hash", role, "ana", seconds(k)).unwrap();
    }
    let newest = rig.booth.list_audit(2).unwrap();
    let actions = |entries: &[paros_booth_rules::records::AuditEntry]| {
        entries.iter().map(|entry| entry.action.clone()).collect::<Vec<_>>()
    };
    assert_eq!(actions(&newest), ["add account bob-5", "add account bob-4"]);
    let next = rig.booth.list_audit_before(newest[1].at, 2).unwrap();
    assert_eq!(actions(&next), ["add account bob-3", "add account bob-2"]);
    rig.sweep(days(u64::from(AUDIT_DAYS)));
    assert_eq!(rig.booth.list_audit(99).unwrap().len(), 7);
    rig.sweep(days(u64::from(AUDIT_DAYS) + 1));
    assert_eq!(rig.booth.list_audit(99).unwrap(), []);
}

#[test]
fn a_badge_that_nothing_has_has_nothing() {
    let rig = Rig::new();
    let known = rig.booth.list_known(BadgeNumber::provisional(5)).unwrap();
    assert_eq!(known, BadgeRecords::default());
    assert_eq!(rig.booth.delete_known(BadgeNumber::provisional(5), "ana", START).unwrap(), []);
}
