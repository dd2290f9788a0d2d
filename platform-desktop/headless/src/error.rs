//! Errors of a command, their exit codes, and the end of a program.

use std::fmt;
use std::io::{self, ErrorKind, Write as _};
use std::process::ExitCode;

use paros_core::convert::HeightOutOfRange;
use paros_shaders::gpu;
use paros_shell::durable;

/// The reason why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The input is invalid: an argument, or the contents of a file. Exit code 2.
    #[error("{0}")]
    Input(String),
    /// The input is valid, but the system failed: the disk is full, for example. Exit code 1.
    #[error("{0}")]
    Failure(String),
}

impl Error {
    /// Returns an [`Error::Input`] with the text of `error`.
    pub fn input(error: impl fmt::Display) -> Self {
        Error::Input(error.to_string())
    }

    /// Returns an [`Error::Failure`] with the text of `error`.
    pub fn failure(error: impl fmt::Display) -> Self {
        Error::Failure(error.to_string())
    }

    /// Returns the exit code of the process.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Error::Input(_) => ExitCode::from(2),
            Error::Failure(_) => ExitCode::FAILURE,
        }
    }
}

/// A path at which no file can be created is an input error; other write errors are failures.
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

/// Vulkan is missing, no device is suitable, or the device was lost or ran out of memory: a failure.
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
