//! How the app starts: after failed starts it waits, then it loads, and it is ready with the first frame of the
//! studio, or the failure is shown for as long as it takes to read it. Starts that failed one after the other, as where
//! a kiosk's management launches the app again at once, are further and further apart.
//!
//! Times are those since boot, sleep included.

mod failed_starts;

use std::time::Duration;

pub use failed_starts::FailedStarts;

use paros_shell::last_use::BootId;

/// For how long the cause of a failed start is shown.
pub const FAILURE_SHOWN: Duration = Duration::from_secs(15);

/// How long Android's destruction of the activity may wait for a studio to be saved and its session to be ended.
/// Android kills a program that takes five seconds.
pub const DESTRUCTION_PATIENCE: Duration = Duration::from_secs(4);

/// Steps in which the loading picture's ring turns round, and how long each is shown.
pub const RING_STEPS: u32 = 12;
const RING_STEP: Duration = Duration::from_millis(100);

/// Where a start stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StartUp {
    /// Starts have failed a short while ago: the next one waits until then.
    Waiting {
        /// When it begins.
        until: Duration,
    },
    /// Programs are compiled.
    Loading {
        /// When it began.
        since: Duration,
    },
    /// The studio has been drawn.
    Ready,
    /// It has failed, which is shown until then.
    Failed {
        /// When it has been shown for long enough.
        until: Duration,
    },
    /// The failure has been shown: the app ends.
    Over,
}

impl StartUp {
    /// A start at a time, after those that have failed, if any did.
    #[must_use]
    pub fn begin(failed: Option<FailedStarts>, boot: Option<BootId>, now: Duration) -> Self {
        match failed.and_then(|failed| failed.next_start(boot?, now)) {
            Some(until) => StartUp::Waiting { until },
            None => StartUp::Loading { since: now },
        }
    }

    /// Goes on to what comes with time alone.
    #[must_use]
    pub fn after_time(self, now: Duration) -> Self {
        match self {
            StartUp::Waiting { until } if now >= until => StartUp::Loading { since: now },
            StartUp::Failed { until } if now >= until => StartUp::Over,
            other => other,
        }
    }

    /// Goes on after an error. One that comes after the first frame is none of the start's.
    #[must_use]
    pub fn after_error(self, now: Duration) -> Self {
        match self {
            StartUp::Waiting { .. } | StartUp::Loading { .. } => {
                StartUp::Failed { until: now + FAILURE_SHOWN }
            }
            other => other,
        }
    }

    /// The notice that is seen meanwhile. `cause` is that of the failure.
    #[must_use]
    pub fn notice(self, cause: &str, now: Duration) -> Option<StartNotice> {
        let seconds_until = |until: Duration| {
            let left = until.saturating_sub(now);
            // The last second is told until it is over.
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

/// What is seen before there is a studio.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum StartNotice {
    /// The studio is on its way.
    Loading {
        /// How far the ring has turned, below [`RING_STEPS`].
        step: u32,
    },
    /// The start has failed.
    Failed {
        /// Why.
        cause: String,
        /// Seconds until the app ends.
        seconds: u64,
    },
    /// The starts before have failed.
    Waiting {
        /// Seconds until the next one.
        seconds: u64,
    },
}

/// Whether a destroyed activity's main function is to return, upon which the system's call does: at once while there
/// is no studio, whatever is under way, else once it is saved (`has_ended`), or after a while.
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
        // Loading ends with its work, however long that takes.
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
        // Without a boot nobody knows how long ago it was.
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
