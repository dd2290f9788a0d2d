//! Decisions of the headset's shell that need no device: when ticks are due, where the room stands, how a
//! start proceeds and which notice it shows, the duties of a session change, and the choice of the OpenXR
//! runtime. They take plain numbers and times from a runtime or a device, and call neither OpenXR nor
//! Android.
//!
//! Decisions that the exhibition, the settings or the package also need are in [`paros_shell::headset`].
#![forbid(unsafe_code)]

pub mod frame_pacer;
pub mod notice_picture;
pub mod notice_placement;
pub mod recentering;
pub mod room_placement;
pub mod runtime;
pub mod session_phase;
pub mod start_up;
pub mod stick_presses;
