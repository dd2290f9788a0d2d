//! Runs simulated exhibitions of many seeds. `PAROS_SEED=N` runs one seed. `PAROS_SEED_BASE=N` is the first
//! seed and `PAROS_SEEDS=N` the number of seeds. `PAROS_SEED_SECONDS=S` sets a time limit instead, with at
//! least 2,000 seeds.

use std::num::NonZero;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering::Relaxed};
use std::thread::{self, available_parallelism};
use std::time::{Duration, Instant};

use paros_tests_booth::badge_year::{YearPlan, YearSums, run_year};
use paros_tests_booth::exhibition::Exhibition;
use paros_tests_booth::truth::Truth;

/// Number of random actions in an exhibition before all faults are healed.
const ACTS: u32 = 250;

fn setting(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{name}={text}: expected a number")))
}

/// The sums over some seeds.
#[derive(Default)]
struct Sums {
    seeds: u64,
    /// Sculptures that a headset knows to be at the booth.
    heard: u64,
    /// Sculptures lost in a restore of the booth and sent again by headsets.
    returned: u64,
}

/// Runs one seed.
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

/// Runs seeds on all processors until there are enough.
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

/// The minimum number of seeds under a time limit, however slow the machine is.
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
    // Ensures that the simulations exercised uploads and restores.
    assert!(heard > seeds && returned > 0);
}

/// Simulates months of badges. `PAROS_BADGE_YEAR=1` runs a whole year of 200 headsets with 50 visits a day.
#[test]
fn months_of_badges_lapse_none_that_came_in_time() {
    let is_whole = setting("PAROS_BADGE_YEAR").is_some();
    let plan = if is_whole {
        YearPlan { headsets: 200, days: 365, visits: 50, wiped_percent: 50 }
    } else {
        // Leases the most blocks a day that are possible, so that all numbers are used and reused.
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
