//! `paros booth`: runs the booth, which is a separate program beside this one.

use std::env;
use std::ffi::OsString;
use std::io::ErrorKind;
use std::os::unix::process::CommandExt as _;
use std::process::Command;

use paros_headless::Error;

/// The command that builds the booth, and a `paros` with uploads to it.
pub(crate) const BUILD_COMMAND: &str =
    "cargo build --release -p paros-booth -p paros-desktop --features paros-desktop/booth";

/// Run the booth, which stores what headsets send. It gets all arguments (see `paros booth --help`).
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(super) struct Args {
    /// Arguments of the booth's program.
    #[arg(value_name = "ARGUMENT", trailing_var_arg = true, allow_hyphen_values = true)]
    arguments: Vec<OsString>,
}

/// Replaces this process by the booth, so that signals to this process reach the booth.
pub(super) fn run(args: &Args) -> Result<String, Error> {
    let booth = env::current_exe().map_err(Error::failure)?.with_file_name("paros-booth");
    let error = Command::new(&booth).args(&args.arguments).exec();
    let booth = booth.display();
    Err(Error::failure(match error.kind() {
        ErrorKind::NotFound => {
            format!("{booth}: there is no such program; `{BUILD_COMMAND}` builds it")
        }
        _ => format!("{booth}: {error}"),
    }))
}
