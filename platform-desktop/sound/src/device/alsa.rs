//! ALSA's default device, through `libasound`.

use std::ffi::{c_char, c_int, c_long, c_uint, c_ulong, c_void};
use std::path::Path;
use std::ptr;

use super::library::{find_function, load_and_keep, text_of};
use super::{DeviceError, LATENCY_MICROS, OpenOutput, WriteFrames};
use crate::mixer::SAMPLE_RATE;

/// `SND_PCM_STREAM_PLAYBACK`.
const PLAYBACK: c_int = 0;
/// `SND_PCM_FORMAT_FLOAT_LE`, or `SND_PCM_FORMAT_FLOAT_BE` on big-endian machines.
const FLOAT: c_int = if cfg!(target_endian = "little") { 14 } else { 15 };
/// `SND_PCM_ACCESS_RW_INTERLEAVED`.
const INTERLEAVED: c_int = 3;

/// `snd_pcm_t`.
type Pcm = c_void;

type Open = unsafe extern "C" fn(*mut *mut Pcm, *const c_char, c_int, c_int) -> c_int;
type SetParams =
    unsafe extern "C" fn(*mut Pcm, c_int, c_int, c_uint, c_uint, c_int, c_uint) -> c_int;
type WriteInterleaved = unsafe extern "C" fn(*mut Pcm, *const c_void, c_ulong) -> c_long;
type Recover = unsafe extern "C" fn(*mut Pcm, c_int, c_int) -> c_int;
type Close = unsafe extern "C" fn(*mut Pcm) -> c_int;
type ErrorText = unsafe extern "C" fn(c_int) -> *const c_char;
/// The setter of a `snd_lib_error_handler_t`, which takes a variable number of arguments.
type SetErrorHandler = unsafe extern "C" fn(Option<unsafe extern "C" fn()>) -> c_int;

/// The functions of `libasound`.
pub(super) struct AlsaLibrary {
    open: Open,
    set_params: SetParams,
    write_interleaved: WriteInterleaved,
    recover: Recover,
    close: Close,
    error_text: ErrorText,
}

impl AlsaLibrary {
    pub(super) fn load(path: &Path) -> Result<Self, DeviceError> {
        let library = load_and_keep(path)?;
        // SAFETY: these are the types that ALSA's headers give these names.
        let functions = unsafe {
            AlsaLibrary {
                open: find_function(library, "snd_pcm_open")?,
                set_params: find_function(library, "snd_pcm_set_params")?,
                write_interleaved: find_function(library, "snd_pcm_writei")?,
                recover: find_function(library, "snd_pcm_recover")?,
                close: find_function(library, "snd_pcm_close")?,
                error_text: find_function(library, "snd_strerror")?,
            }
        };
        // SAFETY: the name stands for this type too.
        let set_handler = unsafe { find_function(library, "snd_lib_error_set_handler") };
        if let Ok(set_handler) = set_handler {
            let set_handler: SetErrorHandler = set_handler;
            // SAFETY: C's callers remove their arguments themselves, so that a function may take none of them.
            unsafe { set_handler(Some(say_nothing)) };
        }
        Ok(functions)
    }

    /// Returns the error of a function, with the library's text.
    fn error(&self, function: &'static str, error: c_int) -> DeviceError {
        // SAFETY: its texts are constants.
        let text = unsafe { text_of((self.error_text)(error), error.into()) };
        DeviceError::Failed(function, text)
    }
}

/// An error handler that prints nothing. The default one prints a dozen lines if there is no device.
unsafe extern "C" fn say_nothing() {}

impl OpenOutput for AlsaLibrary {
    fn open(&self) -> Result<Box<dyn WriteFrames + '_>, DeviceError> {
        let mut pcm = ptr::null_mut();
        // SAFETY: there is room for a pointer, and the name is a C string.
        let error = unsafe { (self.open)(&raw mut pcm, c"default".as_ptr(), PLAYBACK, 0) };
        if error < 0 {
            return Err(self.error("snd_pcm_open", error));
        }
        let output = AlsaOutput { library: self, pcm };
        let (soft_resample, latency) = (1, LATENCY_MICROS);
        // SAFETY: the device is open.
        let error = unsafe {
            (self.set_params)(pcm, FLOAT, INTERLEAVED, 2, SAMPLE_RATE, soft_resample, latency)
        };
        match error < 0 {
            true => Err(self.error("snd_pcm_set_params", error)),
            false => Ok(Box::new(output)),
        }
    }
}

/// An open device.
struct AlsaOutput<'a> {
    library: &'a AlsaLibrary,
    pcm: *mut Pcm,
}

impl WriteFrames for AlsaOutput<'_> {
    fn write(&mut self, frames: &[[f32; 2]]) -> Result<(), DeviceError> {
        let (mut left, mut is_recovered) = (frames, false);
        while !left.is_empty() {
            let (from, count) = (left.as_ptr().cast(), left.len() as c_ulong);
            // SAFETY: the device is open and takes two floats a frame, of which there are so many.
            let written = unsafe { (self.library.write_interleaved)(self.pcm, from, count) };
            match usize::try_from(written) {
                Ok(0) => return Err(DeviceError::Failed("snd_pcm_writei", "no frames".into())),
                Ok(written) => left = &left[written.min(left.len())..],
                // An underrun, or the machine was suspended: the device is recovered, once.
                Err(_) if !is_recovered => {
                    is_recovered = true;
                    self.recover(written as c_int)?;
                }
                Err(_) => return Err(self.library.error("snd_pcm_writei", written as c_int)),
            }
        }
        Ok(())
    }
}

impl AlsaOutput<'_> {
    fn recover(&self, error: c_int) -> Result<(), DeviceError> {
        let silent = 1;
        // SAFETY: the device is open.
        let error = unsafe { (self.library.recover)(self.pcm, error, silent) };
        if error < 0 { Err(self.library.error("snd_pcm_writei", error)) } else { Ok(()) }
    }
}

impl Drop for AlsaOutput<'_> {
    fn drop(&mut self) {
        // SAFETY: the device is open, and nobody uses it any more.
        unsafe { (self.library.close)(self.pcm) };
    }
}
