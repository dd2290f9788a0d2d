//! Devices that play frames, through libraries that are loaded at run time.

#[expect(unsafe_code, reason = "calls AAudio")]
mod aaudio;
#[expect(unsafe_code, reason = "calls ALSA")]
mod alsa;
#[expect(unsafe_code, reason = "loads libraries")]
mod library;
mod speaker;

use std::fmt;
use std::path::{Path, PathBuf};

pub use speaker::Speaker;

/// An interface to sound devices.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Interface {
    /// ALSA: Linux's interface, also provided by sound servers.
    Alsa,
    /// AAudio: Android's interface, from API level 26 on.
    AAudio,
}

/// The system's default device, through a library.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SoundDevice {
    /// The interface of the library.
    pub interface: Interface,
    /// The library's name or path.
    pub library: PathBuf,
}

impl SoundDevice {
    /// Returns the device of the system for which this was built.
    #[must_use]
    pub fn of_system() -> Self {
        match cfg!(target_os = "android") {
            true => SoundDevice { interface: Interface::AAudio, library: "libaaudio.so".into() },
            false => SoundDevice { interface: Interface::Alsa, library: "libasound.so.2".into() },
        }
    }

    /// Loads the library.
    fn load(&self) -> Result<Box<dyn OpenOutput>, DeviceError> {
        let library: &Path = &self.library;
        Ok(match self.interface {
            Interface::Alsa => Box::new(alsa::AlsaLibrary::load(library)?),
            Interface::AAudio => Box::new(aaudio::AAudioLibrary::load(library)?),
        })
    }
}

/// A loaded library that can open the device.
trait OpenOutput {
    /// Opens the device at [`SAMPLE_RATE`](crate::SAMPLE_RATE).
    fn open(&self) -> Result<Box<dyn WriteFrames + '_>, DeviceError>;
}

/// An open device, which is closed when it is dropped.
trait WriteFrames {
    /// Writes frames. Blocks while there is no room for them.
    fn write(&mut self, frames: &[[f32; 2]]) -> Result<(), DeviceError>;
}

/// The length of the device's buffer, in microseconds: the delay from a tick to its sound.
const LATENCY_MICROS: u32 = 25_000;

/// The reason why a device doesn't play.
#[derive(Clone, PartialEq, Eq, Debug)]
enum DeviceError {
    /// The library can't be loaded. Holds the linker's reason.
    NoLibrary(String),
    /// The library lacks this function.
    NoFunction(&'static str),
    /// A function failed. Holds its name and the library's error text.
    Failed(&'static str, String),
}

impl fmt::Display for DeviceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            DeviceError::NoLibrary(why) => f.write_str(why),
            DeviceError::NoFunction(name) => write!(f, "the library has no {name}"),
            DeviceError::Failed(name, why) => write!(f, "{name}: {why}"),
        }
    }
}
