//! Why the shell ended other than by the visitor's wish.

use std::fmt;

use openxr as xr;
use paros_shaders::gpu;
use paros_shell::durable;

/// What went wrong.
#[derive(Debug)]
pub enum Error {
    /// There is nothing to run on: no loader, no runtime, no headset, or one that lacks something.
    Unavailable(String),
    /// A call of the runtime failed.
    Call {
        /// What was to be done.
        doing: &'static str,
        /// What the runtime said.
        result: xr::sys::Result,
    },
    /// The device or its driver.
    Gpu(gpu::Error),
    /// A file can't be written.
    File(durable::Error),
    /// What it was given is wrong: an argument, or what a file holds.
    Input(String),
}

impl Error {
    /// Whether all that was made of the runtime or the device is gone, and may be made anew.
    #[must_use]
    pub const fn is_loss(&self) -> bool {
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
    /// Why, and what a person who looks after the headset may do about it: the last line.
    #[must_use]
    pub fn with_remedy(&self) -> String {
        let remedy = match self {
            Error::Call { .. } => "end what else uses the headset, or start its runtime anew",
            Error::Gpu(_) => "the headset's device must draw by Vulkan 1.1 with multiview",
            // They say it themselves, or there is nothing to be done.
            Error::Unavailable(_) | Error::File(_) | Error::Input(_) => return self.to_string(),
        };
        format!("{self}; {remedy}")
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::Unavailable(why) | Error::Input(why) => f.write_str(why),
            Error::Call { doing, result } => write!(f, "OpenXR could not {doing}: {result:?}"),
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

impl From<durable::Error> for Error {
    fn from(error: durable::Error) -> Self {
        Error::File(error)
    }
}

/// Names what a call was to do, where it fails.
pub(crate) trait Doing<T> {
    fn doing(self, doing: &'static str) -> Result<T, Error>;
}

impl<T> Doing<T> for xr::Result<T> {
    fn doing(self, doing: &'static str) -> Result<T, Error> {
        self.map_err(|result| Error::Call { doing, result })
    }
}
