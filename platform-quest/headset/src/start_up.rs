//! The start of the app. After failed starts it waits, then it loads, and it is ready with the first frame of
//! the studio; a failure is shown long enough to be read. If starts fail repeatedly, for instance because a
//! kiosk's management relaunches the app at once, the pauses between them grow.
//!
//! All times are since boot, sleep included.

mod failed_starts;

use std::time::Duration;

pub use failed_starts::FailedStarts;

use paros_shell::last_use::BootId;

/// The time for which the cause of a failed start is shown.
pub const FAILURE_SHOWN: Duration = Duration::from_secs(15);

/// The maximum delay of the activity's destruction, in which the studio is saved and its session ended.
/// Android kills a program that takes five seconds.
pub const DESTRUCTION_PATIENCE: Duration = Duration::from_secs(4);

/// The number of steps in a turn of the loading ring, and the time of each.
pub const RING_STEPS: u32 = 12;
const RING_STEP: Duration = Duration::from_millis(100);

/// The state of a start.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StartUp {
    /// Starts have failed a short while ago: this start is delayed.
    Waiting {
        /// The time at which it begins to load.
        until: Duration,
    },
    /// Shader programs are being compiled.
    Loading {
        /// The time at which loading began.
        since: Duration,
    },
    /// The first frame of the studio has been drawn.
    Ready,
    /// The start has failed, and the cause is shown.
    Failed {
        /// The time until which the cause is shown.
        until: Duration,
    },
    /// The failure has been shown: the app ends.
    Over,
}

impl StartUp {
    /// Begins a start at the time `now`; it is delayed if previous starts have failed.
    #[must_use]
    pub fn begin(failed: Option<FailedStarts>, boot: Option<BootId>, now: Duration) -> Self {
        match failed.and_then(|failed| failed.next_start(boot?, now)) {
            Some(until) => StartUp::Waiting { until },
            None => StartUp::Loading { since: now },
        }
    }

    /// Returns the state after the time `now` is reached, without other events.
    #[must_use]
    pub fn after_time(self, now: Duration) -> Self {
        match self {
            StartUp::Waiting { until } if now >= until => StartUp::Loading { since: now },
            StartUp::Failed { until } if now >= until => StartUp::Over,
            other => other,
        }
    }

    /// Returns the state after an error. An error after the first frame isn't a failed start.
    #[must_use]
    pub fn after_error(self, now: Duration) -> Self {
        match self {
            StartUp::Waiting { .. } | StartUp::Loading { .. } => {
                StartUp::Failed { until: now + FAILURE_SHOWN }
            }
            other => other,
        }
    }

    /// Returns the notice to show in this state. `cause` is the cause of the failure.
    #[must_use]
    pub fn notice(self, cause: &str, now: Duration) -> Option<StartNotice> {
        let seconds_until = |until: Duration| {
            let left = until.saturating_sub(now);
            // Round up: the last second is shown until it is over.
            left.as_secs() + u64::from(left.subsec_nanos() > 0)
        };
        match self {
            StartUp::Waiting { until } => {
                Some(StartNotice::Waiting { seconds: seconds_until(until) })
            }
            StartUp::Loading { since } => {
                let steps = now.saturating_sub(since).as_millis() / RING_STEP.as_millis();
                Some(StartNotice::Loading { step: (steps % u128::from(RING_STEPS)) as u32 })
            }
            StartUp::Failed { until } => {
                Some(StartNotice::Failed { cause: cause.into(), seconds: seconds_until(until) })
            }
            StartUp::Ready | StartUp::Over => None,
        }
    }
}

/// The notice that is shown before there is a studio.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum StartNotice {
    /// The studio is loading.
    Loading {
        /// The step of the ring's turn, below [`RING_STEPS`].
        step: u32,
    },
    /// The start has failed.
    Failed {
        /// The cause.
        cause: String,
        /// Seconds until the app ends.
        seconds: u64,
    },
    /// Previous starts have failed.
    Waiting {
        /// Seconds until the next start.
        seconds: u64,
    },
}

