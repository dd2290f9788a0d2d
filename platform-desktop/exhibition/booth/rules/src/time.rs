//! The booth's time: an argument of whatever needs it.

use std::time::Duration;

use crate::value::field;

/// A day.
pub(crate) const DAY: Duration = Duration::from_secs(DAY_SECONDS);

const DAY_SECONDS: u64 = 86_400;

/// Milliseconds since the first of 1970, UTC, by the booth's clock.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub struct BoothTime(pub u64);

impl BoothTime {
    /// Whole seconds.
    #[must_use]
    pub const fn seconds(self) -> u64 {
        self.0 / 1000
    }

    /// Whole days.
    #[must_use]
    pub const fn day(self) -> u32 {
        let day = self.seconds() / DAY_SECONDS;
        if day > u32::MAX as u64 { u32::MAX } else { day as u32 }
    }

    /// The beginning of a day.
    #[must_use]
    pub const fn of_day(day: u32) -> Self {
        BoothTime(day as u64 * DAY_SECONDS * 1000)
    }

    /// So much later.
    #[must_use]
    pub fn after(self, duration: Duration) -> Self {
        let millis = u64::try_from(duration.as_millis()).unwrap_or(u64::MAX);
        BoothTime(self.0.saturating_add(millis))
    }

    /// How long ago that was; nothing where it is yet to come, as after the clock was set back.
    #[must_use]
    pub const fn since(self, earlier: BoothTime) -> Duration {
        Duration::from_millis(self.0.saturating_sub(earlier.0))
    }
}

// The latest time is later than all others in a database too, whose integers are signed.
field!(BoothTime as Number,
    this => i64::try_from(this.0).unwrap_or(i64::MAX),
    number => number.try_into().ok().map(BoothTime));
