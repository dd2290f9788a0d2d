//! The `paros` command.
#![forbid(unsafe_code)]

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;
use paros_desktop::commands::Cli;
use paros_desktop::error::Error;

fn main() -> ExitCode {
    match Cli::parse().run().and_then(|report| print(&report)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Nobody may be listening there; the exit code still tells.
            let _ = writeln!(io::stderr(), "paros: {error}");
            error.exit_code()
        }
    }
}

/// Prints a report. A reader that has seen enough and left is no error.
fn print(report: &str) -> Result<(), Error> {
    let mut out = io::stdout().lock();
    match out.write_all(report.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::failure(error)),
        _ => Ok(()),
    }
}
