//! Sound synthesis for a session.
//!
//! A [`SoundPlanner`] turns the [`World`](paros_core::World) after each tick, and that tick's input, into a
//! small [`SoundPlan`]. A [`Mixer`] renders plans to stereo frames, and a [`Speaker`] plays them on a device.
//! Plans and frames depend only on these inputs: the same trace sounds the same on every machine. The crate
//! decides nothing about the session, and reads no clock.
//!
//! The synthesis is the crate's own: oscillators, filtered noise and envelopes (`dsp`). The crate `fundsp`
//! was tried: three voices made of its nodes take 91 KB of code, of the 130 KB left in the headset's package,
//! and it brings 21 crates, among them a second `glam` and two more `hashbrown`.
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
