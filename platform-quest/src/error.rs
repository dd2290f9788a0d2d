//! Errors that end the shell or a session.

use std::fmt;

use openxr as xr;
use paros_shaders::gpu;
use paros_shell::durable;

/// What went wrong.
#[derive(Debug)]
pub enum Error {
    /// There is nothing to run on: no loader, no runtime, no headset, or one that lacks something.
    Unavailable(String),
    /// A call of OpenXR failed.
    Call {
        /// What the call was to do, an infinitive: "make a session".
        action: &'static str,
        /// The result code.
        result: xr::sys::Result,
    },
    /// The Vulkan device or its driver.
    Gpu(gpu::Error),
    /// A file can't be written.
    File(durable::WriteError),
    /// The input is wrong: an argument, or a file's contents.
    Input(String),
}

impl Error {
    /// Whether the instance, the session or the device is lost, and may be created anew.
    #[must_use]
    pub const fn is_recoverable_loss(&self) -> bool {
        match self {
            Error::Call { result, .. } => matches!(
                *result,
                xr::sys::Result::ERROR_INSTANCE_LOST
                    | xr::sys::Result::ERROR_SESSION_LOST
                    | xr::sys::Result::ERROR_RUNTIME_FAILURE
            ),
            Error::Gpu(error) => error.is_lost(),
            Error::Unavailable(_) | Error::File(_) | Error::Input(_) => false,
        }
    }
}

impl Error {
    /// The error's text, and what an operator may do about it: the last line of the log.
    #[must_use]
    pub fn message_with_remedy(&self) -> String {
        let remedy = match self {
            Error::Call { .. } => "end what else uses the headset, or start its runtime anew",
            Error::Gpu(_) => "the headset's device must draw by Vulkan 1.1 with multiview",
            // Their text says it already, or nothing can be done.
            Error::Unavailable(_) | Error::File(_) | Error::Input(_) => return self.to_string(),
        };
        format!("{self}; {remedy}")
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Unavailable(why) | Error::Input(why) => f.write_str(why),
            Error::Call { action, result } => write!(f, "OpenXR could not {action}: {result:?}"),
            Error::Gpu(error) => error.fmt(f),
            Error::File(error) => error.fmt(f),
        }
    }
}

impl std::error::Error for Error {}

impl From<gpu::Error> for Error {
    fn from(error: gpu::Error) -> Self {
        Error::Gpu(error)
    }
}

impl From<durable::WriteError> for Error {
    fn from(error: durable::WriteError) -> Self {
        Error::File(error)
    }
}

/// Adds to a failed call's result what the call was to do.
pub(crate) trait CallContext<T> {
    fn could_not(self, action: &'static str) -> Result<T, Error>;
}

impl<T> CallContext<T> for xr::Result<T> {
    fn could_not(self, action: &'static str) -> Result<T, Error> {
        self.map_err(|result| Error::Call { action, result })
    }
}
