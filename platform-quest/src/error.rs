//! Errors that end the shell or a session.

use openxr as xr;
use paros_shaders::gpu;
use paros_shell::durable;

/// What went wrong.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// There is nothing to run on: no loader, no runtime, no headset, or one that lacks something.
    #[error("{0}")]
    Unavailable(String),
    /// A call of OpenXR failed.
    #[error("OpenXR could not {action}: {result:?}")]
    Call {
        /// What the call was to do, an infinitive: "make a session".
        action: &'static str,
        /// The result code.
        result: xr::sys::Result,
    },
    /// The Vulkan device or its driver.
    #[error(transparent)]
    Gpu(#[from] gpu::Error),
    /// A file can't be written.
    #[error(transparent)]
    File(#[from] durable::WriteError),
    /// The input is wrong: an argument, or a file's contents.
    #[error("{0}")]
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

/// Adds to a failed call's result what the call was to do.
pub(crate) trait CallContext<T> {
    fn could_not(self, action: &'static str) -> Result<T, Error>;
}

impl<T> CallContext<T> for xr::Result<T> {
    fn could_not(self, action: &'static str) -> Result<T, Error> {
        self.map_err(|result| Error::Call { action, result })
    }
}
