//! Decisions of the headset's shell that need no device: when ticks are due, where the room stands, how a start goes and
//! what is seen of it, what a change of the session obliges to, and which library is the runtime.
//! They take plain numbers and times, as a runtime or a device tells them. They call neither OpenXR nor Android.
//!
//! What the exhibition, the settings or the package need too is in [`paros_shell::headset`].
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
