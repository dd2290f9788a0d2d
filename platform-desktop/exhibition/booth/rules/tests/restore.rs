//! Restores from a copy.

use std::io;
use std::sync::Arc;

use super::common::*;
use paros_booth_rules::records::{MailOrder, MailState, Tombstone};
use paros_booth_rules::{
    Booth, BoothPlan, BoothTime, Deletion, KeptName, ParcelFiles, SessionBits, SiteKeys, view,
};
use paros_booth_sqlite::SqliteStore;

/// Makes a booth of the same site from a copy, with the same files.
pub(crate) fn restored(store: SqliteStore, files: Arc<MemoryFiles>) -> Rig {
    let keys = SiteKeys::new(SITE, ContentHash([6; 32]), [8; 32]);
    let plan = BoothPlan { retention_days: 30, ..BoothPlan::default() };
    let store = Arc::new(store);
    Rig { booth: Booth::new(store.clone(), files.clone(), keys, plan), store, files }
}

/// Returns the deletion log, written and parsed again.
fn log_of(rig: &Rig) -> Vec<Deletion> {
    let lines: String = rig.files.deletions().iter().map(Deletion::to_line).collect();
    lines.lines().map(|line| Deletion::parse_line(line).expect("a line of the log")).collect()
}

#[test]
fn what_was_deleted_since_is_deleted_and_the_rest_is_as_it_was() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcels = [1, 2, 3, 4].map(|id| Parcel::new(id, leased(u32::from(id))));
    for parcel in &parcels[..3] {
        rig.upload(&device, parcel, START).unwrap();
    }
    let kept = rig.booth.find_sculpture(&parcels[0].id).unwrap();
    let on_its_way = parcels[3].announcement(UploadStatus::Kept);
    rig.beat(&device, &announcing(&heartbeat(device.headset), &[on_its_way]), START);
    let copy = copy_of(rig.store.as_ref());
    rig.booth.delete(&parcels[1].id, "ana", seconds(5)).unwrap();
    rig.upload(&device, &parcels[3], seconds(6)).unwrap();
    rig.booth.delete(&parcels[3].id, "ana", seconds(7)).unwrap();

    let again = restored(copy, rig.files.clone());
    let report = again.booth.make_restored(&log_of(&rig), START, seconds(60)).unwrap();
    assert_eq!((report.sculptures, report.deleted, report.tombstones), (3, 1, 1));
    assert_eq!(again.booth.list_missing(9).unwrap(), [], "nobody waits for what was deleted");
    let again_kept = again.booth.find_sculpture(&parcels[0].id).unwrap();
    assert_eq!(again_kept, kept);
    for (parcel, outcome) in parcels.iter().zip([true, false, true, false]) {
        let sent = again.upload(&device, parcel, seconds(70)).unwrap();
        assert_eq!(sent == ParcelOutcome::Kept, outcome, "{:?}", parcel.id);
    }
    let tombstones: Vec<Tombstone> =
        view(again.store.as_ref(), |tx| tx.find("ORDER BY id", &[])).unwrap();
    let deleted_at: Vec<_> = tombstones.iter().map(|tombstone| tombstone.deleted_at).collect();
    assert_eq!(deleted_at, [seconds(5), seconds(7)], "their horizon began then");
    assert!(tombstones.iter().all(|tombstone| !tombstone.has_files));
    assert_eq!(log_of(&rig).len(), 4, "a log of its own goes on");
}

#[test]
fn a_copy_that_lacks_a_file_is_refused_unless_it_was_deleted() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::with_trace(1);
    rig.upload(&device, &parcel, START).unwrap();
    let copy = copy_of(rig.store.as_ref());
    rig.booth.delete(&parcel.id, "ana", START).unwrap();
    let again = restored(copy_of(&copy), rig.files.clone());
    assert_eq!(status(again.booth.make_restored(&[], START, START)), 409);
    let report = again.booth.make_restored(&log_of(&rig), START, START).unwrap();
    assert_eq!(report.deleted, 1);
    // A missing trace is accepted, as it may have expired.
    let other = Rig::new();
    let device = other.enrol(1);
    other.upload(&device, &parcel, START).unwrap();
    let copy = copy_of(other.store.as_ref());
    other.sweep(days(20));
    let again = restored(copy, other.files.clone());
    again.booth.make_restored(&[], START, days(20)).unwrap();
    assert!(!again.booth.find_sculpture(&parcel.id).unwrap().has_trace);
}

/// Files whose deletion log can't be written.
struct NoLog(Arc<MemoryFiles>);

impl ParcelFiles for NoLog {
    fn keep(&self, name: &KeptName, bytes: &[u8]) -> io::Result<()> {
        self.0.keep(name, bytes)
    }

    fn read_kept(&self, name: &KeptName) -> io::Result<Vec<u8>> {
        self.0.read_kept(name)
    }

    fn remove_kept(&self, name: &KeptName) -> io::Result<()> {
        self.0.remove_kept(name)
    }

    fn log_deletions(&self, _deletions: &[Deletion]) -> io::Result<()> {
        Err(io::ErrorKind::StorageFull.into())
    }

    fn forget_deletions_before(&self, time: BoothTime) -> io::Result<()> {
        self.0.forget_deletions_before(time)
    }
}

/// Files are removed after their deletion is logged, so that a backup without a file has the log line.
#[test]
fn no_file_goes_before_its_deletion_is_logged() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::with_trace(1);
    rig.upload(&device, &parcel, START).unwrap();
    let keys = SiteKeys::new(SITE, ContentHash([6; 32]), [8; 32]);
    let no_log = Arc::new(NoLog(rig.files.clone()));
    let booth = Booth::new(rig.store.clone(), no_log, keys, BoothPlan::default());
    assert_eq!(status(booth.delete(&parcel.id, "ana", START)), 503);
    assert_eq!(rig.files.kept_names().len(), 2);
    // The sculpture is deleted nevertheless, and a sweep removes its files once the disk has room.
    assert_eq!(status(booth.find_sculpture(&parcel.id)), 404);
    rig.sweep(START);
    assert_eq!((rig.files.kept_names().len(), rig.files.deletions().len()), (0, 1));
}

#[test]
fn logins_and_waiting_mails_are_over_and_tokens_stay() {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::new(1, None);
    rig.upload(&device, &parcel, START).unwrap();
    rig.booth.add_first_admin("ana", "hash", START).unwrap();
    let bits = SessionBits { cookie: [1; 32], form_token: [2; 16] };
    rig.booth.log_in("ana", &bits, START).unwrap();
    rig.booth.ask_mail(&parcel.id, ("eleni@example.org", false), 5, "ana", START).unwrap();
    let again = restored(copy_of(rig.store.as_ref()), rig.files.clone());
    let report = again.booth.make_restored(&[], START, seconds(1)).unwrap();
    assert_eq!(report.mails, 1);
    assert_eq!(status(again.booth.find_login(&bits.cookie, START)), 401);
    again.booth.enrol_fleet(&fleet_enrolment(2), START).expect("headsets enrol as before");
    let mails: Vec<MailOrder> = again.booth.list_mails(&parcel.id).unwrap();
    assert_eq!((mails[0].state, mails[0].address.as_deref()), (MailState::Failed, None));
    assert_eq!(again.booth.authenticate(&DeviceToken([1; 32])).unwrap().headset, device.headset);
    assert_eq!(again.booth.list_audit(1).unwrap()[0].action, "restore");
}
