//! Dynamic resolution: scales the sides of the eyes' images from 0.85 to 1.0 by the GPU times of whole
//! frames, or as the runtime recommends (`XR_META_recommended_layer_resolution`).
//!
//! The policy takes GPU times and the frame's period, and returns a scale and a rectangle; it knows no
//! swapchain. A frame's time has a fixed part and a part in proportion to its pixels. So its time at another
//! scale lies between its current time and that time multiplied by the ratio of the pixels. The scale is
//! lowered from `LOWERED_SHARE` of the period on, and raised only if even the larger estimate is within
//! `RAISED_SHARE`. As `RAISED_SHARE` is the smaller one, a steady load never makes the scale oscillate.

use std::time::Duration;

/// The least scale of a side, in percent: below 85, edges visibly swim, according to Meta.
pub const LEAST_PERCENT: u32 = 85;

/// The step of the scale, in percent of a side.
const STEP_PERCENT: u32 = 5;

/// Frames per decision: an eighth of a second at 72 frames a second, so that three steps, the most that are
/// possible, take less than half a second.
const WINDOW_FRAMES: usize = 9;

/// Frames of a window that may exceed the limit: a single long frame, such as one that rebuilds the
/// sculpture's textures, is no load.
const LONG_FRAMES: usize = 1;

/// Frames that were drawn before a change of scale, but whose times arrive after it.
const FRAMES_IN_FLIGHT: usize = 2;

/// The share of the period above which the scale is lowered. The compositor needs its part of the GPU too.
const LOWERED_SHARE: f64 = 0.88;

/// The share of the period below which the expected time must stay for the scale to be raised.
const RAISED_SHARE: f64 = 0.78;

/// Chooses the scale of the pictures, frame by frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ResolutionPolicy {
    /// The least scale, in percent; 100 disables scaling.
    least: u32,
    /// The scale, in percent of a side.
    percent: u32,
    /// GPU times of the last frames at this scale, in nanoseconds.
    times_ns: [u64; WINDOW_FRAMES],
    count: usize,
    /// Frames in flight whose times are to be ignored.
    in_flight: usize,
}

impl ResolutionPolicy {
    /// Creates a policy that starts at full scale and never goes below `least_percent` of a side.
    #[must_use]
    pub fn new(least_percent: u32) -> Self {
        let least = least_percent.clamp(LEAST_PERCENT, 100);
        ResolutionPolicy {
            least,
            percent: 100,
            times_ns: [0; WINDOW_FRAMES],
            count: 0,
            in_flight: 0,
        }
    }

    /// Returns the scale of a side, in percent.
    #[must_use]
    pub const fn percent(&self) -> u32 {
        self.percent
    }

    /// Adds the GPU time of a whole frame. Times must arrive in order, at most two frames late. A time of 0,
    /// from a device without timestamps, is ignored. Returns `true` if the scale has changed.
    pub fn observe_frame(&mut self, gpu_time_ns: u64, period: Duration) -> bool {
        if gpu_time_ns == 0 || period.is_zero() {
            return false;
        }
        if self.in_flight > 0 {
            self.in_flight -= 1;
            return false;
        }
        self.times_ns[self.count] = gpu_time_ns;
        self.count += 1;
        if self.count < WINDOW_FRAMES {
            return false;
        }
        self.count = 0;
        let mut sorted = self.times_ns;
        sorted.sort_unstable();
        let share = sorted[WINDOW_FRAMES - 1 - LONG_FRAMES] as f64 / period.as_nanos() as f64;
        let before = self.percent;
        if share > LOWERED_SHARE {
            self.percent = before.saturating_sub(STEP_PERCENT).max(self.least);
        } else {
            let raised = (before + STEP_PERCENT).min(100);
            let pixels = (f64::from(raised) / f64::from(before)).powi(2);
            if share * pixels < RAISED_SHARE {
                self.percent = raised;
            }
        }
        let has_changed = self.percent != before;
        self.in_flight = if has_changed { FRAMES_IN_FLIGHT } else { 0 };
        has_changed
    }

    /// Discards the times so far. Call it when frames have stopped or their images were recreated.
    pub fn pause(&mut self) {
        (self.count, self.in_flight) = (0, FRAMES_IN_FLIGHT);
    }

