//! Work leases of several booth processes on the same records.

use std::collections::BTreeSet;
use std::sync::Mutex;

use super::common::*;
use paros_booth_rules::limits::WORK_LIFE;
use paros_booth_rules::records::{ExportState, WorkKind, WorkLease};
use paros_booth_rules::{
    Booth, BoothTime, MailOutcome, PrintSize, PrintStep, PrintWish, PrinterTask, SliceOutcome,
};

/// Makes a booth with this many sculptures, and two of its processes.
fn with_sculptures(count: u8) -> (Rig, [Booth; 2]) {
    let rig = Rig::new();
    let device = rig.enrol(1);
    for id in 1..=count {
        let parcel = Parcel::new(id, None);
        rig.upload(&device, &parcel, seconds(id.into())).unwrap();
    }
    let workers = [1, 2].map(|worker| rig.booth.clone().as_worker(worker));
    (rig, workers)
}

fn next_export(booth: &Booth, now: BoothTime) -> Option<u8> {
    booth.next_export(now).unwrap().map(|sculpture| sculpture.id[0])
}

fn count_leases(rig: &Rig) -> u64 {
    rig.booth.count::<WorkLease>("", &[]).unwrap()
}

#[test]
fn a_mesh_is_one_process_work_until_it_is_done_or_its_time_is_over() {
    let (rig, [one, two]) = with_sculptures(2);
    assert_eq!(next_export(&one, START), Some(1));
    assert_eq!(next_export(&one, START), Some(1), "its own again, as after a failure of the disk");
    assert_eq!(next_export(&two, START), Some(2));
    one.note_export(&SculptureId([1; 16]), ExportState::Made).unwrap();
    assert_eq!(next_export(&one, START), None);
    let last = BoothTime(START.after(WORK_LIFE).0 - 1);
    assert_eq!(next_export(&one, last), None);
    assert_eq!(next_export(&one, START.after(WORK_LIFE)), Some(2), "the other one is dead");
    two.note_export(&SculptureId([2; 16]), ExportState::Made).unwrap();
    assert_eq!(count_leases(&rig), 0);
}

/// Clocks differ, and transactions take time: an existing lease may end later than a new one.
#[test]
fn a_clock_that_is_behind_takes_no_lease_away() {
    let (_, [one, two]) = with_sculptures(1);
    assert_eq!(next_export(&one, seconds(30)), Some(1));
    assert_eq!(next_export(&two, START), None);
    assert_eq!(next_export(&two, seconds(31)), None);
}

#[test]
fn a_lease_by_a_clock_that_went_wrong_holds_nobody_up() {
    let (_, [one, two]) = with_sculptures(1);
    assert_eq!(next_export(&one, days(300)), Some(1));
    assert_eq!(next_export(&two, START), Some(1));
}

#[test]
fn a_mail_is_sent_by_one_process() {
    let (rig, [one, two]) = with_sculptures(2);
    for order in [7, 8] {
        let id = SculptureId([order as u8 - 6; 16]);
        one.ask_mail(&id, ("ana@example.org", false), order, "bob", seconds(order)).unwrap();
    }
    let next = |booth: &Booth, now| booth.next_mail(now).unwrap().map(|job| job.order);
    assert_eq!(next(&one, seconds(9)), Some(7));
    assert_eq!(next(&two, seconds(9)), Some(8));
    two.note_mail(8, &MailOutcome::Accepted, seconds(9)).unwrap();
    assert_eq!(next(&two, seconds(9)), None);
    one.note_mail(7, &MailOutcome::Later("no answer".into()), seconds(10)).unwrap();
    assert_eq!(next(&two, days(1)), Some(7), "the next try is anybody's");
    two.note_mail(7, &MailOutcome::Accepted, days(1)).unwrap();
    assert_eq!(count_leases(&rig), 0);
}

const KNOWN: SliceOutcome = SliceOutcome::Known { height: 800, minutes: 95, tenths_gram: 123 };

/// Makes a booth with this many prints that wait for the slicer, from 1 on, and two of its processes.
fn with_prints(count: u64) -> (Rig, [Booth; 2]) {
    let (rig, workers) = with_sculptures(1);
    let wish =
        PrintWish { size: PrintSize::Height(800), filament: String::new(), note: String::new() };
    for order in 1..=count {
        let id = SculptureId([1; 16]);
        rig.booth.ask_print(&id, &wish, (order, true), "bob", seconds(order)).unwrap();
    }
    (rig, workers)
}

fn next_slice(booth: &Booth, now: BoothTime) -> Option<u64> {
    booth.next_slice(now).unwrap().map(|job| job.order.order)
}

