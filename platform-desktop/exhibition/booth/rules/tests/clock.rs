//! Clock jumps.

use std::time::Duration;

use super::common::*;
use paros_booth_rules::limits::{MAX_CLOCK_GAP, MAX_CLOCK_STEP};
use paros_booth_rules::{BoothTime, SweepReport};

const YEARS: u64 = 3 * 365;

/// Makes a booth with a retention of 30 days and a sculpture of `START`, up to which it has seen the clock.
fn booth_with_sculpture() -> (Rig, Parcel) {
    let rig = Rig::new();
    let device = rig.enrol(1);
    let parcel = Parcel::with_trace(1);
    rig.upload(&device, &parcel, START).unwrap();
    rig.sweep(START);
    (rig, parcel)
}

fn shown(rig: &Rig) -> usize {
    rig.list(false).len()
}

/// Sweeps on every day of a range, like a running booth.
fn run(rig: &Rig, all: std::ops::RangeInclusive<u64>) -> SweepReport {
    let mut sum = SweepReport::default();
    for day in all {
        let report = rig.sweep(days(day));
        sum.withdrawn += report.withdrawn;
        sum.deleted += report.deleted;
    }
    sum
}

#[test]
fn a_clock_that_is_ahead_hides_and_deletes_nothing() {
    let (rig, parcel) = booth_with_sculpture();
    let ahead = days(YEARS);
    for most in [MAX_CLOCK_GAP, MAX_CLOCK_STEP, MAX_CLOCK_STEP] {
        assert_eq!(rig.booth.sweep(ahead, most).unwrap(), SweepReport::default());
    }
    assert_eq!(shown(&rig), 1);
    let jump = rig.booth.find_clock_jump(ahead).unwrap().expect("it asks");
    assert_eq!((jump.seen_at, jump.now), (START, ahead));
    assert_eq!(rig.booth.find_clock_jump(START).unwrap(), None, "the clock was set right");
    assert!(rig.booth.find_sculpture(&parcel.id).unwrap().has_trace);
}

#[test]
fn a_gap_of_two_weeks_needs_no_answer() {
    let (rig, _) = booth_with_sculpture();
    let after = |gap: Duration| START.after(gap);
    rig.booth.sweep(after(MAX_CLOCK_GAP), MAX_CLOCK_GAP).unwrap();
    assert_eq!(rig.booth.find_clock_jump(after(MAX_CLOCK_GAP)).unwrap(), None);
    let late = after(MAX_CLOCK_GAP + MAX_CLOCK_STEP);
    rig.booth.sweep(late, MAX_CLOCK_STEP).unwrap();
    assert_eq!(rig.booth.find_clock_jump(late).unwrap(), None);
    let (second, jumped) = (Duration::from_secs(1), late.after(MAX_CLOCK_STEP));
    rig.booth.sweep(jumped.after(second), MAX_CLOCK_STEP).unwrap();
    assert!(rig.booth.find_clock_jump(jumped.after(second)).unwrap().is_some());
}

#[test]
fn a_confirmed_jump_withdraws_first_and_deletes_a_week_later() {
    let (rig, parcel) = booth_with_sculpture();
    let later = Parcel::new(2, None);
    let device = rig.booth.authenticate(&DeviceToken([1; 32])).unwrap();
    // The booth was switched off for 100 days. This sculpture arrives before an admin answers.
    rig.booth.sweep(days(100), MAX_CLOCK_GAP).unwrap();
    rig.upload(&device, &later, days(100)).unwrap();
    rig.booth.confirm_clock("ana", days(100)).unwrap();
    assert_eq!(rig.booth.find_clock_jump(days(100)).unwrap(), None);
    assert_eq!(rig.booth.list_audit(1).unwrap()[0].action, "confirm clock");
    let report = rig.sweep(days(100));
    assert_eq!((report.withdrawn, report.deleted), (1, 0));
    assert_eq!(rig.list(true)[0].id, parcel.id.0);
    let report = run(&rig, 101..=106);
    assert_eq!((report.withdrawn, report.deleted), (0, 0));
    assert_eq!(run(&rig, 107..=107).deleted, 1);
    assert_eq!(shown(&rig), 1);
    // The sculpture is kept for all of its 30 days, withdrawn in the last seven.
    let report = run(&rig, 108..=123);
    assert_eq!((report.withdrawn, report.deleted), (0, 0));
    assert_eq!(run(&rig, 124..=124).withdrawn, 1);
    assert_eq!(run(&rig, 125..=130).deleted, 0);
    assert_eq!(run(&rig, 131..=131).deleted, 1);
}

#[test]
fn a_clock_that_was_behind_makes_nothing_older() {
    let (rig, _) = booth_with_sculpture();
    let device = rig.booth.authenticate(&DeviceToken([1; 32])).unwrap();
    // A machine without a clock battery starts in 1970.
    let behind = BoothTime(60_000);
    rig.booth.sweep(behind, MAX_CLOCK_GAP).unwrap();
    assert!(rig.booth.find_clock_jump(behind).unwrap().is_some());
    rig.upload(&device, &Parcel::new(2, None), behind).unwrap();
    let report = run(&rig, 0..=23);
    assert_eq!((report.withdrawn, report.deleted), (0, 0));
    assert_eq!(shown(&rig), 2);
}

#[test]
fn a_wrong_answer_is_mended_by_another() {
    let (rig, parcel) = booth_with_sculpture();
    let device = rig.booth.authenticate(&DeviceToken([1; 32])).unwrap();
    rig.booth.confirm_clock("ana", days(YEARS)).unwrap();
    rig.upload(&device, &Parcel::new(2, None), days(YEARS)).unwrap();
    assert_eq!(rig.sweep(days(YEARS)).withdrawn, 1);
    // The clock is corrected.
    assert!(rig.booth.find_clock_jump(days(1)).unwrap().is_some());
    rig.booth.confirm_clock("ana", days(1)).unwrap();
    rig.booth.bring_back(&parcel.id, "ana", days(1)).expect("it isn't deleted");
    let report = run(&rig, 1..=23);
    assert_eq!((shown(&rig), report.deleted), (2, 0));
    assert_eq!(run(&rig, 24..=38).deleted, 2, "neither stays for years");
}
