//! Policies of the headset that need no device: when ticks are due, what hands are read from, feel and do, how much is
//! drawn, who wears the headset, how hot it is, how a start goes and what is seen of it, what a change of the session
//! obliges to, which library is the runtime, and what the app's package holds.
//! They take plain numbers and times, as a runtime or a device tells them, and give inputs and decisions.
//! They call neither OpenXR nor Android.

pub mod device_health;
pub mod foveation;
pub mod frame_pacer;
pub mod hand_reader;
pub mod hand_sample;
pub mod haptics;
pub mod height_step;
pub mod notice_placement;
pub mod package;
pub mod recentering;
pub mod resolution;
pub mod room_placement;
pub mod runtime;
pub mod sealed;
pub mod session_phase;
pub mod start_up;
pub mod stick_presses;
pub mod visit;