#[test]
fn a_print_is_sliced_by_one_process_and_one_that_dies_is_followed() {
    let (rig, [one, two]) = with_prints(3);
    // The print was started by hand before its turn.
    one.step_print(1, (PrintStep::Start, true), "bob", seconds(4)).unwrap();
    let now = seconds(5);
    assert_eq!(next_slice(&one, now), Some(2));
    assert_eq!(next_slice(&two, now), Some(3));
    two.note_slice(3, &KNOWN, now).unwrap();
    assert_eq!(next_slice(&two, now), Some(1));
    two.note_slice(1, &KNOWN, now).unwrap();
    assert_eq!(next_slice(&two, now), None);
    assert_eq!(next_slice(&two, BoothTime(now.after(WORK_LIFE).0 - 1)), None);
    assert_eq!(next_slice(&two, now.after(WORK_LIFE)), Some(2), "the other one is dead");
    two.note_slice(2, &KNOWN, now).unwrap();
    assert_eq!(count_leases(&rig), 0);
}

/// The search of a size for a duration takes several slices of minutes each.
#[test]
fn what_takes_long_is_renewed_and_what_cannot_be_done_is_left() {
    let (rig, [one, two]) = with_prints(1);
    let (kind, subject) = (WorkKind::Slice, 1_u64.to_le_bytes());
    assert!(!one.renew_work(kind, &subject, START).unwrap(), "it was never taken");
    let mut now = seconds(2);
    assert_eq!(next_slice(&one, now), Some(1));
    for _ in 0..4 {
        now = now.after(WORK_LIFE / 2);
        assert!(one.renew_work(kind, &subject, now).unwrap());
        assert!(!two.renew_work(kind, &subject, now).unwrap());
        assert_eq!(next_slice(&two, now), None);
    }
    two.leave_work(kind, &subject).unwrap();
    assert_eq!(next_slice(&two, now), None, "it was not its own to leave");
    one.leave_work(kind, &subject).unwrap();
    assert_eq!(next_slice(&two, now), Some(1));
    assert!(!one.renew_work(kind, &subject, now.after(WORK_LIFE)).unwrap(), "it is another's");
    assert_eq!(count_leases(&rig), 1);
}

/// Two processes that stop a print at once would also stop the next print, which was sent in between.
#[test]
fn a_printer_is_one_process_matter() {
    let (rig, [one, two]) = with_prints(2);
    let task = |booth: &Booth, now| booth.next_printer_task("Left", now).unwrap();
    for order in [1, 2] {
        assert_eq!(next_slice(&one, START), Some(order));
        one.note_slice(order, &KNOWN, START).unwrap();
    }
    one.send_print(1, "Left", "bob", START).unwrap();
    assert!(matches!(task(&one, START), Some(PrinterTask::Send(_))));
    assert_eq!(task(&two, START), None);
    assert_eq!(two.next_printer_task("Right", START).unwrap(), None);
    assert!(one.begin_print(1, "a.gcode", START).unwrap());
    one.step_print(1, (PrintStep::Cancel, true), "bob", START).unwrap();
    assert!(matches!(task(&one, START), Some(PrinterTask::Stop(_))));
    assert_eq!(task(&two, seconds(1)), None);
    one.release_printer(1).unwrap();
    two.send_print(2, "Left", "bob", seconds(2)).unwrap();
    assert_eq!(task(&two, seconds(2)), None, "the first one still sees to it");
    let later = seconds(1).after(WORK_LIFE);
    assert!(matches!(task(&two, later), Some(PrinterTask::Send(_))), "the other one is dead");
    assert!(two.begin_print(2, "b.gcode", later).unwrap());
    two.step_print(2, (PrintStep::Finish, true), "bob", later).unwrap();
    assert_eq!(task(&two, later), None);
    assert_eq!(count_leases(&rig), 0, "who comes first takes it up next time");
}

#[test]
fn leases_of_the_dead_are_forgotten() {
    let (rig, [one, two]) = with_sculptures(2);
    next_export(&one, START);
    rig.booth.delete(&SculptureId([1; 16]), "ana", START).unwrap();
    rig.sweep(START.after(WORK_LIFE));
    assert_eq!(count_leases(&rig), 1);
    rig.sweep(START.after(2 * WORK_LIFE));
    assert_eq!(count_leases(&rig), 0);
    // A booth that runs alone deletes the leases of earlier processes when it starts.
    next_export(&one, START);
    two.drop_leases().unwrap();
    assert_eq!(next_export(&two, START), Some(2));
}

/// Threads check meshes concurrently: each mesh is checked exactly once.
#[test]
fn each_mesh_is_compared_once() {
    const COUNT: u8 = 24;
    let (rig, _) = with_sculptures(COUNT);
    let done = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for worker in 1..=3 {
            let (booth, done) = (rig.booth.clone().as_worker(worker), &done);
            scope.spawn(move || {
                while let Some(id) = next_export(&booth, seconds(100)) {
                    done.lock().unwrap().push(id);
                    booth.note_export(&SculptureId([id; 16]), ExportState::Made).unwrap();
                }
            });
        }
    });
    let done = done.into_inner().unwrap();
    assert_eq!(done.iter().collect::<BTreeSet<_>>().len(), usize::from(COUNT), "{done:?}");
    assert_eq!(done.len(), usize::from(COUNT), "{done:?}");
}
