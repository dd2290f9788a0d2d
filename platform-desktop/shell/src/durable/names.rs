//! The names of temporary files, and the age at which they are stale.

use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// The age at which a temporary file counts as stale: longer than the slowest disk takes. If a file
/// still being written were removed, its rename would fail with an error and it would be written again.
pub(super) const MAX_TEMPORARY_AGE: Duration = Duration::from_secs(60 * 60);

/// Returns a temporary file name that no other process uses. It is not derived from the target's name, which
/// may have the greatest length allowed.
#[must_use]
pub fn temporary_name() -> String {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    format!(".paros-{}-{number}.part", std::process::id())
}

/// Returns `true` if [`temporary_name`] could have made the name.
pub(super) fn is_temporary_name(name: &str) -> bool {
    let numbers = name.strip_prefix(".paros-").and_then(|rest| rest.strip_suffix(".part"));
    numbers.and_then(|numbers| numbers.split_once('-')).is_some_and(|(process, number)| {
        [process, number].iter().all(|number| number.parse::<u32>().is_ok())
    })
}
