//! Exhibitions of many seeds. `PAROS_SEED=N` runs one; `PAROS_SEED_BASE=N` says with which they begin,
//! `PAROS_SEEDS=N` how many there are; where `PAROS_SEED_SECONDS=S` is set, as many as fit, and no fewer than 2,000.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use paros_tests_booth::exhibition::Exhibition;

/// What happens in an exhibition before all is well.
const ACTS: u32 = 250;

fn setting(name: &str) -> Option<u64> {
    let text = std::env::var(name).ok()?;
    Some(text.parse().unwrap_or_else(|_| panic!("{name}={text}: expected a number")))
}

/// Runs one. Returns how many receipts were taken, and how many ids were given up.
fn run(seed: u64) -> (u32, u32) {
    let mut exhibition = Exhibition::new(seed);
    if let Err(why) = catch_unwind(AssertUnwindSafe(|| exhibition.run(ACTS))) {
        eprintln!("{}", exhibition.log.join("\n"));
        eprintln!("again: PAROS_SEED={seed} cargo test -p paros-tests-booth --test simulation");
        std::panic::resume_unwind(why);
    }
    (exhibition.truth.receipts, exhibition.truth.renewed)
}

#[test]
fn nothing_is_lost_whatever_happens() {
    if let Some(seed) = setting("PAROS_SEED") {
        run(seed);
        return;
    }
    let base = setting("PAROS_SEED_BASE").unwrap_or(1);
    let limit = setting("PAROS_SEED_SECONDS").map(Duration::from_secs);
    let count = setting("PAROS_SEEDS").unwrap_or(if limit.is_some() { u64::MAX } else { 150 });
    let (began, mut seeds, mut receipts, mut renewed) = (Instant::now(), 0, 0, 0);
    while seeds < count && limit.is_none_or(|limit| began.elapsed() < limit) {
        let (taken, given_up) = run(base + seeds);
        (receipts, renewed) = (receipts + taken, renewed + given_up);
        seeds += 1;
    }
    let seconds = began.elapsed().as_secs_f32();
    println!("{seeds} seeds from {base} in {seconds:.1} s: {receipts} receipts, {renewed} new ids");
    assert!(limit.is_none() || seeds >= 2000, "{seeds} seeds are too few");
    // Otherwise nothing was tried.
    assert!(u64::from(receipts) > seeds && renewed > 0);
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
