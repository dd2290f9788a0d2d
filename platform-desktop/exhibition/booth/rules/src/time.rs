//! The booth's time. Functions take it as an argument instead of reading a clock.

use std::time::Duration;

use crate::value::field;

/// A day.
pub(crate) const DAY: Duration = Duration::from_secs(DAY_SECONDS);

const DAY_SECONDS: u64 = 86_400;

/// Milliseconds since 1 January 1970, UTC, by the booth's clock.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub struct BoothTime(pub u64);

impl BoothTime {
    /// Returns the whole seconds since 1970.
    #[must_use]
    pub const fn seconds(self) -> u64 {
        self.0 / 1000
    }

    /// Returns the whole days since 1970.
    #[must_use]
    pub const fn day(self) -> u32 {
        let day = self.seconds() / DAY_SECONDS;
        if day > u32::MAX as u64 { u32::MAX } else { day as u32 }
    }

    /// Returns the beginning of a day.
    #[must_use]
    pub const fn of_day(day: u32) -> Self {
        BoothTime(day as u64 * DAY_SECONDS * 1000)
    }

    /// Returns the time later by a duration.
    #[must_use]
    pub fn after(self, duration: Duration) -> Self {
        let millis = u64::try_from(duration.as_millis()).unwrap_or(u64::MAX);
        BoothTime(self.0.saturating_add(millis))
    }

    /// Returns the duration since an earlier time; zero if that time is in the future, such as after the
    /// clock was set back.
    #[must_use]
    pub const fn since(self, earlier: BoothTime) -> Duration {
        Duration::from_millis(self.0.saturating_sub(earlier.0))
    }
}

// Saturates: the integers of databases are signed, and the latest time must remain the latest.
field!(BoothTime as Number,
    this => i64::try_from(this.0).unwrap_or(i64::MAX),
    number => number.try_into().ok().map(BoothTime));
