//! The time that the booth has seen pass. Sculptures and traces age by it: a system clock that jumps deletes nothing.

use std::time::Duration;

use crate::audit::{Subject, note};
use crate::booth::{Booth, Tx};
use crate::limits::MAX_CLOCK_STEP;
use crate::records::SeenTime;
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::{BoothTime, DAY};

/// A jump of the system clock that no admin has confirmed yet.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct ClockJump {
    /// The time up to which the booth has seen the clock run.
    pub seen_at: BoothTime,
    /// The time that the clock shows.
    pub now: BoothTime,
}

impl Booth {
    /// Follows the clock, unless it jumped by more than `most`, forwards or backwards. Returns the time that the booth has
    /// seen pass, which is `now` unless the clock jumped.
    pub(crate) fn follow_clock(
        &self,
        now: BoothTime,
        most: Duration,
    ) -> Result<BoothTime, Refusal> {
        self.update(|tx| {
            let seen_at = seen_time(tx, now)?;
            if seen_at.distance(now) > most {
                return Ok(seen_at);
            }
            tx.put(&SeenTime { row: 0, seen_at: now })?;
            Ok(now)
        })
    }

    /// Returns the jump of the clock that waits for an admin's answer, if there is one.
    ///
    /// # Errors
    /// Store errors.
    pub fn find_clock_jump(&self, now: BoothTime) -> Result<Option<ClockJump>, Refusal> {
        let seen_at = self.view(|tx| seen_time(tx, now))?;
        Ok((seen_at.distance(now) > MAX_CLOCK_STEP).then_some(ClockJump { seen_at, now }))
    }

    /// Confirms that the clock is right. Sculptures age by the whole jump, except those that arrived after it.
    ///
    /// # Errors
    /// Store errors.
    pub fn confirm_clock(&self, account: &str, now: BoothTime) -> Result<(), Refusal> {
        self.update(|tx| {
            let seen_at = seen_time(tx, now)?;
            let days = i64::from(now.day()) - i64::from(seen_at.day());
            let arrived_since =
                "UPDATE sculptures SET keep_day = keep_day + ?1 WHERE received_at > ?2";
            tx.run(arrived_since, &[&days.cast_unsigned(), &seen_at.min(now)])?;
            // A clock that was ahead wrote times in the future.
            tx.run("UPDATE sculptures SET received_at = ?1 WHERE received_at > ?1", &[&now])?;
            tx.run("UPDATE sculptures SET withdrawn_at = ?1 WHERE withdrawn_at > ?1", &[&now])?;
            tx.put(&SeenTime { row: 0, seen_at: now })?;
            Ok(note(tx, now, Some(account), "confirm clock", Subject::default())?)
        })
    }
}

impl BoothTime {
    /// Returns the time between two times, whichever is the later.
    fn distance(self, other: BoothTime) -> Duration {
        self.since(other).max(other.since(self))
    }

    /// Returns the time `days` days earlier.
    pub(crate) fn days_before(self, days: u16) -> BoothTime {
        BoothTime(self.0.saturating_sub((DAY * u32::from(days)).as_millis() as u64))
    }
}

/// Returns the time that the booth has seen pass; `now` if it has looked at no clock yet.
pub(crate) fn seen_time(tx: &mut Tx<'_>, now: BoothTime) -> Result<BoothTime, StoreError> {
    Ok(tx.get::<SeenTime>(&[&0u8])?.map_or(now, |seen| seen.seen_at))
}
