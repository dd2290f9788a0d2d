//! Runs the program `paros` as its users do: commands, the window, and what both need of a device or a booth.

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
