//! The error of a failed packaging, and its exit code, which differs for wrong input.

use std::fmt;
use std::process::ExitCode;

/// The reason why there is no package.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PackageError {
    /// The input is wrong: an argument or a file. Exit code 2.
    #[error("{0}")]
    Input(String),
    /// A build tool is missing or failed, or the result is unfit. Exit code 1.
    #[error("{0}")]
    Failure(String),
}

impl PackageError {
    /// Creates an error for wrong input.
    pub(crate) fn input(why: impl fmt::Display) -> Self {
        PackageError::Input(why.to_string())
    }

    /// Creates an error for a failure of the machine or a tool.
    pub(crate) fn failure(why: impl fmt::Display) -> Self {
        PackageError::Failure(why.to_string())
    }

    /// Returns the exit code of the process.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            PackageError::Input(_) => ExitCode::from(2),
            PackageError::Failure(_) => ExitCode::FAILURE,
        }
    }
}
