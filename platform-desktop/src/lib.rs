//! The `paros` command as a library: the command line and the window.

pub mod commands;
pub mod window;
