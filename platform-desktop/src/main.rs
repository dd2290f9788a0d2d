//! The `paros` command.
#![forbid(unsafe_code)]

use paros_headless::Error;
use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;
use paros_desktop::commands::Cli;
use paros_shell::durable::take_storage_warnings;

fn main() -> ExitCode {
    let done = Cli::parse().run().and_then(|report| write_to_stdout(&report));
    for warning in take_storage_warnings() {
        let _ = writeln!(io::stderr(), "paros: {warning}");
    }
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Standard error may be closed; the exit code still reports the failure.
            let _ = writeln!(io::stderr(), "paros: {error}");
            error.exit_code()
        }
    }
}

/// Writes a report to standard output. A closed pipe is no error.
fn write_to_stdout(report: &str) -> Result<(), Error> {
    let mut out = io::stdout().lock();
    match out.write_all(report.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Error::failure(error)),
        _ => Ok(()),
    }
}
