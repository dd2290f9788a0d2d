//! The booth's clock.

use std::time::SystemTime;

use paros_booth_rules::BoothTime;

/// The time now.
#[must_use]
pub(crate) fn booth_time() -> BoothTime {
    let age = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    BoothTime(u64::try_from(age.as_millis()).unwrap_or(u64::MAX))
}
