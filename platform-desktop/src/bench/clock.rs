//! Two sides take turns, and the best run of each counts.

use std::hint::black_box;
use std::time::Instant;

/// Milliseconds that some work takes.
pub(super) fn timed<T>(work: impl FnOnce() -> T) -> f64 {
    let begun = Instant::now();
    black_box(work());
    begun.elapsed().as_secs_f64() * 1e3
}

/// The best of `runs` runs of each side, taken in turns: ours, theirs, ours, theirs. Each run
/// tells its own milliseconds, so that what comes before and after is not counted.
pub(super) fn duel<E>(
    runs: usize,
    mut ours: impl FnMut() -> Result<f64, E>,
    mut theirs: impl FnMut() -> Result<f64, E>,
) -> Result<[f64; 2], E> {
    let mut best = [f64::INFINITY; 2];
    for _ in 0..runs {
        best[0] = best[0].min(ours()?);
        best[1] = best[1].min(theirs()?);
    }
    Ok(best)
}

/// Where a run is a row of ticks: each tick of each side at its best.
pub(super) fn best_ticks(
    runs: usize,
    mut ours: impl FnMut() -> Vec<f64>,
    mut theirs: impl FnMut() -> Vec<f64>,
) -> [Vec<f64>; 2] {
    let mut best: [Vec<f64>; 2] = Default::default();
    for _ in 0..runs {
        for (best, run) in best.iter_mut().zip([ours(), theirs()]) {
            best.resize(run.len(), f64::INFINITY);
            for (best, tick) in best.iter_mut().zip(run) {
                *best = best.min(tick);
            }
        }
    }
    best
}
