//! Errors of the renderer.

use ash::vk;

/// An error that keeps the renderer from starting or drawing.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum Error {
    /// The Vulkan loader can't be opened.
    NoLoader(String),
    /// No physical device is suitable; one text for each, with the reason.
    NoDevice(Vec<String>),
    /// The number of density maps differs from that of images, for a format that uses them.
    NoDensityMap {
        /// Images to draw into.
        images: usize,
        /// Density maps given.
        maps: usize,
    },
    /// A Vulkan call failed.
    Call {
        /// The attempted action, an infinitive: "make a buffer".
        action: &'static str,
        /// The call's result code.
        result: vk::Result,
    },
}

impl Error {
    /// Returns `true` if the device is lost, and with it everything that was made on it.
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
            Error::Call { action, result } => {
                write!(f, "Vulkan could not {action}: {result}")
            }
        }
    }
}

impl core::error::Error for Error {}

/// Adds the attempted action to a failed call's result code.
pub(crate) trait ErrorContext<T> {
    fn could_not(self, action: &'static str) -> Result<T, Error>;
}

impl<T> ErrorContext<T> for Result<T, vk::Result> {
    fn could_not(self, action: &'static str) -> Result<T, Error> {
        self.map_err(|result| Error::Call { action, result })
    }
}
