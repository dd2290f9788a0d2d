//! Tests of the mixer: plans rendered as for a device, and kept as WAV files beside the build.

mod shots;
mod voices;

use std::path::{Path, PathBuf};

use paros_sound::{
    Mixer, SAMPLE_RATE, Shot, ShotKind, SoundPlan, VoiceKind, VoicePlan, frames_in_tick,
};

/// All kinds of shots.
const SHOTS: [ShotKind; 16] = [
    ShotKind::Blow,
    ShotKind::Puff,
    ShotKind::Chip,
    ShotKind::Flake,
    ShotKind::Fall,
    ShotKind::Bared { tenths: 1 },
    ShotKind::Bared { tenths: 10 },
    ShotKind::Found,
    ShotKind::Clock { strokes: 1 },
    ShotKind::Clock { strokes: 2 },
    ShotKind::Clock { strokes: 3 },
    ShotKind::End,
    ShotKind::Undo,
    ShotKind::Redo,
    ShotKind::Take,
    ShotKind::PutBack,
];

/// The voices of tools.
const VOICES: [(&str, VoicePlan); 4] = [
    ("motor-idle", voice(VoiceKind::Motor, 330.0, 0.0)),
    ("motor-loaded", voice(VoiceKind::Motor, 330.0, 0.7)),
    ("scrape", voice(VoiceKind::Scrape, 0.0, 0.4)),
    ("hiss", voice(VoiceKind::Hiss, 0.0, 0.1)),
];

const fn voice(kind: VoiceKind, pitch_hz: f32, load: f32) -> VoicePlan {
    VoicePlan { kind, level: 1.0, load, pitch_hz, pan: 0.0 }
}

/// Returns a plan in which only the right hand has a voice.
fn plan_of(voice: VoicePlan) -> SoundPlan {
    let mut plan = SoundPlan::default();
    plan.voices[1] = voice;
    plan
}

/// Returns a plan in which one sound begins in the middle.
fn plan_with(kind: ShotKind) -> SoundPlan {
    let mut plan = SoundPlan::default();
    plan.push(Shot { kind, strength: 1.0, pan: 0.0 });
    plan
}

/// Mixes each plan for its number of ticks, at full volume.
fn mix(plans: &[(SoundPlan, u64)]) -> Vec<[f32; 2]> {
    mix_on(&mut Mixer::new(100), plans)
}

fn mix_on(mixer: &mut Mixer, plans: &[(SoundPlan, u64)]) -> Vec<[f32; 2]> {
    let mut frames = Vec::new();
    let mut tick = 0;
    for (plan, ticks) in plans {
        for _ in 0..*ticks {
            mixer.follow(plan);
            let begin = frames.len();
            frames.resize(begin + frames_in_tick(tick), [0.0; 2]);
            mixer.render(&mut frames[begin..]);
            tick += 1;
        }
    }
    frames
}

/// Returns the mean power of one side, in decibels of full scale.
fn decibels(frames: &[[f32; 2]], side: usize) -> f32 {
    let sum: f64 = frames.iter().map(|frame| f64::from(frame[side]).powi(2)).sum();
    (10.0 * (sum / frames.len() as f64).max(1e-12).log10()) as f32
}

/// Returns the largest step from a sample to the next one of the same side.
fn largest_step(frames: &[[f32; 2]]) -> f32 {
    let steps = frames.windows(2).flat_map(|pair| [0, 1].map(|i| (pair[1][i] - pair[0][i]).abs()));
    steps.fold(0.0, f32::max)
}

/// Writes frames to a file, for people who want to listen.
fn keep(name: &str, frames: &[[f32; 2]]) {
    let folder: PathBuf = Path::new(env!("CARGO_TARGET_TMPDIR")).join("sounds");
    std::fs::create_dir_all(&folder).expect("room on the disk");
    let path = folder.join(format!("{name}.wav"));
    let spec = hound::WavSpec {
        channels: 2,
        sample_rate: SAMPLE_RATE,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut writer = hound::WavWriter::create(&path, spec).expect("room on the disk");
    frames.as_flattened().iter().for_each(|sample| writer.write_sample(*sample).expect("room"));
    writer.finalize().expect("room on the disk");
}
