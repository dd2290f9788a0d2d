//! The `paros` command.
#![forbid(unsafe_code)]

use std::process::ExitCode;

use clap::Parser;
use paros_desktop::commands::Cli;
use paros_headless::end_program;

fn main() -> ExitCode {
    end_program("paros", Cli::parse().run())
}
