//! The headset's shell: turns an OpenXR session's poses and buttons into ticks, and draws what they
//! made for both eyes.

pub mod beat;
pub mod life;
pub mod pulse;
pub mod recentre;
pub mod sample;
pub mod strain;
pub mod visitor;
