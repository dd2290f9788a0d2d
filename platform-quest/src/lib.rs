//! The headset's shell: turns the poses and actions of an OpenXR session into ticks, and draws what they
//! made for both eyes.
//!
//! Decisions are made without OpenXR: by the policies of [`paros_shell::headset`] and by
//! [`foveation`], which are plain functions of what the runtime reports. `xr` makes the calls, and
//! [`shell`] runs the frame loop; before its first frame `start_keeper` and `notice_session` tell of a start that fails. [`platform`] is the operating system; [`device`] and [`runtime`] are
//! Android's part of it: the Java classes, and the search for the OpenXR runtime.

#[cfg(target_os = "android")]
mod android;
pub mod arguments;
mod boot_clock;
mod compilation;
pub mod device;
pub mod error;
pub mod fleet;
pub mod foveation;
pub mod log;
mod notice_session;
pub mod options;
pub mod platform;
pub mod runtime;
mod session_resources;
pub mod shell;
mod start_keeper;
mod test_commands;
mod xr;
