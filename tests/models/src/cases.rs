//! The number of random cases: few in the check, many in the nightly run. `PAROS_STEP_CASES` multiplies it.

use proptest::prelude::ProptestConfig;

/// Returns `in_check` times `PAROS_STEP_CASES`, which is 1 by default.
///
/// # Panics
/// The environment variable isn't a number.
pub fn scaled_cases(in_check: u32) -> u32 {
    let times = std::env::var("PAROS_STEP_CASES");
    in_check * times.map_or(1, |times| times.parse().expect("PAROS_STEP_CASES: a number"))
}

/// Returns the configuration of a property test with `in_check` cases in the check. Failures aren't stored in
/// a file: the message contains the case, and the seed reproduces it.
pub fn random_cases(in_check: u32) -> ProptestConfig {
    ProptestConfig {
        failure_persistence: None,
        ..ProptestConfig::with_cases(scaled_cases(in_check))
    }
}

/// Returns `in_check` divided by `PAROS_STEP_CASES`, at least 1: the step by which a test samples its cases.
///
/// # Panics
/// As [`scaled_cases`].
pub fn scaled_step(in_check: u32) -> u32 {
    (in_check / scaled_cases(1)).max(1)
}

/// Returns every `step`th item of `all` in the check, and every item if `PAROS_STEP_CASES` is at least
/// `step`.
pub fn sample_cases<T>(all: impl IntoIterator<Item = T>, step: u32) -> impl Iterator<Item = T> {
    all.into_iter().step_by(scaled_step(step) as usize)
}
