//! Wall-clock timing: two sides run alternately, and the minimum of each counts.

use std::hint::black_box;
use std::time::Instant;

/// A value of ours and the rival's corresponding value.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct OursTheirs<T> {
    pub(super) ours: T,
    pub(super) theirs: T,
}

/// Returns the wall-clock time of `work` in milliseconds.
pub(super) fn time_ms<T>(work: impl FnOnce() -> T) -> f64 {
    let begun = Instant::now();
    black_box(work());
    begun.elapsed().as_secs_f64() * 1e3
}

/// Returns the minimum over `runs` runs of each side, in milliseconds. The runs alternate: ours, theirs,
/// ours, theirs. A run returns its own milliseconds, so that its set-up is not counted.
pub(super) fn min_in_turns_ms<E>(
    runs: usize,
    mut run_ours_ms: impl FnMut() -> Result<f64, E>,
    mut run_theirs_ms: impl FnMut() -> Result<f64, E>,
) -> Result<OursTheirs<f64>, E> {
    let mut best = OursTheirs { ours: f64::INFINITY, theirs: f64::INFINITY };
    for _ in 0..runs {
        best.ours = best.ours.min(run_ours_ms()?);
        best.theirs = best.theirs.min(run_theirs_ms()?);
    }
    Ok(best)
}

/// Like [`min_in_turns_ms`], for runs of many ticks: returns the minimum of each tick, in milliseconds.
pub(super) fn min_of_each_tick_ms(
    runs: usize,
    mut run_ours_ms: impl FnMut() -> Vec<f64>,
    mut run_theirs_ms: impl FnMut() -> Vec<f64>,
) -> OursTheirs<Vec<f64>> {
    let mut best = OursTheirs { ours: vec![], theirs: vec![] };
    for _ in 0..runs {
        let runs = [(&mut best.ours, run_ours_ms()), (&mut best.theirs, run_theirs_ms())];
        for (best, run) in runs {
            best.resize(run.len(), f64::INFINITY);
            for (best, tick) in best.iter_mut().zip(run) {
                *best = best.min(tick);
            }
        }
    }
    best
}
