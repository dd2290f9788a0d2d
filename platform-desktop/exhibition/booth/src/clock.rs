//! The booth's clock.

use std::time::SystemTime;

use paros_booth_rules::BoothTime;

/// The time now.
#[must_use]
pub(crate) fn booth_time() -> BoothTime {
    booth_time_of(SystemTime::now())
}

/// Returns a time of the system's clock as the booth counts it; 0 for a time before 1970.
#[must_use]
pub(crate) fn booth_time_of(time: SystemTime) -> BoothTime {
    let age = time.duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    BoothTime(u64::try_from(age.as_millis()).unwrap_or(u64::MAX))
}
