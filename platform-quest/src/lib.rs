//! The headset's shell: turns the poses and actions of an OpenXR session into ticks, and draws the resulting
//! world for both eyes.
//!
//! Decisions are made without OpenXR: the policies of [`paros_shell::headset`] and [`foveation`] are plain
//! functions of the runtime's reports. `xr` makes the calls, and [`shell`] runs the frame loop. Before the
//! first frame `start_keeper` and `notice_session` show a start that fails. [`platform`] is the interface to
//! the operating system. [`device`] and [`runtime`] are its Android part: the Java classes, and the search
//! for the OpenXR runtime.

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
