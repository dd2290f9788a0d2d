//! Exhibitions of many seeds. `PAROS_SEED=N` runs one; `PAROS_SEED_BASE=N` says with which they begin,
//! `PAROS_SEEDS=N` how many there are; where `PAROS_SEED_SECONDS=S` is set, as many as fit, and no fewer than 2,000.

use std::num::NonZero;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread::{self, available_parallelism};
use std::time::{Duration, Instant};

use paros_tests_booth::badge_year::{YearPlan, YearSums, run_year};
use paros_tests_booth::exhibition::Exhibition;
use paros_tests_booth::truth::Truth;

/// What happens in an exhibition before all is well.
const ACTS: u32 = 250;

fn setting(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{name}={text}: expected a number")))
}

/// What came of some seeds.
#[derive(Default)]
struct Sums {
    seeds: u64,
    /// Sculptures of which a headset heard that the booth has them.
    heard: u64,
    /// Sculptures that a booth lost which came back from a backup, and that headsets sent again.
    returned: u64,
}

/// Runs one.
fn run(seed: u64) -> Sums {
    let mut exhibition = Exhibition::new(seed);
    if let Err(why) = catch_unwind(AssertUnwindSafe(|| exhibition.run(ACTS))) {
        eprintln!("{}", exhibition.log.join("\n"));
        eprintln!("again: PAROS_SEED={seed} cargo test -p paros-tests-booth --test simulation");
        resume_unwind(why);
    }
    let Truth { heard, to_return, .. } = exhibition.truth;
    Sums { seeds: 1, heard: u64::from(heard), returned: u64::from(to_return) }
}

/// Runs seeds until there are enough, on all processors.
fn run_all(base: u64, is_enough: impl Fn(u64) -> bool + Sync) -> Sums {
    let (next, has_failed) = (AtomicU64::new(0), AtomicBool::new(false));
    let work = || {
        let mut sums = Sums::default();
        loop {
            let count = next.fetch_add(1, Relaxed);
            if is_enough(count) || has_failed.load(Relaxed) {
                return sums;
            }
            let done = catch_unwind(|| run(base + count)).unwrap_or_else(|why| {
                has_failed.store(true, Relaxed);
                resume_unwind(why)
            });
            sums.seeds += 1;
            sums.heard += done.heard;
            sums.returned += done.returned;
        }
    };
    let threads = available_parallelism().map_or(1, NonZero::get);
    thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        let sums = threads
            .into_iter()
            .map(|thread| thread.join().unwrap_or_else(|why| resume_unwind(why)));
        sums.fold(Sums::default(), |a, b| Sums {
            seeds: a.seeds + b.seeds,
            heard: a.heard + b.heard,
            returned: a.returned + b.returned,
        })
    })
}

/// How many there are at the least where time is the limit, however slow the machine is.
const LEAST_SEEDS: u64 = 2_000;

#[test]
fn nothing_is_lost_whatever_happens() {
    if let Some(seed) = setting("PAROS_SEED") {
        run(seed);
        return;
    }
    let base = setting("PAROS_SEED_BASE").unwrap_or(1);
    let limit = setting("PAROS_SEED_SECONDS").map(Duration::from_secs);
    let most = setting("PAROS_SEEDS").unwrap_or(if limit.is_some() { u64::MAX } else { 150 });
    let began = Instant::now();
    let is_late = || limit.is_some_and(|limit| began.elapsed() >= limit);
    let is_done = |count| count >= most || count >= LEAST_SEEDS && is_late();
    let Sums { seeds, heard, returned } = run_all(base, is_done);
    let seconds = began.elapsed().as_secs_f32();
    println!(
        "{seeds} seeds from {base} in {seconds:.1} s: {heard} sculptures kept at the booth, \
         {returned} sent again after a restore"
    );
    // Otherwise nothing was tried.
    assert!(heard > seeds && returned > 0);
}

/// `PAROS_BADGE_YEAR=1` runs the whole year of 200 headsets with 50 visits a day.
#[test]
fn months_of_badges_lapse_none_that_came_in_time() {
    let is_whole = setting("PAROS_BADGE_YEAR").is_some();
    let plan = if is_whole {
        YearPlan { headsets: 200, days: 365, visits: 50, wiped_percent: 50 }
    } else {
        // As many blocks a day as there may be: all numbers are used once, and again.
        YearPlan { headsets: 240, days: 75, visits: 1, wiped_percent: 85 }
    };
    let sums = run_year(setting("PAROS_SEED_BASE").unwrap_or(1), plan);
    let YearSums { visits, provisional, .. } = sums;
    let share = 100.0 * provisional as f32 / visits as f32;
    println!("{plan:?}: {sums:?}, {share:.2} % provisional badges");
    assert!(sums.restores > 0 && sums.returned > 0 && sums.shown_again > 0);
}

#[test]
fn a_seed_replays() {
    let logs = [(); 2].map(|()| {
        let mut exhibition = Exhibition::new(7);
        exhibition.run(ACTS);
        exhibition.log.join("\n")
    });
    assert_eq!(logs[0], logs[1]);
    assert!(!logs[0].is_empty());
}
