//! Runs the program that makes the headset's package as its users do.

mod fleet;
mod library;
mod package;
