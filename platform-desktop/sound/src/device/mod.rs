//! Devices that play frames, by libraries that are loaded at run time.

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

/// An interface of sound devices.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Interface {
    /// Linux', and of the sound servers that stand in for it.
    Alsa,
    /// Android's, from its API level 26 on.
    AAudio,
}

/// A device: the system's default one, by a library.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SoundDevice {
    /// What the library's functions are.
    pub interface: Interface,
    /// The library, by name or path.
    pub library: PathBuf,
}

impl SoundDevice {
    /// The device of the system that this was built for.
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

/// A loaded library, by which the device is opened.
trait OpenOutput {
    /// Opens the device at [`SAMPLE_RATE`](crate::SAMPLE_RATE).
    fn open(&self) -> Result<Box<dyn WriteFrames + '_>, DeviceError>;
}

/// A device that is open, until it is dropped.
trait WriteFrames {
    /// Writes frames, and waits while there is no room for them.
    fn write(&mut self, frames: &[[f32; 2]]) -> Result<(), DeviceError>;
}

/// How long a device may go on with what it has, in microseconds: a sound is heard that much after its tick.
const LATENCY_MICROS: u32 = 25_000;

/// Why a device doesn't play.
#[derive(Clone, PartialEq, Eq, Debug)]
enum DeviceError {
    /// The library can't be loaded, for the linker's reason.
    NoLibrary(String),
    /// The library lacks this function.
    NoFunction(&'static str),
    /// A function failed, with what the library says to it.
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
