//! Why no package was made, and the exit code that says whose fault it is.

use std::fmt;
use std::process::ExitCode;

/// Why there is no package.
#[derive(Debug, thiserror::Error)]
pub(crate) enum PackageError {
    /// What the program was given is wrong. Exit code 2.
    #[error("{0}")]
    Input(String),
    /// The machine lacks something, or would not, or what was built is not fit. Exit code 1.
    #[error("{0}")]
    Failure(String),
}

impl PackageError {
    /// Whatever is wrong with what the program was given.
    pub(crate) fn input(why: impl fmt::Display) -> Self {
        PackageError::Input(why.to_string())
    }

    /// Whatever the machine would not do.
    pub(crate) fn failure(why: impl fmt::Display) -> Self {
        PackageError::Failure(why.to_string())
    }

    /// The code for the process to end with.
    pub(crate) fn exit_code(&self) -> ExitCode {
        match self {
            PackageError::Input(_) => ExitCode::from(2),
            PackageError::Failure(_) => ExitCode::FAILURE,
        }
    }
}
