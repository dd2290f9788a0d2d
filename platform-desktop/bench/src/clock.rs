//! Wall-clock timing: two sides in alternating runs, of which the minimum counts.

use std::hint::black_box;
use std::time::Instant;

/// The wall-clock time of `work` in milliseconds.
pub(super) fn time_ms<T>(work: impl FnOnce() -> T) -> f64 {
    let begun = Instant::now();
    black_box(work());
    begun.elapsed().as_secs_f64() * 1e3
}

/// The minimum over `runs` runs of each side, in milliseconds. Runs alternate: ours, theirs, ours,
/// theirs. A run returns its own milliseconds, so that its set-up is not counted.
pub(super) fn best_in_turns_ms<E>(
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

/// As [`best_in_turns_ms`] for runs of many ticks: the minimum of each tick, in milliseconds.
pub(super) fn best_ticks_ms(
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
