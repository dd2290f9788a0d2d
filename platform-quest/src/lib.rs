//! The headset's shell: turns an OpenXR session's poses and buttons into ticks, and draws what they
//! made for both eyes.

#[cfg(target_os = "android")]
mod android;
pub mod device;
pub mod replay;
pub mod runtime;
pub mod starts;
