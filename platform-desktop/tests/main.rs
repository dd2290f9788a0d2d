//! Runs the program `paros` as its users do: the commands and the window, with a device or a booth where
//! needed.

mod booth;
mod cli;
mod enrol;
mod kinds;
mod layers;
mod play;
mod settings;
mod sound;
mod support;
mod turntable;
mod vulkan;
#[cfg(unix)]
mod window;
