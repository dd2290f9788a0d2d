//! Resolution scale of a window's picture. It is lowered if frames take too long, for example without a GPU.
//! The panels keep the window's resolution.

use super::screen::FRAMES_IN_FLIGHT;

/// Smallest and largest scale of a picture's sides, in percent.
const LEAST_PERCENT: u32 = 35;
const WHOLE_PERCENT: u32 = 100;

/// Frame time above which the scale is lowered, in nanoseconds.
const SLOW_NS: f64 = 50e6;

/// Target frame time after a change of the scale, in nanoseconds. Below half of `SLOW_NS`, so that the scale
/// doesn't oscillate under a steady load: a part of a frame's time doesn't depend on the scale.
const AIM_NS: f64 = 22e6;

/// Frames between two changes of the scale, before lowering and before raising it.
const FRAMES_BEFORE_LOWERING: u32 = 2;
const FRAMES_BEFORE_RAISING: u32 = 8;

/// Smallest increase of the scale, in percent. Smaller increases are skipped.
const LEAST_RAISE: u32 = 5;

/// Chooses the scale, frame by frame.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct PictureScale {
    percent: u32,
    /// Frames in flight that were submitted at the previous scale. Their times are ignored.
    in_flight: usize,
    /// The shortest frame time since the last change: frames that upload textures take longer.
    least_ns: f64,
    /// Frames since the last change.
    frames: u32,
}

impl PictureScale {
    /// Starts at full scale, or at the smallest scale on a software device.
    pub(super) const fn new(is_software: bool) -> Self {
        let percent = if is_software { LEAST_PERCENT } else { WHOLE_PERCENT };
        PictureScale { percent, in_flight: FRAMES_IN_FLIGHT, least_ns: f64::MAX, frames: 0 }
    }

    /// Takes a frame's GPU time in nanoseconds, and returns the scale of the next frame in percent. A time of
    /// 0, from a device without timestamps, changes nothing.
    pub(super) fn after_frame(&mut self, gpu_time_ns: u64) -> u32 {
        if gpu_time_ns == 0 || self.in_flight > 0 {
            self.in_flight = self.in_flight.saturating_sub(1);
            return self.percent;
        }
        self.least_ns = self.least_ns.min(gpu_time_ns as f64);
        self.frames += 1;
        // The time is at most in proportion to the number of pixels.
        let aim = f64::from(self.percent) * (AIM_NS / self.least_ns).sqrt();
        let aim = (aim as u32).clamp(LEAST_PERCENT, WHOLE_PERCENT);
        let (frames, chosen) = match self.least_ns > SLOW_NS {
            true => (FRAMES_BEFORE_LOWERING, aim.min(self.percent)),
            false if aim >= self.percent + LEAST_RAISE => (FRAMES_BEFORE_RAISING, aim),
            false => (FRAMES_BEFORE_RAISING, self.percent),
        };
        if self.frames < frames {
            return self.percent;
        }
        let in_flight = if chosen == self.percent { 0 } else { FRAMES_IN_FLIGHT };
        *self = PictureScale { percent: chosen, in_flight, ..PictureScale::new(false) };
        chosen
    }
}

#[cfg(test)]
mod tests {
    use super::{LEAST_PERCENT, PictureScale, WHOLE_PERCENT};

    /// Simulates frames whose time in milliseconds has a fixed part and a part in proportion to the pixels.
    /// Returns each scale, with the frame after which it was set.
    fn run(mut scale: PictureScale, [fixed, whole]: [f64; 2]) -> Vec<(u32, u32)> {
        let (mut seen, mut in_flight) = (vec![(0, scale.percent)], [scale.percent; 2]);
        for frame in 1..400 {
            let percent = in_flight[frame as usize % 2];
            let ms = fixed + whole * f64::from(percent).powi(2) / 1e4;
            let next = scale.after_frame((ms * 1e6) as u64);
            in_flight[frame as usize % 2] = next;
            if Some(next) != seen.last().map(|(_, percent)| *percent) {
                seen.push((frame, next));
            }
        }
        seen
    }

    #[test]
    fn a_device_that_keeps_up_draws_the_whole_and_one_in_software_little_at_first() {
        assert_eq!(run(PictureScale::new(false), [1.0, 8.0]), [(0, WHOLE_PERCENT)]);
        let from_software = run(PictureScale::new(true), [1.0, 8.0]);
        assert_eq!((from_software[0], from_software.last().unwrap().1), ((0, 35), WHOLE_PERCENT));
        assert_eq!(run(PictureScale::new(true), [60.0, 900.0]), [(0, LEAST_PERCENT)]);
    }

    #[test]
    fn a_slow_device_draws_less_from_the_fourth_frame_on() {
        let seen = run(PictureScale::new(false), [10.0, 310.0]);
        assert_eq!(seen[1].0, 4);
        assert_eq!(seen.last().unwrap().1, LEAST_PERCENT);
    }

    #[test]
    fn a_steady_load_has_the_scale_settle() {
        for fixed in [0.0, 2.0, 5.0, 10.0, 20.0, 40.0, 60.0] {
            for whole in (0..100).map(|tens| f64::from(tens) * 10.0) {
                for is_software in [false, true] {
                    let seen = run(PictureScale::new(is_software), [fixed, whole]);
                    assert!(
                        seen.len() <= 6 && seen.last().unwrap().0 < 100,
                        "{fixed} {whole}: {seen:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn without_timestamps_nothing_changes() {
        let mut scale = PictureScale::new(false);
        assert!((0..100).all(|_| scale.after_frame(0) == WHOLE_PERCENT));
    }
}
