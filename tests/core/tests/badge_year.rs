//! A year of 200 headsets with 50 visits a day each: their data is wiped daily on half of them, headsets are
//! exchanged for spares and come back, messages are lost, and for a week there is no network at all.

use paros_core::badge::{BadgeLedger, DAY_SECONDS};
use paros_models::badge_fleet::{Fleet, FleetHeadset, Network};
use paros_models::random_visitor::RandomSource;

const HEADSETS: usize = 200;
const DAYS: u64 = 365;

/// Ten hours of ten minutes, in five of six of which a visit ends.
const SLOTS: u64 = 60;
const SLOT_SECONDS: u64 = 600;
const OPENING: u64 = 9 * 3600;

/// In the middle of the year, when as many numbers are kept as ever.
const WEEK_WITHOUT_NETWORK: std::ops::Range<u64> = 180..187;

/// A headset that was sent home, and the day on which it comes back with what it held then.
struct Absent {
    headset: FleetHeadset,
    back_on: u64,
}

struct Year {
    fleet: Fleet,
    headsets: Vec<FleetHeadset>,
    absent: Vec<Absent>,
    numbers: u32,
    dice: RandomSource,
}

impl Year {
    fn new() -> Self {
        let mut dice = RandomSource::new(365);
        let headsets = (0..HEADSETS as u32).map(|i| FleetHeadset::new(i, &mut dice)).collect();
        let numbers = HEADSETS as u32;
        Year { fleet: Fleet::new(), headsets, absent: Vec::new(), numbers, dice }
    }

    fn pass_day(&mut self, day: u64) {
        let opening = day * DAY_SECONDS + OPENING;
        let has_network = !WEEK_WITHOUT_NETWORK.contains(&day);
        // Every other headset is wiped, at a time of its own, mostly at night.
        let slots_of_a_day = DAY_SECONDS / SLOT_SECONDS;
        let wiped_in: Vec<_> =
            (0..HEADSETS).map(|i| (i % 2 == 0).then(|| self.dice.below(slots_of_a_day))).collect();
        for (i, headset) in self.headsets.iter_mut().enumerate() {
            if wiped_in[i].is_some_and(|slot| slot >= SLOTS) {
                headset.wipe(&mut self.dice);
            }
            // The others were on all night.
            if i % 3 != 0 {
                headset.restart();
            }
        }
        if day % 3 == 1 {
            self.exchange_headset(day, opening);
        }
        for slot in 0..SLOTS {
            for (i, wiped_in) in wiped_in.iter().enumerate() {
                let now = opening + slot * SLOT_SECONDS + i as u64 * 3;
                let is_wiped = *wiped_in == Some(slot);
                self.pass_slot(i, now, has_network, is_wiped, is_wiped || slot == 0);
            }
        }
    }

    /// Ten minutes of a headset: a wipe, a start of the app with its report, a visit with another. A network that
    /// works is busy at times.
    fn pass_slot(&mut self, i: usize, now: u64, has_network: bool, is_wiped: bool, is_start: bool) {
        let headset = &mut self.headsets[i];
        if is_wiped {
            headset.wipe(&mut self.dice);
        }
        if is_start && has_network {
            self.fleet.exchange(headset, now, Network::Works, &mut self.dice);
        }
        if self.dice.one_in(6) {
            return;
        }
        self.fleet.end_visit(headset, now, &mut self.dice);
        if has_network && !self.dice.one_in(4) {
            let network = match self.dice.below(20) {
                0 => Network::LosesReports,
                1 => Network::LosesAnswers,
                _ => Network::Works,
            };
            self.fleet.exchange(headset, now, network, &mut self.dice);
        }
    }

    /// One headset goes, and a spare takes its place: one that went some weeks ago, or a new one. What comes back shows
    /// a badge before anybody hears of it.
    fn exchange_headset(&mut self, day: u64, now: u64) {
        let found = self.absent.iter().position(|absent| absent.back_on <= day);
        let spare = if let Some(found) = found {
            let mut headset = self.absent.remove(found).headset;
            headset.restart();
            self.fleet.end_visit(&mut headset, now, &mut self.dice);
            headset
        } else {
            self.numbers += 1;
            FleetHeadset::new(self.numbers, &mut self.dice)
        };
        let place = self.dice.below(HEADSETS as u64) as usize;
        let headset = std::mem::replace(&mut self.headsets[place], spare);
        assert!(self.fleet.ledger.retire_headset(headset.number, now));
        self.absent.push(Absent { headset, back_on: day + 20 });
    }
}

#[test]
fn in_a_year_no_leased_badge_is_shown_twice_and_no_visit_ends_without_one() {
    let mut year = Year::new();
    let mut provisional_before = 0;
    let (mut of_the_week, mut kept_at_most) = (0, 0);
    for day in 0..DAYS {
        year.pass_day(day);
        let provisional = year.fleet.shown[1] - provisional_before;
        provisional_before = year.fleet.shown[1];
        if WEEK_WITHOUT_NETWORK.contains(&day) {
            of_the_week += provisional;
        } else {
            assert!(provisional < 100, "{provisional} provisional badges on day {day}");
        }
        let totals = year.fleet.ledger.totals();
        kept_at_most = kept_at_most.max(totals.kept + totals.resting);
    }
    let [leased, provisional] = year.fleet.shown;
    let visits = leased + provisional;
    let share = |count: u64| count as f64 * 100.0 / visits as f64;
    println!("{visits} visits, {:.2} % provisional", share(provisional));
    println!("{:.3} % outside the week without network", share(provisional - of_the_week));
    println!("{kept_at_most} numbers kept at most, now {:?}", year.fleet.ledger.totals());
    assert!(visits > 3_600_000);
    assert!(share(provisional) < 1.5 && share(provisional - of_the_week) < 0.02);
    assert_eq!(BadgeLedger::day_of(DAYS * DAY_SECONDS), DAYS as u32);
}
