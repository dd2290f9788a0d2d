//! The `paros-bench` program: measures speed and size against the usual ways.
#![forbid(unsafe_code)]

mod command_line;

use std::process::ExitCode;

use clap::Parser;
use paros_headless::end_program;

fn main() -> ExitCode {
    end_program("paros-bench", command_line::run(&command_line::Args::parse()))
}
