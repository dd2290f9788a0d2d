//! Tests of the packager, run as its users run it.

mod fleet;
mod library;
mod package;
