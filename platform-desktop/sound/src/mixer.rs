//! The mixer, which renders plans to stereo frames.

use paros_core::session::TICK_RATE;

use crate::dsp::limit_softly;
use crate::plan::{SoundPlan, VoicePlan};
use crate::shot::SoundingShot;
use crate::voice::HandVoice;

/// The sample rate, in frames per second.
pub const SAMPLE_RATE: u32 = 48_000;

/// The most shots that sound at once. Frequent shots (blows, chips) leave the last four to the others, so
/// that a clock is heard even while two hammers run.
const SOUNDING_SHOTS: usize = 14;
const KEPT_FOR_OTHERS: usize = 4;

/// Frames without a plan after which voices end: eight ticks, more than a late frame takes. A hidden window
/// or a sleeping headset runs no ticks.
const PATIENCE_FRAMES: u32 = 8 * SAMPLE_RATE / TICK_RATE;

/// Mixes the sounds of plans. It allocates nothing, and is deterministic: the same sequence of plans and
/// frames gives the same samples.
#[derive(Clone, Debug)]
pub struct Mixer {
    voices: [HandVoice; 2],
    shots: [SoundingShot; SOUNDING_SHOTS],
    volume: f32,
    frames_since_plan: u32,
}

/// Returns the number of frames of a tick, so that 72 consecutive ticks make one second.
#[must_use]
pub const fn frames_in_tick(tick: u64) -> usize {
    let (rate, ticks) = (SAMPLE_RATE as u64, TICK_RATE as u64);
    ((tick + 1) * rate / ticks - tick * rate / ticks) as usize
}

impl Mixer {
    /// Creates a silent mixer at a volume of 0 to 100, on a scale of even steps for the ear.
    #[must_use]
    pub fn new(percent: u32) -> Self {
        let part = percent.min(100) as f32 / 100.0;
        Mixer {
            voices: [HandVoice::new(1), HandVoice::new(2)],
            shots: core::array::from_fn(|i| SoundingShot::new(3 + i as u32)),
            volume: part * part,
            frames_since_plan: 0,
        }
    }

    /// Applies the plan of a tick: its sounds begin with the next frame.
    pub fn follow(&mut self, plan: &SoundPlan) {
        self.frames_since_plan = 0;
        for (voice, plan) in self.voices.iter_mut().zip(&plan.voices) {
            voice.follow(plan);
        }
        for shot in plan.shots() {
            let most = match shot.kind.is_one_of_many() {
                true => SOUNDING_SHOTS - KEPT_FOR_OTHERS,
                false => SOUNDING_SHOTS,
            };
            // Rare shots are placed from the end, which frequent shots don't use.
            let free = self.shots[..most].iter_mut().rev().find(|sounding| sounding.has_ended());
            if let Some(free) = free {
                free.begin(shot);
            }
        }
    }

    /// Renders stereo frames, left and right, with samples between -1 and 1.
    pub fn render(&mut self, frames: &mut [[f32; 2]]) {
        frames.fill([0.0; 2]);
        self.frames_since_plan = self.frames_since_plan.saturating_add(frames.len() as u32);
        if self.frames_since_plan > PATIENCE_FRAMES {
            self.voices.iter_mut().for_each(|voice| voice.follow(&VoicePlan::default()));
        }
        self.voices.iter_mut().for_each(|voice| voice.add_to(frames));
        self.shots.iter_mut().for_each(|shot| shot.add_to(frames));
        for sample in frames.as_flattened_mut() {
            *sample = limit_softly(*sample) * self.volume;
        }
    }

    /// Returns `true` if all sounds have ended.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        self.voices.iter().all(HandVoice::is_silent)
            && self.shots.iter().all(SoundingShot::has_ended)
    }
}
