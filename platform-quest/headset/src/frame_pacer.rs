//! Frame pacing: turns the predicted display times of frames into ticks at a fixed rate.

use std::time::Duration;

use paros_core::session::TICK_RATE;

use paros_shell::tick_runner::{ClockTicks, TickClock};

/// Turns the predicted display times of frames into ticks. Times are the runtime's, in nanoseconds.
#[derive(Clone, Copy, Default, Debug)]
pub struct FramePacer {
    pace: TickClock,
    last_display_time_ns: Option<i64>,
}

/// The ticks that are due up to a frame's display time.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct DueTicks {
    /// The number of ticks; at most [`TickClock::MAX_TICKS_PER_FRAME`].
    pub count: u32,
    /// The number of further ticks that were due and are dropped.
    pub dropped: u32,
    /// The position of the display time between the last of the ticks and the next one, 0 to 1.
    pub fraction: f32,
    /// The time of the last of the ticks.
    last_time_ns: i64,
}

impl FramePacer {
    /// Returns the ticks between the previous frame and one with this display time.
    #[must_use]
    pub fn take_due_ticks_until(&mut self, display_time_ns: i64) -> DueTicks {
        let last = self.last_display_time_ns;
        let since = last.map_or(0, |last| display_time_ns.saturating_sub(last).max(0));
        self.last_display_time_ns =
            Some(last.map_or(display_time_ns, |last| last.max(display_time_ns)));
        let ClockTicks { due, dropped } =
            self.pace.take_due_ticks(Duration::from_nanos(since.cast_unsigned()));
        let fraction = self.pace.tick_fraction();
        let ago = f64::from(fraction) * 1e9 / f64::from(TICK_RATE);
        DueTicks { count: due, dropped, fraction, last_time_ns: display_time_ns - ago as i64 }
    }

    /// Pauses while no frames are made: the time until the next frame produces no ticks.
    pub fn pause(&mut self) {
        self.last_display_time_ns = None;
    }
}

impl DueTicks {
    /// Returns the time of each tick, the earliest first.
    pub fn tick_times_ns(&self) -> impl Iterator<Item = i64> + use<> {
        let DueTicks { count, last_time_ns, .. } = *self;
        let before = |ticks: u32| i64::from(ticks) * 1_000_000_000 / i64::from(TICK_RATE);
        (0..count).rev().map(move |left| last_time_ns - before(left))
    }
}

#[cfg(test)]
mod tests {
    use paros_core::session::TICK_RATE;

    use super::FramePacer;
    use paros_shell::tick_runner::TickClock;

    const TICK: i64 = 1_000_000_000 / TICK_RATE as i64;

    /// Returns display times of frames: `rate` a second, each off by at most `jitter` nanoseconds.
    fn display_times(rate: i64, jitter: i64) -> impl Iterator<Item = i64> {
        let mut dice = 12345u32;
        (0..rate * 3).map(move |i| {
            dice = dice.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let off = if jitter == 0 { 0 } else { i64::from(dice >> 8) % (2 * jitter) - jitter };
            1_000_000_000_000 + i * 1_000_000_000 / rate + off
        })
    }

    const CASES: [(i64, i64); 6] =
        [(60, 0), (72, 0), (90, 0), (120, 2_000_000), (72, 4_000_000), (20, 3_000_000)];

    #[test]
    fn ticks_are_a_72nd_of_a_second_apart_at_any_rate_of_frames() {
        for (rate, jitter) in CASES {
            let mut pacer = FramePacer::default();
            let mut last = None;
            let mut ticks = 0;
            for display_time_ns in display_times(rate, jitter) {
                let due = pacer.take_due_ticks_until(display_time_ns);
                assert_eq!(due.dropped, 0, "{rate} Hz");
                for at in due.tick_times_ns() {
                    assert!(at <= display_time_ns && display_time_ns - at < 5 * TICK, "{rate} Hz");
                    if let Some(last) = last.replace(at) {
                        assert!((at - last - TICK).abs() < 10, "{rate} Hz: {}", at - last);
                    }
                    ticks += 1;
                }
            }
            assert!((210..=216).contains(&ticks), "{rate} Hz: {ticks}");
        }
    }

    #[test]
    fn what_can_not_be_made_up_is_dropped_and_counted() {
        let mut pacer = FramePacer::default();
        assert_eq!(pacer.take_due_ticks_until(0).count, 0);
        let due = pacer.take_due_ticks_until(20 * TICK + 1000);
        assert_eq!(
            (due.count, due.dropped),
            (TickClock::MAX_TICKS_PER_FRAME, 20 - TickClock::MAX_TICKS_PER_FRAME)
        );
        // The ticks that are run are the latest ones.
        let first = due.tick_times_ns().next().expect("ticks");
        assert!((first - 17 * TICK).abs() < 2000);
        // Time that goes backwards produces no ticks, and is not counted twice.
        assert_eq!(pacer.take_due_ticks_until(10 * TICK).count, 0);
        assert_eq!(pacer.take_due_ticks_until(21 * TICK + 1000).count, 1);
        pacer.pause();
        let due = pacer.take_due_ticks_until(1000 * TICK);
        assert_eq!((due.count, due.dropped), (0, 0));
    }
}
