//! Detects machines that are too slow: frames that take longer than the ticks a frame may run drop ticks, and
//! the studio's time passes slower than the visitor's.

use std::time::Duration;

use paros_shell::tick_runner::ClockTicks;

/// Length of a measured stretch.
const STRETCH: Duration = Duration::from_secs(3);

/// Longer frames are ignored: the machine slept, or the window was moved.
const PAUSE: Duration = Duration::from_secs(2);

/// Measured slowness of a machine.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Slowness {
    /// Frames drawn a second.
    frames_per_second: u32,
    /// Speed of the studio's time, in percent of real time.
    speed_percent: u32,
}

/// Measures frames in stretches of [`STRETCH`].
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct SlownessWatch {
    seen: Duration,
    frames: u32,
    due: u32,
    dropped: u32,
    verdict: Option<Slowness>,
    /// Number of consecutive slow stretches.
    slow_stretches: u32,
}

/// Slow stretches after which slowness is no longer reported: a visitor who can act on it has read it.
const TOLD_STRETCHES: u32 = 4;

impl SlownessWatch {
    /// Notes a frame, with the due and dropped ticks since the last one.
    pub(super) fn note_frame(&mut self, elapsed: Duration, ticks: ClockTicks) {
        if elapsed > PAUSE {
            let SlownessWatch { verdict, slow_stretches, .. } = *self;
            *self = SlownessWatch { verdict, slow_stretches, ..SlownessWatch::default() };
            return;
        }
        self.seen += elapsed;
        self.frames += 1;
        self.due += ticks.due;
        self.dropped += ticks.dropped;
        if self.seen >= STRETCH {
            // A few hitches are acceptable: slow is a tenth of the ticks dropped.
            let all = self.due + self.dropped;
            let verdict = (self.dropped * 10 > all).then(|| Slowness {
                frames_per_second: (f64::from(self.frames) / self.seen.as_secs_f64()).round()
                    as u32,
                speed_percent: 100 * self.due / all,
            });
            let slow_stretches = if verdict.is_some() { self.slow_stretches + 1 } else { 0 };
            *self = SlownessWatch { verdict, slow_stretches, ..SlownessWatch::default() };
        }
    }

    /// Returns the slowness of the last whole stretch, while it is still to be reported.
    pub(super) fn verdict(&self) -> Option<Slowness> {
        self.verdict.filter(|_| self.slow_stretches <= TOLD_STRETCHES)
    }
}

impl Slowness {
    /// Returns a line that describes the slowness, and the remedies that aren't in use yet.
    pub(super) fn describe_with_help(self, is_fast_path: bool, grid_side: usize) -> String {
        let mut helps = Vec::new();
        if !is_fast_path {
            helps.push("the fast path (F3)");
        }
        helps.push("a smaller window");
        if grid_side > 128 {
            helps.push("--size 128");
        }
        let Slowness { frames_per_second, speed_percent } = self;
        let pictures = if frames_per_second == 1 { "picture" } else { "pictures" };
        format!(
            "too slow: {frames_per_second} {pictures} a second, tools at {speed_percent} % of their speed. \
             What helps: {}",
            helps.join(", ")
        )
    }
}

#[cfg(test)]
mod tests {
    use paros_shell::tick_runner::TickClock;

    use super::*;

    fn verdict_at(frames_per_second: u32, frames: u32) -> Option<Slowness> {
        let (mut clock, mut watch) = (TickClock::default(), SlownessWatch::default());
        let elapsed = Duration::from_secs(1) / frames_per_second;
        for _ in 0..frames {
            watch.note_frame(elapsed, clock.take_due_ticks(elapsed));
        }
        watch.verdict()
    }

    #[test]
    fn fewer_than_eighteen_pictures_a_second_are_too_slow() {
        let slow = Slowness { frames_per_second: 9, speed_percent: 50 };
        assert_eq!(verdict_at(9, 40), Some(slow));
        assert_eq!([18, 30, 72].map(|rate| verdict_at(rate, 400)), [None; 3]);
        assert_eq!(verdict_at(9, 20), None, "not before a stretch is seen");
        assert_eq!(verdict_at(9, 9 * 13), Some(slow), "for twelve seconds");
        assert_eq!(verdict_at(9, 9 * 17), None, "it was read by then");
    }

    #[test]
    fn a_hitch_is_not_slow_and_a_machine_that_keeps_up_again_is_said_no_more() {
        let (mut clock, mut watch) = (TickClock::default(), SlownessWatch::default());
        let mut frames = |watch: &mut SlownessWatch, rate: u32, count: u32| {
            for _ in 0..count {
                let elapsed = Duration::from_secs(1) / rate;
                watch.note_frame(elapsed, clock.take_due_ticks(elapsed));
            }
            watch.verdict().is_some()
        };
        assert!(!frames(&mut watch, 72, 100));
        watch.note_frame(Duration::from_secs(60), ClockTicks { due: 4, dropped: 4316 });
        assert!(!frames(&mut watch, 5, 1) && !frames(&mut watch, 72, 600));
        assert!(frames(&mut watch, 6, 40));
        assert!(!frames(&mut watch, 72, 600));
    }

    #[test]
    fn what_helps_is_what_is_not_done_already() {
        let slow = Slowness { frames_per_second: 9, speed_percent: 50 };
        let text = slow.describe_with_help(true, 128);
        assert!(text.starts_with("too slow: 9 pictures a second"), "{text}");
        assert!(text.ends_with("What helps: a smaller window"), "{text}");
        let text = slow.describe_with_help(false, 256);
        assert!(text.ends_with("the fast path (F3), a smaller window, --size 128"), "{text}");
    }
}
