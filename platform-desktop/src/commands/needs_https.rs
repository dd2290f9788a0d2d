//! `paros enrol` and `paros exhibit` in a build without HTTPS. The feature `booth` adds HTTPS: TLS takes long
//! to compile, and most studios upload nothing.

use std::ffi::OsString;

use paros_headless::Error;

use super::booth::BUILD_COMMAND;

/// Any arguments.
#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub(super) struct Args {
    /// Arguments of the command, which needs a build with HTTPS.
    #[arg(value_name = "ARGUMENT", trailing_var_arg = true, allow_hyphen_values = true)]
    _arguments: Vec<OsString>,
}

/// Returns an error with the command that builds a `paros` with HTTPS.
pub(super) fn run(_: &Args) -> Result<String, Error> {
    Err(Error::Failure(format!("this build has no HTTPS; `{BUILD_COMMAND}` adds it")))
}
