//! Building blocks of sounds: a sine, noise, a filter, glides and a limiter.
//!
//! They use only arithmetic and `libm`, no functions of `std`, so that frames are the same on every machine.

use core::f32::consts::PI;

use crate::mixer::SAMPLE_RATE;

/// The length of a frame, in seconds.
pub(crate) const FRAME_SECONDS: f32 = 1.0 / SAMPLE_RATE as f32;

/// The level, -90 dB, below which a sound counts as silent.
pub(crate) const INAUDIBLE: f32 = 3e-5;

/// Returns the sine of a phase in turns, -0.5 to 1.5, to within 0.001: a parabola with a quadratic
/// correction.
pub(crate) fn sine_of_turns(turns: f32) -> f32 {
    let x = 1.0 - 2.0 * (turns - floor(turns));
    let y = 4.0 * x * (1.0 - x.abs());
    y + 0.225 * (y * y.abs() - y)
}

/// Returns the greatest whole number not above `x`, for magnitudes up to some thousands.
fn floor(x: f32) -> f32 {
    let cut = x as i32 as f32;
    if cut > x { cut - 1.0 } else { cut }
}

/// A phase in turns, 0 to 1.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct Phase(f32);

impl Phase {
    /// Advances by a frame at a frequency in hertz. Returns the new phase.
    pub(crate) fn advance(&mut self, hz: f32) -> f32 {
        self.0 += hz * FRAME_SECONDS;
        self.0 -= floor(self.0);
        self.0
    }
}

/// White noise: Marsaglia's xorshift.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Noise(u32);

impl Noise {
    /// Creates noise that differs for each seed.
    pub(crate) const fn new(seed: u32) -> Self {
        Noise(seed.wrapping_mul(0x9e37_79b9) | 1)
    }

    /// Returns the next sample, -1 to 1.
    pub(crate) fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0 as i32 as f32 * (1.0 / 2_147_483_648.0)
    }
}

/// A band-pass filter: Simper's state-variable filter with trapezoidal integration, which may be tuned while
/// it runs. Its gain at the centre of the band is 1.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct BandPass {
    /// The gains of the first and the second integrator, and the damping.
    gains: [f32; 3],
    states: [f32; 2],
}

impl BandPass {
    /// Tunes it to a centre frequency in hertz. The bandwidth is that frequency divided by `quality`.
    pub(crate) fn tune(&mut self, hz: f32, quality: f32) {
        let g = libm::tanf(PI * (hz * FRAME_SECONDS).clamp(0.0, 0.45));
        let damping = 1.0 / quality;
        let first = 1.0 / (1.0 + g * (g + damping));
        self.gains = [first, g * first, damping];
    }

    /// Filters the next sample.
    pub(crate) fn filter(&mut self, input: f32) -> f32 {
        let [first, second, damping] = self.gains;
        let [band_state, low_state] = self.states;
        let high = input - low_state;
        let band = first * band_state + second * high;
        // `second / first` is the `g` of `tune`.
        let low = low_state + second / first * band;
        self.states = [2.0 * band - band_state, 2.0 * low - low_state];
        band * damping
    }
}

/// A value that approaches its target smoothly.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct Glide {
    now: f32,
    target: f32,
}

impl Glide {
    /// The fraction of the remaining distance per frame: two thirds of it in 5 ms.
    const RATE: f32 = FRAME_SECONDS / 0.005;

    pub(crate) const fn set_target(&mut self, target: f32) {
        self.target = target;
    }

    /// Jumps to its target, for when it is inaudible.
    pub(crate) const fn jump(&mut self) {
        self.now = self.target;
    }

    /// Returns `true` if the value and its target are 0.
    pub(crate) fn is_zero(&self) -> bool {
        self.now == 0.0 && self.target == 0.0
    }

    /// Returns the next frame's value.
    pub(crate) fn next(&mut self) -> f32 {
        self.now += (self.target - self.now) * Self::RATE;
        if (self.target - self.now).abs() < INAUDIBLE {
            self.now = self.target;
        }
        self.now
    }
}

/// Returns the gains of both ears for a pan of -1 to 1, with constant power.
pub(crate) fn ear_gains(pan: f32) -> [f32; 2] {
    let turns = (pan.clamp(-1.0, 1.0) + 1.0) / 8.0;
    [sine_of_turns(0.25 - turns), sine_of_turns(turns)]
}

/// Limits a sample softly: up to 0.6 it is unchanged, above that it is bent towards 0.95.
pub(crate) fn limit_softly(sample: f32) -> f32 {
    const KNEE: f32 = 0.6;
    const ROOM: f32 = 0.35;
    let beyond = (sample.abs() - KNEE) / ROOM;
    if beyond <= 0.0 {
        return sample;
    }
    (KNEE + ROOM * beyond / (1.0 + beyond)).copysign(sample)
}

#[cfg(test)]
mod tests {
    use super::{BandPass, Glide, Noise, Phase, ear_gains, limit_softly, sine_of_turns};
    use crate::mixer::SAMPLE_RATE;

    #[test]
    fn the_sine_is_one() {
        for i in -500..1500 {
            let turns = i as f32 / 1000.0;
            let exact = (f64::from(turns) * std::f64::consts::TAU).sin();
            assert!((f64::from(sine_of_turns(turns)) - exact).abs() < 1.2e-3, "{turns}");
        }
    }

    #[test]
    fn the_limit_is_steady_and_under_full_scale() {
        let mut last = limit_softly(-20.0);
        assert!(last > -1.0);
        for i in -1999..2000 {
            let limited = limit_softly(i as f32 / 100.0);
            assert!(limited >= last && limited - last <= 0.010_001 && limited < 1.0);
            last = limited;
        }
        assert_eq!(limit_softly(0.5), 0.5);
    }

    #[test]
    fn ears_share_the_power_of_a_sound() {
        for i in -10..=10 {
            let [left, right] = ear_gains(i as f32 / 10.0);
            assert!((left * left + right * right - 1.0).abs() < 5e-3);
            assert_eq!(left < right, i > 0, "{i}");
        }
    }

    /// Returns the gain of a band-pass at 1,000 Hz for a tone.
    fn gain_at(hz: f32) -> f32 {
        let (mut filter, mut phase, mut peak) = (BandPass::default(), Phase::default(), 0.0f32);
        filter.tune(1000.0, 2.0);
        for frame in 0..SAMPLE_RATE / 2 {
            let out = filter.filter(sine_of_turns(phase.advance(hz)));
            peak = if frame > SAMPLE_RATE / 4 { peak.max(out.abs()) } else { 0.0 };
        }
        peak
    }

    #[test]
    fn a_band_passes_and_the_rest_does_not() {
        assert!((gain_at(1000.0) - 1.0).abs() < 0.02, "{}", gain_at(1000.0));
        assert!(gain_at(100.0) < 0.1 && gain_at(9000.0) < 0.1);
    }

    #[test]
    fn noise_has_no_bias_and_glides_end() {
        let mut noise = Noise::new(3);
        let mean = (0..100_000).map(|_| noise.next()).sum::<f32>() / 1e5;
        assert!(mean.abs() < 0.01, "{mean}");
        let mut glide = Glide::default();
        glide.set_target(1.0);
        assert!((0..SAMPLE_RATE / 10).map(|_| glide.next()).last() == Some(1.0));
        glide.set_target(0.0);
        assert!((0..SAMPLE_RATE / 10).map(|_| glide.next()).last() == Some(0.0));
        assert!(glide.is_zero());
    }
}
