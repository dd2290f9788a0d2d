//! `paros bench`: names the benchmark program.

use std::ffi::OsString;

use paros_headless::Error;

/// Show the command that measures speed and size (`paros-bench`).
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(super) struct Args {
    /// Arguments of `paros-bench`.
    #[arg(value_name = "ARGUMENT", trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

/// Returns the command to run instead.
pub(super) fn run(args: &Args) -> Result<String, Error> {
    let arguments: Vec<_> = args.arguments.iter().map(|word| word.to_string_lossy()).collect();
    let command = format!("cargo run --release -p paros-bench -- {}", arguments.join(" "));
    Err(Error::Input(format!(
        "the bench is a program of its own: {}",
        command.trim_end_matches([' ', '-'])
    )))
}
