//! Errors that end the shell or a session.

use openxr as xr;
use paros_shaders::gpu;
use paros_shell::durable;

/// An error of the shell or of a session.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// No loader, runtime or headset is available, or it lacks a required feature.
    #[error("{0}")]
    Unavailable(String),
    /// A call of OpenXR failed.
    #[error("OpenXR could not {action}: {result:?}")]
    Call {
        /// The purpose of the call, as an infinitive: "make a session".
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
    /// Returns `true` if the instance, the session or the device is lost, and can be recreated.
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
    /// Returns the error's text, followed by the remedy for the operator: the last line of the log.
    #[must_use]
    pub fn message_with_remedy(&self) -> String {
        let remedy = match self {
            Error::Call { .. } => "end what else uses the headset, or start its runtime anew",
            Error::Gpu(_) => "the headset's device must draw by Vulkan 1.1 with multiview",
            // Their text contains the remedy already, or there is none.
            Error::Unavailable(_) | Error::File(_) | Error::Input(_) => return self.to_string(),
        };
        format!("{self}; {remedy}")
    }
}

/// Adds the purpose of a failed call to its error.
pub(crate) trait CallContext<T> {
    fn could_not(self, action: &'static str) -> Result<T, Error>;
}

impl<T> CallContext<T> for xr::Result<T> {
    fn could_not(self, action: &'static str) -> Result<T, Error> {
        self.map_err(|result| Error::Call { action, result })
    }
}
