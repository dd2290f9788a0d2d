//! The voice of a hand's tool, which sounds as long as the tool runs.

use crate::dsp::{BandPass, Glide, Noise, Phase, ear_gains, sine_of_turns};
use crate::plan::{VoiceKind, VoicePlan};

/// The sounds of a hand's tool. Each has its own gain, so that one fades out while another fades in.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HandVoice {
    motor: Motor,
    scrape: Scrape,
    hiss: Hiss,
    load: Glide,
    ears: [Glide; 2],
    noise: Noise,
}

/// A motor's whine: a tone with phase feedback, rougher under load, a second tone that beats with it, and the
/// grit of stone.
#[derive(Clone, Copy, Default, Debug)]
struct Motor {
    gain: Glide,
    pitch_hz: Glide,
    phases: [Phase; 2],
    last: f32,
    grit: BandPass,
}

/// Noise of stone, modulated by passing teeth.
#[derive(Clone, Copy, Default, Debug)]
struct Scrape {
    gain: Glide,
    speed: Glide,
    teeth: Phase,
    band: BandPass,
}

/// Low noise of varying level.
#[derive(Clone, Copy, Default, Debug)]
struct Hiss {
    gain: Glide,
    waver: Phase,
    band: BandPass,
}

impl HandVoice {
    /// Creates a silent voice; its noise differs for each seed.
    pub(crate) fn new(seed: u32) -> Self {
        let (mut motor, mut scrape, mut hiss) =
            (Motor::default(), Scrape::default(), Hiss::default());
        motor.grit.tune(1900.0, 0.8);
        scrape.band.tune(1700.0, 0.9);
        hiss.band.tune(850.0, 0.7);
        let (load, ears) = (Glide::default(), [Glide::default(); 2]);
        HandVoice { motor, scrape, hiss, load, ears, noise: Noise::new(seed) }
    }

    /// Sets the targets of a plan.
    pub(crate) fn follow(&mut self, plan: &VoicePlan) {
        let was_silent = self.is_silent();
        let level_of = |kind| if plan.kind == kind { plan.level.clamp(0.0, 1.0) } else { 0.0 };
        self.motor.gain.set_target(level_of(VoiceKind::Motor));
        self.scrape.gain.set_target(level_of(VoiceKind::Scrape));
        self.hiss.gain.set_target(level_of(VoiceKind::Hiss));
        if plan.kind == VoiceKind::Silent {
            // It fades with its last pitch and pan.
            return;
        }
        self.load.set_target(plan.load.clamp(0.0, 1.0));
        self.motor.pitch_hz.set_target(plan.pitch_hz.clamp(0.0, 2000.0));
        self.scrape.speed.set_target(plan.level.clamp(0.0, 1.0));
        for (ear, gain) in self.ears.iter_mut().zip(ear_gains(plan.pan)) {
            ear.set_target(gain);
        }
        if was_silent {
            // Only the gain glides: pitch and pan are right from the first frame on.
            let [left, right] = &mut self.ears;
            let others = [&mut self.load, &mut self.motor.pitch_hz, &mut self.scrape.speed];
            others.into_iter().chain([left, right]).for_each(Glide::jump);
        }
    }

    /// Returns `true` if it is silent until it follows another plan.
    pub(crate) fn is_silent(&self) -> bool {
        [&self.motor.gain, &self.scrape.gain, &self.hiss.gain].into_iter().all(Glide::is_zero)
    }

    /// Adds its sound to frames.
    pub(crate) fn add_to(&mut self, frames: &mut [[f32; 2]]) {
        if self.is_silent() {
            return;
        }
        for frame in frames {
            let load = self.load.next();
            let mut sample = 0.0;
            if !self.motor.gain.is_zero() {
                sample += self.motor.next(load, &mut self.noise);
            }
            if !self.scrape.gain.is_zero() {
                sample += self.scrape.next(load, &mut self.noise);
            }
            if !self.hiss.gain.is_zero() {
                sample += self.hiss.next(&mut self.noise);
            }
            for (channel, ear) in frame.iter_mut().zip(&mut self.ears) {
                *channel += sample * ear.next();
            }
        }
    }
}

impl Motor {
    fn next(&mut self, load: f32, noise: &mut Noise) -> f32 {
        // Full load lowers the pitch by a fifth.
        let hz = self.pitch_hz.next() * (1.0 - 0.2 * load);
        let rough = 0.05 + 0.09 * load;
        let buzz = sine_of_turns(self.phases[0].advance(hz) + rough * self.last);
        self.last = buzz;
        let beat = sine_of_turns(self.phases[1].advance(1.503 * hz));
        let whine = (0.07 + 0.08 * load) * (buzz + 0.4 * beat);
        let grit = self.grit.filter(noise.next()) * load * (0.6 + 0.4 * buzz);
        self.gain.next() * (whine + 0.45 * grit)
    }
}

impl Scrape {
    fn next(&mut self, load: f32, noise: &mut Noise) -> f32 {
        let tooth = sine_of_turns(self.teeth.advance(50.0 + 190.0 * self.speed.next()));
        let stone = self.band.filter(noise.next()) * (0.65 + 0.35 * tooth);
        self.gain.next() * (0.35 + 0.35 * load) * stone
    }
}

impl Hiss {
    fn next(&mut self, noise: &mut Noise) -> f32 {
        let waver = 0.8 + 0.2 * sine_of_turns(self.waver.advance(11.0));
        self.gain.next() * 0.22 * waver * self.band.filter(noise.next())
    }
}
