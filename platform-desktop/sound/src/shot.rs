//! Sounds that begin once and end by themselves: struck partials, and a burst of noise.

use crate::dsp::{
    BandPass, FRAME_SECONDS, INAUDIBLE, Noise, Phase, ear_gains, limit_softly, sine_of_turns,
};
use crate::mixer::SAMPLE_RATE;
use crate::plan::{Shot, ShotKind};

/// The most partials of a sound: the clock's three strokes have two each, [`ShotKind::Found`] has five.
const MAX_PARTIALS: usize = 6;

/// The parameters of a sound.
struct Recipe {
    /// The time to full loudness, in milliseconds; without it the sound would click.
    attack_ms: f32,
    partials: &'static [PartialSpec],
    burst: Option<BurstSpec>,
}

/// A tone that fades.
struct PartialSpec {
    onset_ms: f32,
    hz: f32,
    gain: f32,
    /// The time constant of the decay, in milliseconds: the level falls to 1/e in it.
    decay_ms: f32,
}

/// Filtered noise that fades.
struct BurstSpec {
    hz: f32,
    quality: f32,
    gain: f32,
    decay_ms: f32,
}

const fn partial(onset_ms: f32, hz: f32, gain: f32, decay_ms: f32) -> PartialSpec {
    PartialSpec { onset_ms, hz, gain, decay_ms }
}

const fn burst(hz: f32, quality: f32, gain: f32, decay_ms: f32) -> Option<BurstSpec> {
    Some(BurstSpec { hz, quality, gain, decay_ms })
}

/// The tones of the chisel's steel and of the stone under it.
static BLOW: Recipe = Recipe {
    attack_ms: 1.0,
    partials: &[partial(0.0, 1340.0, 0.16, 14.0), partial(0.0, 210.0, 0.3, 22.0)],
    burst: burst(1500.0, 0.7, 0.5, 9.0),
};
static PUFF: Recipe = Recipe { attack_ms: 2.0, partials: &[], burst: burst(600.0, 0.7, 0.6, 18.0) };
static CHIP: Recipe = Recipe {
    attack_ms: 1.0,
    partials: &[partial(0.0, 2150.0, 0.07, 10.0)],
    burst: burst(2300.0, 1.2, 0.6, 14.0),
};
static FLAKE: Recipe = Recipe {
    attack_ms: 1.0,
    partials: &[partial(0.0, 320.0, 0.25, 40.0), partial(0.0, 870.0, 0.12, 25.0)],
    burst: burst(1100.0, 0.6, 0.6, 45.0),
};
/// The piece hits the floor a third of a second later.
static FALL: Recipe = Recipe {
    attack_ms: 3.0,
    partials: &[partial(330.0, 72.0, 0.55, 120.0), partial(330.0, 131.0, 0.25, 80.0)],
    burst: burst(420.0, 0.6, 0.5, 140.0),
};
/// The partials of a glass bell; the third one beats with the second.
static BARED: Recipe = Recipe {
    attack_ms: 2.0,
    partials: &[
        partial(0.0, 523.25, 0.2, 420.0),
        partial(0.0, 1444.2, 0.09, 260.0),
        partial(0.0, 1449.0, 0.05, 300.0),
        partial(0.0, 2825.0, 0.03, 120.0),
    ],
    burst: None,
};
/// The notes C, E, G, C, E, one after another.
static FOUND: Recipe = Recipe {
    attack_ms: 3.0,
    partials: &[
        partial(0.0, 523.25, 0.16, 700.0),
        partial(110.0, 659.26, 0.16, 700.0),
        partial(220.0, 783.99, 0.16, 800.0),
        partial(330.0, 1046.5, 0.16, 900.0),
        partial(440.0, 1318.5, 0.1, 900.0),
    ],
    burst: None,
};
/// Two partials per stroke.
static CLOCK: Recipe = Recipe {
    attack_ms: 2.0,
    partials: &[
        partial(0.0, 880.0, 0.2, 130.0),
        partial(0.0, 2210.0, 0.05, 50.0),
        partial(280.0, 880.0, 0.2, 130.0),
        partial(280.0, 2210.0, 0.05, 50.0),
        partial(560.0, 880.0, 0.2, 130.0),
        partial(560.0, 2210.0, 0.05, 50.0),
    ],
    burst: None,
};
/// A large bell.
static END: Recipe = Recipe {
    attack_ms: 4.0,
    partials: &[
        partial(0.0, 130.8, 0.24, 1100.0),
        partial(0.0, 261.6, 0.18, 900.0),
        partial(0.0, 314.0, 0.12, 700.0),
        partial(0.0, 392.0, 0.1, 600.0),
        partial(0.0, 523.3, 0.08, 450.0),
    ],
    burst: None,
};
static UNDO: Recipe = Recipe {
    attack_ms: 3.0,
    partials: &[partial(0.0, 494.0, 0.14, 60.0), partial(70.0, 370.0, 0.14, 80.0)],
    burst: None,
};
static REDO: Recipe = Recipe {
    attack_ms: 3.0,
    partials: &[partial(0.0, 370.0, 0.14, 60.0), partial(70.0, 494.0, 0.14, 80.0)],
    burst: None,
};
static TAKE: Recipe = Recipe {
    attack_ms: 1.0,
    partials: &[partial(0.0, 640.0, 0.1, 20.0)],
    burst: burst(1800.0, 1.0, 0.2, 8.0),
};
static PUT_BACK: Recipe = Recipe {
    attack_ms: 1.0,
    partials: &[partial(0.0, 240.0, 0.2, 35.0)],
    burst: burst(900.0, 0.8, 0.25, 14.0),
};