    /// Returns the pixels to draw of images of `full` pixels: the runtime's recommendation, within the bounds
    /// of this policy, or else the policy's scale. The policy's own numbers are even, as video encoders of
    /// streaming headsets prefer.
    #[must_use]
    pub fn drawn_extent(&self, full: [u32; 2], recommended: Option<[u32; 2]>) -> [u32; 2] {
        let part = |k: usize, percent: u32| ((full[k] * percent / 100 + 1) & !1).max(2);
        std::array::from_fn(|k| {
            let wanted = recommended.map_or_else(|| part(k, self.percent), |pixels| pixels[k]);
            wanted.clamp(part(k, self.least).min(full[k]), full[k])
        })
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::{FRAMES_IN_FLIGHT, LEAST_PERCENT, ResolutionPolicy};

    const PERIOD: Duration = Duration::from_nanos(13_888_889);

    /// Runs frames that take `fixed` milliseconds and `pixels` milliseconds in proportion to their pixels,
    /// each up to `noise` longer or shorter. Returns the policy, and the frames after which its scale
    /// changed.
    fn run(
        mut policy: ResolutionPolicy,
        frames: usize,
        [fixed, pixels]: [f64; 2],
        noise: f64,
    ) -> (ResolutionPolicy, Vec<usize>) {
        let (mut changes, mut dice) = (Vec::new(), 4_711_u32);
        let mut in_flight = [policy.percent(); FRAMES_IN_FLIGHT];
        for frame in 0..frames {
            dice = dice.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let off = 1.0 + noise * (f64::from(dice >> 8) / f64::from(1 << 23) - 1.0);
            // The time belongs to the frame before the last.
            let scale = f64::from(in_flight[frame % FRAMES_IN_FLIGHT]) / 100.0;
            let ms = (fixed + pixels * scale * scale) * off;
            if policy.observe_frame((ms * 1e6) as u64, PERIOD) {
                changes.push(frame);
            }
            in_flight[frame % FRAMES_IN_FLIGHT] = policy.percent();
        }
        (policy, changes)
    }

    #[test]
    fn it_settles_within_a_second_and_does_not_oscillate() {
        let (mut lowered, mut kept) = (0, 0);
        for fixed in [0.0, 1.0, 4.0, 8.0] {
            for tenths in 0..200 {
                let load = [fixed, f64::from(tenths) * 0.1];
                for start in [85, 90, 95, 100] {
                    let policy =
                        ResolutionPolicy { percent: start, ..ResolutionPolicy::new(LEAST_PERCENT) };
                    let (settled, changes) = run(policy, 720, load, 0.0);
                    assert!(
                        changes.iter().all(|at| *at < 72),
                        "{load:?} from {start}: {changes:?}"
                    );
                    // Times that vary by a twentieth either way may cross a bound late, but never back.
                    let (noisy, changes) = run(policy, 720, load, 0.05);
                    let steps = noisy.percent().abs_diff(start) / 5;
                    assert_eq!(changes.len(), steps as usize, "{load:?} from {start}: {changes:?}");
                    lowered += usize::from(settled.percent() == LEAST_PERCENT);
                    kept += usize::from(settled.percent() == 100);
                }
            }
        }
        assert!(lowered > 500 && kept > 500, "{lowered} lowered, {kept} kept");
    }

    #[test]
    fn a_load_that_comes_and_goes_is_followed_both_ways() {
        let (policy, _) = run(ResolutionPolicy::new(LEAST_PERCENT), 72, [1.0, 9.0], 0.02);
        assert_eq!(policy.percent(), 100, "10 ms of 13.9");
        let (policy, changes) = run(policy, 72, [1.0, 14.5], 0.02);
        assert_eq!(policy.percent(), 85, "15.5 ms of 13.9");
        assert!(changes[2] < 36, "within half a second: {changes:?}");
        let (policy, _) = run(policy, 72, [1.0, 9.0], 0.02);
        assert_eq!(policy.percent(), 100);
    }

    #[test]
    fn one_long_frame_in_a_window_is_no_load_and_two_are() {
        let mut policy = ResolutionPolicy::new(LEAST_PERCENT);
        for frame in 0..900 {
            assert!(
                !policy.observe_frame(if frame % 9 == 4 { 30_000_000 } else { 9_000_000 }, PERIOD)
            );
        }
        let two = |frame: u32| if frame % 9 < 2 { 30_000_000 } else { 9_000_000 };
        assert!((0..9).any(|frame| policy.observe_frame(two(frame), PERIOD)));
        // Frames that were in flight at the change don't count.
        let before = policy.percent();
        for frame in 0..18 {
            policy.observe_frame(if frame < 2 { 30_000_000 } else { 11_000_000 }, PERIOD);
        }
        assert_eq!(policy.percent(), before);
    }

    #[test]
    fn a_device_without_timestamps_and_a_scale_that_is_set_keep_it() {
        let (mut blind, mut set) =
            (ResolutionPolicy::new(LEAST_PERCENT), ResolutionPolicy::new(100));
        for _ in 0..200 {
            assert!(!blind.observe_frame(0, PERIOD));
            assert!(!set.observe_frame(40_000_000, PERIOD));
        }
        assert_eq!((blind.percent(), set.percent()), (100, 100));
    }

    #[test]
    fn what_is_drawn_is_even_and_within_the_images() {
        for full in [[1440, 1584], [1683, 1775], [2, 2], [1, 1]] {
            for percent in [85, 90, 95, 100] {
                let policy = ResolutionPolicy { percent, ..ResolutionPolicy::new(LEAST_PERCENT) };
                let drawn = policy.drawn_extent(full, None);
                for k in 0..2 {
                    assert!(drawn[k] <= full[k] && drawn[k] > 0, "{full:?} at {percent}");
                    assert!(
                        drawn[k].is_multiple_of(2) || drawn[k] == full[k],
                        "{full:?}: {drawn:?}"
                    );
                    let exact = f64::from(full[k] * percent) / 100.0;
                    assert!((f64::from(drawn[k]) - exact).abs() <= 1.0, "{full:?}: {drawn:?}");
                }
            }
        }
        let policy = ResolutionPolicy::new(LEAST_PERCENT);
        let full = [1440, 1584];
        assert_eq!(policy.drawn_extent(full, Some([1300, 1430])), [1300, 1430], "recommended");
        assert_eq!(policy.drawn_extent(full, Some([400, 9000])), [1224, 1584], "but bounded");
    }
}
