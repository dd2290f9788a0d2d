//! What can keep the renderer from its work.

use ash::vk;

/// Why there is no picture.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Error {
    /// The Vulkan loader can't be opened.
    NoLoader(String),
    /// No device of this machine fits; each with what it lacks.
    NoDevice(Vec<String>),
    /// Not as many density maps as images, for a format that has them.
    NoDensityMap {
        /// Images to draw into.
        images: usize,
        /// Density maps that came with them.
        maps: usize,
    },
    /// A call failed.
    Call {
        /// What was to be done.
        doing: &'static str,
        /// What the driver said.
        result: vk::Result,
    },
}

impl Error {
    /// Whether the device is gone, and with it everything that was made on it.
    #[must_use]
    pub const fn is_lost(&self) -> bool {
        matches!(self, Error::Call { result: vk::Result::ERROR_DEVICE_LOST, .. })
    }
}

impl core::fmt::Display for Error {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Error::NoLoader(why) => write!(f, "no Vulkan loader: {why}"),
            Error::NoDevice(found) if found.is_empty() => write!(f, "Vulkan finds no device"),
            Error::NoDevice(found) => write!(f, "no Vulkan device fits: {}", found.join("; ")),
            Error::NoDensityMap { images, maps } => {
                write!(f, "{images} images to draw into came with {maps} density maps")
            }
            Error::Call { doing, result } => write!(f, "Vulkan could not {doing}: {result}"),
        }
    }
}

impl core::error::Error for Error {}

/// Names what a call was to do, where it fails.
pub(super) trait Doing<T> {
    fn doing(self, doing: &'static str) -> Result<T, Error>;
}

impl<T> Doing<T> for Result<T, vk::Result> {
    fn doing(self, doing: &'static str) -> Result<T, Error> {
        self.map_err(|result| Error::Call { doing, result })
    }
}
