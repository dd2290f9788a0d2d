//! The number of random cases: few in the check, many at night. `PAROS_STEP_CASES` multiplies it.

use proptest::prelude::ProptestConfig;

/// Returns `in_check` times `PAROS_STEP_CASES`, which is 1 by default.
///
/// # Panics
/// The environment variable is no number.
pub fn scaled_cases(in_check: u32) -> u32 {
    let times = std::env::var("PAROS_STEP_CASES");
    in_check * times.map_or(1, |times| times.parse().expect("PAROS_STEP_CASES: a number"))
}

/// Returns the configuration of a property test with `in_check` cases in the check. No file keeps a failure: its
/// message says the case, and the seed gives it again.
pub fn random_cases(in_check: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(scaled_cases(in_check))
    }
}

/// Returns `in_check` divided by `PAROS_STEP_CASES`, at least 1: one case of so many runs.
///
/// # Panics
/// As [`scaled_cases`].
pub fn scaled_step(in_check: u32) -> u32 {
    (in_check / scaled_cases(1)).max(1)
}

/// Returns every `step`th of `all` in the check; with `PAROS_STEP_CASES` as great as `step` all of them.
pub fn sample_cases<T>(all: impl IntoIterator<Item = T>, step: u32) -> impl Iterator<Item = T> {
    all.into_iter().step_by(scaled_step(step) as usize)
}
