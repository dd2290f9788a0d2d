//! The headset's shell: turns an OpenXR session's poses and buttons into ticks, and draws what they
//! made for both eyes.
//!
//! What is decided is decided without OpenXR: [`life`], [`beat`], [`sample`], [`pulse`],
//! [`recentre`], [`visitor`], [`strain`] and [`foveation`] are plain functions of what the runtime tells. `xr`
//! makes the calls, and [`shell`] goes from frame to frame.

#[cfg(target_os = "android")]
mod android;
pub mod arguments;
pub mod beat;
pub mod device;
pub mod error;
pub mod foveation;
pub mod host;
pub mod life;
pub mod options;
pub mod pulse;
pub mod recentre;
pub mod replay;
mod rig;
pub mod runtime;
pub mod sample;
pub mod script;
pub mod settings;
pub mod shell;
pub mod starts;
pub mod strain;
pub mod visitor;
mod xr;
