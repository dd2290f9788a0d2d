//! Errors of a command, the exit codes that say whose fault they are, and the end of a program.

use std::fmt;
use std::io::{self, ErrorKind, Write as _};
use std::process::ExitCode;

use paros_core::convert::HeightOutOfRange;
use paros_shaders::gpu;
use paros_shell::durable;

/// Why a command did not do its work.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// What it was given is wrong: an argument, or what a file holds. Exit code 2.
    #[error("{0}")]
    Input(String),
    /// What it was given is right, but the machine would not: a full disk, say. Exit code 1.
    #[error("{0}")]
    Failure(String),
}

impl Error {
    /// Whatever is wrong with what a command was given.
    pub fn input(error: impl fmt::Display) -> Self {
        Error::Input(error.to_string())
    }

    /// Whatever the machine would not do.
    pub fn failure(error: impl fmt::Display) -> Self {
        Error::Failure(error.to_string())
    }

    /// The code for the process to end with.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Error::Input(_) => ExitCode::from(2),
            Error::Failure(_) => ExitCode::FAILURE,
        }
    }
}

/// A place where no file can be is the argument's fault; a disk that refuses is not.
impl From<durable::WriteError> for Error {
    fn from(error: durable::WriteError) -> Self {
        match error.source.kind() {
            ErrorKind::NotFound
            | ErrorKind::NotADirectory
            | ErrorKind::AlreadyExists
            | ErrorKind::InvalidFilename
            | ErrorKind::InvalidInput => Error::input(error),
            _ => Error::failure(error),
        }
    }
}

/// No Vulkan, no device that fits, a lost one, or one without memory left.
impl From<gpu::Error> for Error {
    fn from(error: gpu::Error) -> Self {
        Error::failure(error)
    }
}

impl From<HeightOutOfRange> for Error {
    fn from(HeightOutOfRange(height): HeightOutOfRange) -> Self {
        Error::Input(format!("no print can be {height} mm high"))
    }
}

/// Ends a program: prints its report to standard output, and storage warnings and the error to standard error.
/// Returns the exit code.
#[must_use]
pub fn end_program(name: &str, outcome: Result<String, Error>) -> ExitCode {
    let done = outcome.and_then(|report| write_to_stdout(&report));
    for warning in durable::take_storage_warnings() {
        let _ = writeln!(io::stderr(), "{name}: {warning}");
    }
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // Standard error may be closed; the exit code still reports the failure.
            let _ = writeln!(io::stderr(), "{name}: {error}");
            error.exit_code()
        }
    }
}

/// Writes a report to standard output. A closed pipe is no error.
fn write_to_stdout(report: &str) -> Result<(), Error> {
    let mut out = io::stdout().lock();
    match out.write_all(report.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::failure(error)),
        _ => Ok(()),
    }
}
