//! What a session sounds like.
//!
//! Takes a [`World`](paros_core::World) after each tick and that tick's input; a [`SoundPlanner`] makes of them what
//! is to sound, a small [`SoundPlan`], a [`Mixer`] of plans the frames of both ears, and a [`Speaker`] has a device
//! play them. Plans and frames are a function of what was put in: the same trace sounds the same on every machine.
//! It decides nothing, and reads no clock.
//!
//! The synthesis is the crate's own, of oscillators, filtered noise and envelopes in one page (`dsp`). `fundsp` was
//! tried for it: three voices made of its nodes are 91 KB of code, of 130 KB that the headset's package has left, and
//! it brings 21 crates, among them a second `glam` and two more `hashbrown`.
#![deny(unsafe_code)]

mod device;
mod dsp;
mod mixer;
mod plan;
mod planner;
mod shot;
mod voice;

pub use device::{Interface, SoundDevice, Speaker};
pub use mixer::{Mixer, SAMPLE_RATE, frames_in_tick};
pub use plan::{MAX_SHOTS, Shot, ShotKind, SoundPlan, VoiceKind, VoicePlan};
pub use planner::SoundPlanner;