/// Returns `true` if a destroyed activity's main function may return, which lets Android's call return.
/// Without a studio it may return at once; otherwise after the studio is saved (`has_ended`), or after
/// [`DESTRUCTION_PATIENCE`].
#[must_use]
pub fn may_leave_destroyed(destroyed_for: Duration, has_studio: bool, has_ended: bool) -> bool {
    has_ended || !has_studio || destroyed_for >= DESTRUCTION_PATIENCE
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{
        BootId, DESTRUCTION_PATIENCE, FAILURE_SHOWN, FailedStarts, RING_STEPS, StartNotice,
        StartUp, may_leave_destroyed,
    };

    const BOOT: BootId = BootId::from_count(7);

    const fn seconds(count: u64) -> Duration {
        Duration::from_secs(count)
    }

    #[test]
    fn a_start_loads_and_is_ready() {
        let start = StartUp::begin(None, Some(BOOT), seconds(100));
        assert_eq!(start, StartUp::Loading { since: seconds(100) });
        // Loading has no timeout.
        assert_eq!(start.after_time(seconds(10_000)), start);
        assert_eq!(StartUp::Ready.after_error(seconds(200)), StartUp::Ready);
        assert_eq!(StartUp::Ready.notice("", seconds(200)), None);
    }

    #[test]
    fn a_failure_is_shown_and_the_next_start_waits() {
        let start = StartUp::begin(None, Some(BOOT), seconds(100)).after_error(seconds(103));
        let until = seconds(103) + FAILURE_SHOWN;
        assert_eq!(start, StartUp::Failed { until });
        assert_eq!(start.after_time(until - seconds(1)), start);
        assert_eq!(start.after_time(until), StartUp::Over);
        assert_eq!(start.after_error(seconds(110)), start, "it is shown once");

        let failed = FailedStarts::after_failure(None, BOOT, until);
        let again = StartUp::begin(Some(failed), Some(BOOT), until);
        assert_eq!(again, StartUp::Waiting { until: until + seconds(1) });
        let loads = again.after_time(until + seconds(1));
        assert_eq!(loads, StartUp::Loading { since: until + seconds(1) });
        // Without a boot identifier the time since the failure is unknown.
        assert_eq!(StartUp::begin(Some(failed), None, until), StartUp::Loading { since: until });
    }

    #[test]
    fn notices_tell_the_seconds_left_and_the_ring_turns() {
        let waiting = StartUp::Waiting { until: seconds(108) };
        let at = |millis| waiting.notice("", Duration::from_millis(millis));
        assert_eq!(at(100_000), Some(StartNotice::Waiting { seconds: 8 }));
        assert_eq!(at(100_001), Some(StartNotice::Waiting { seconds: 8 }));
        assert_eq!(at(107_999), Some(StartNotice::Waiting { seconds: 1 }));
        let failed = StartUp::Failed { until: seconds(108) }.notice("no room", seconds(101));
        assert_eq!(failed, Some(StartNotice::Failed { cause: "no room".into(), seconds: 7 }));
        let loading = StartUp::Loading { since: seconds(5) };
        let step = |millis| loading.notice("", seconds(5) + Duration::from_millis(millis));
        assert_eq!(step(0), Some(StartNotice::Loading { step: 0 }));
        assert_eq!(step(250), Some(StartNotice::Loading { step: 2 }));
        let last = RING_STEPS - 1;
        assert_eq!(step(100 * u64::from(last)), Some(StartNotice::Loading { step: last }));
        assert_eq!(step(100 * u64::from(RING_STEPS)), Some(StartNotice::Loading { step: 0 }));
    }

    #[test]
    fn a_destroyed_activity_waits_for_a_studio_alone() {
        assert!(may_leave_destroyed(Duration::ZERO, false, false), "there is nothing to save");
        assert!(!may_leave_destroyed(seconds(1), true, false));
        assert!(may_leave_destroyed(seconds(1), true, true));
        assert!(may_leave_destroyed(DESTRUCTION_PATIENCE, true, false));
    }
}
