//! What the `paros` command is made of, as a library that tests can call.

pub mod bench;
pub mod commands;
pub mod demo;
pub mod error;
pub mod headless;
pub mod mesh;
pub mod window;