/// The pitch ratios of the bell for the tenths 1 to 10: two octaves of the pentatonic scale.
const BARED_RATIOS: [f32; 10] = [1.0, 1.125, 1.25, 1.5, 1.667, 2.0, 2.25, 2.5, 3.0, 3.333];

/// Returns a sound's parameters, pitch ratio and number of partials.
fn recipe_of(kind: ShotKind) -> (&'static Recipe, f32, usize) {
    let recipe = match kind {
        ShotKind::Blow => &BLOW,
        ShotKind::Puff => &PUFF,
        ShotKind::Chip => &CHIP,
        ShotKind::Flake => &FLAKE,
        ShotKind::Fall => &FALL,
        ShotKind::Bared { tenths } => {
            let ratio = BARED_RATIOS[usize::from(tenths.clamp(1, 10)) - 1];
            return (&BARED, ratio, BARED.partials.len());
        }
        ShotKind::Found => &FOUND,
        ShotKind::Clock { strokes } => {
            return (&CLOCK, 1.0, 2 * usize::from(strokes.clamp(1, 3)));
        }
        ShotKind::End => &END,
        ShotKind::Undo => &UNDO,
        ShotKind::Redo => &REDO,
        ShotKind::Take => &TAKE,
        ShotKind::PutBack => &PUT_BACK,
    };
    (recipe, 1.0, recipe.partials.len())
}

/// An envelope with a delayed onset, a linear attack and an exponential decay.
#[derive(Clone, Copy, Default, Debug)]
struct Envelope {
    onset_frames: u32,
    level: f32,
    kept: f32,
    rise: f32,
    risen: f32,
}

impl Envelope {
    fn new(onset_ms: f32, attack_ms: f32, gain: f32, decay_ms: f32) -> Self {
        Envelope {
            onset_frames: (onset_ms * 1e-3 * SAMPLE_RATE as f32) as u32,
            level: gain,
            kept: libm::expf(-FRAME_SECONDS / (decay_ms * 1e-3)),
            rise: FRAME_SECONDS / (attack_ms * 1e-3),
            risen: 0.0,
        }
    }

    fn has_ended(&self) -> bool {
        self.level == 0.0
    }

    /// Returns the next frame's level; `None` before it begins and after its end.
    fn next(&mut self) -> Option<f32> {
        if self.onset_frames > 0 {
            self.onset_frames -= 1;
            return None;
        }
        self.risen = (self.risen + self.rise).min(1.0);
        self.level *= self.kept;
        if self.level < INAUDIBLE {
            self.level = 0.0;
        }
        (!self.has_ended()).then_some(self.level * self.risen)
    }
}

/// The state of a partial.
#[derive(Clone, Copy, Default, Debug)]
struct Partial {
    envelope: Envelope,
    hz: f32,
    phase: Phase,
}

/// The state of a sound, or silence.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SoundingShot {
    partials: [Partial; MAX_PARTIALS],
    burst: Envelope,
    band: BandPass,
    noise: Noise,
    ears: [f32; 2],
}

impl SoundingShot {
    /// Creates silence; the noise differs for each seed.
    pub(crate) fn new(seed: u32) -> Self {
        SoundingShot {
            partials: [Partial::default(); MAX_PARTIALS],
            burst: Envelope::default(),
            band: BandPass::default(),
            noise: Noise::new(seed),
            ears: [0.0; 2],
        }
    }

    /// Begins a sound, replacing the current one.
    pub(crate) fn begin(&mut self, shot: &Shot) {
        let (recipe, ratio, count) = recipe_of(shot.kind);
        let strength = shot.strength.clamp(0.0, 1.0);
        *self = SoundingShot { noise: self.noise, ..SoundingShot::new(0) };
        for (partial, spec) in self.partials.iter_mut().zip(&recipe.partials[..count]) {
            let gain = strength * spec.gain;
            let envelope = Envelope::new(spec.onset_ms, recipe.attack_ms, gain, spec.decay_ms);
            *partial = Partial { envelope, hz: ratio * spec.hz, phase: Phase::default() };
        }
        if let Some(spec) = &recipe.burst {
            let gain = strength * spec.gain;
            self.burst = Envelope::new(0.0, recipe.attack_ms, gain, spec.decay_ms);
            self.band.tune(spec.hz, spec.quality);
        }
        self.ears = ear_gains(shot.pan);
    }

    /// Returns `true` if it is silent until another sound begins.
    pub(crate) fn has_ended(&self) -> bool {
        self.burst.has_ended() && self.partials.iter().all(|partial| partial.envelope.has_ended())
    }

    /// Adds its sound to frames.
    pub(crate) fn add_to(&mut self, frames: &mut [[f32; 2]]) {
        if self.has_ended() {
            return;
        }
        for frame in frames {
            let mut sample = 0.0;
            for partial in &mut self.partials {
                if let Some(level) = partial.envelope.next() {
                    sample += level * sine_of_turns(partial.phase.advance(partial.hz));
                }
            }
            if let Some(level) = self.burst.next() {
                sample += level * self.band.filter(self.noise.next());
            }
            let sample = limit_softly(sample);
            frame[0] += sample * self.ears[0];
            frame[1] += sample * self.ears[1];
        }
    }
}
