//! The error that ends the program, and its exit code.

use std::fmt;
use std::path::Path;
use std::process::ExitCode;

use paros_booth_rules::{Refusal, StoreError};

/// A failure, by its cause: wrong input or a failed operation.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// An option or a file is wrong: exit code 2.
    #[error("{0}")]
    Input(String),
    /// An operation failed: exit code 1.
    #[error("{0}")]
    Failure(String),
}

impl Error {
    /// Makes a failure of an operation.
    pub fn failure(what: impl fmt::Display, why: impl fmt::Display) -> Self {
        Error::Failure(format!("{what}: {why}"))
    }

    /// Makes a failure that concerns a file or folder.
    pub(crate) fn at(path: &Path, why: impl fmt::Display) -> Self {
        Error::failure(path.display(), why)
    }

    /// Returns the program's exit code.
    #[must_use]
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Error::Input(_) => ExitCode::from(2),
            Error::Failure(_) => ExitCode::FAILURE,
        }
    }
}

impl From<Refusal> for Error {
    fn from(refusal: Refusal) -> Self {
        match refusal {
            Refusal::Store(_) | Refusal::Files(_) => Error::Failure(refusal.to_string()),
            _ => Error::Input(refusal.to_string()),
        }
    }
}

impl From<StoreError> for Error {
    fn from(error: StoreError) -> Self {
        Error::Failure(error.to_string())
    }
}
