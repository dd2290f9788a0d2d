//! A booth whose ledger comes back from a copy: what was handed out since the copy is never handed out again while a
//! sculpture with it may be kept. [`Fleet`] fails where it is.

use paros_core::badge::{BadgeLedger, DAY_SECONDS, LEASED_NUMBERS};
use paros_core::limits::RESTORE_BLOCKS;
use paros_models::badge_fleet::{Fleet, FleetHeadset, Network, RETENTION_DAYS};
use paros_models::random_visitor::RandomSource;

const OPENING: u64 = 9 * 3600;

/// Which day of the fleet's a time is on.
const fn opening(day: u64) -> u64 {
    (1000 + day) * DAY_SECONDS + OPENING
}

/// A day on which each headset shows a badge every ten minutes, some messages are lost, and some headsets are wiped.
fn pass_day(fleet: &mut Fleet, headsets: &mut [FleetHeadset], day: u64, dice: &mut RandomSource) {
    for slot in 0..40 {
        for (i, headset) in headsets.iter_mut().enumerate() {
            let now = opening(day) + slot * 601 + i as u64 * 3;
            if dice.one_in(60) {
                headset.wipe(dice);
            }
            fleet.end_visit(headset, now, dice);
            let network = match dice.below(12) {
                0 => Network::LosesReports,
                1 => Network::LosesAnswers,
                _ => Network::Works,
            };
            fleet.exchange(headset, now, network, dice);
        }
    }
}

#[test]
fn copies_of_any_age_come_back_and_no_number_is_shown_twice() {
    let mut dice = RandomSource::new(77);
    let mut fleet = Fleet::new();
    let mut headsets: Vec<_> = (0..60).map(|i| FleetHeadset::new(i, &mut dice)).collect();
    let mut copies = Vec::new();
    let mut of_copies = 0;
    for day in 0..120 {
        pass_day(&mut fleet, &mut headsets, day, &mut dice);
        copies.push((fleet.copy_ledger(), opening(day) + DAY_SECONDS / 2));
        if dice.one_in(20) {
            let age = dice.below(3.min(day + 1)) as usize + 1;
            // Before the next day's first visit.
            let (copy, copied_at) = &copies[copies.len() - age];
            fleet.restore((copy, *copied_at), opening(day + 1) - 60);
            of_copies += 1;
        }
    }
    let [leased, provisional] = fleet.shown;
    println!("{of_copies} restored, {leased} leased badges, {provisional} provisional");
    assert!(of_copies >= 3 && provisional * 3 < leased, "it leases still");
}

/// As many blocks as a day allows are handed out after the copy, by wipes; none of them comes again.
#[test]
fn all_that_a_day_can_hand_out_is_in_doubt() {
    let mut dice = RandomSource::new(78);
    for days in [0, 1, 2] {
        let mut fleet = Fleet::new();
        let mut headsets: Vec<_> = (0..60).map(|i| FleetHeadset::new(i, &mut dice)).collect();
        let copy = fleet.copy_ledger();
        for slot in 0..=days * 144 + 80 {
            for (i, headset) in headsets.iter_mut().enumerate() {
                headset.wipe(&mut dice);
                let now = opening(0) - OPENING + slot * 601 + i as u64;
                fleet.exchange(headset, now, Network::Works, &mut dice);
                fleet.end_visit(headset, now, &mut dice);
            }
        }
        let now = opening(days) + 6 * 3600;
        fleet.restore((&copy, opening(0) - OPENING), now);
        let totals = fleet.ledger.totals();
        assert!(totals.kept >= LEASED_NUMBERS / 40 && totals.held == 0, "{totals:?}");
        for (i, headset) in headsets.iter_mut().enumerate() {
            headset.wipe(&mut dice);
            fleet.exchange(headset, now + 700 + i as u64, Network::Works, &mut dice);
            while headset.lease.left() > 0 {
                headset.lease.pass_time(10_000);
                fleet.end_visit(headset, now + 800, &mut dice);
            }
        }
        assert!(fleet.shown[0] > 9000, "{:?}", fleet.shown);
    }
}

/// A headset that wasn't there when the copy came back shows what it holds, a day before its sculptures would be gone.
#[test]
fn who_was_away_still_has_its_numbers() {
    let mut dice = RandomSource::new(79);
    let mut fleet = Fleet::new();
    let copy = fleet.copy_ledger();
    let mut away = FleetHeadset::new(1, &mut dice);
    fleet.exchange(&mut away, opening(0), Network::Works, &mut dice);
    fleet.restore((&copy, opening(0)), opening(0) + 60);
    let back = u64::from(RETENTION_DAYS);
    let shown = fleet.end_visit(&mut away, opening(back), &mut dice);
    assert!(!shown.is_provisional());
    for (day, is_free) in [(2 * back, false), (2 * back + 1, true)] {
        let mut other = FleetHeadset::new(2, &mut dice);
        fleet.exchange(&mut other, opening(day), Network::Works, &mut dice);
        assert_eq!(fleet.ledger.is_free(shown), is_free, "day {day}");
    }
    fleet.exchange(&mut away, opening(back), Network::Works, &mut dice);
    assert_eq!(away.lease.left(), 0, "its lease is void");
}

#[test]
fn an_old_copy_or_a_clock_that_is_behind_leaves_nothing_to_hand_out() {
    for (copied_on, restored_on) in [(0, 14), (1, 0)] {
        let mut ledger = Box::new(BadgeLedger::new(RETENTION_DAYS));
        ledger.begin_generation(opening(copied_on), opening(restored_on));
        let totals = ledger.totals();
        assert_eq!((totals.free, totals.kept), (0, LEASED_NUMBERS));
        // Until nothing of it can be kept.
        let free_on = restored_on + 2 * u64::from(RETENTION_DAYS) + 1;
        ledger.retire_headset(1, opening(free_on));
        assert_eq!(ledger.totals().free, LEASED_NUMBERS);
    }
    // On the day of the copy there are a restore's turns.
    let mut fleet = Fleet::new();
    fleet.restore((&fleet.copy_ledger(), opening(0)), opening(0));
    let mut dice = RandomSource::new(80);
    for i in 0..250 {
        let mut headset = FleetHeadset::new(i, &mut dice);
        fleet.exchange(&mut headset, opening(0), Network::Works, &mut dice);
    }
    assert_eq!(fleet.ledger.totals().held, 250 * 3 * 64, "reserves of all");
    const { assert!(250 * 3 < RESTORE_BLOCKS) };
}
