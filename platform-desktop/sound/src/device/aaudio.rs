//! Android's default device, through `libaaudio`.

use std::ffi::{c_char, c_void};
use std::path::Path;
use std::ptr;

use super::library::{find_function, load_and_keep, text_of};
use super::{DeviceError, LATENCY_MICROS, OpenOutput, WriteFrames};
use crate::mixer::SAMPLE_RATE;

/// `AAUDIO_FORMAT_PCM_FLOAT`.
const FLOAT: i32 = 2;
/// `AAUDIO_PERFORMANCE_MODE_LOW_LATENCY`.
const LOW_LATENCY: i32 = 12;

/// The timeout for a device to accept frames, in nanoseconds: many times the length of its buffer.
const WRITE_TIMEOUT_NANOS: i64 = 500_000_000;

/// `AAudioStreamBuilder` and `AAudioStream`.
type Builder = c_void;
type Stream = c_void;

type CreateBuilder = unsafe extern "C" fn(*mut *mut Builder) -> i32;
type SetOption = unsafe extern "C" fn(*mut Builder, i32);
type OpenStream = unsafe extern "C" fn(*mut Builder, *mut *mut Stream) -> i32;
type OfBuilder = unsafe extern "C" fn(*mut Builder) -> i32;
type OfStream = unsafe extern "C" fn(*mut Stream) -> i32;
type SetBufferSize = unsafe extern "C" fn(*mut Stream, i32) -> i32;
type Write = unsafe extern "C" fn(*mut Stream, *const c_void, i32, i64) -> i32;
type ResultText = unsafe extern "C" fn(i32) -> *const c_char;

/// The functions of `libaaudio`.
pub(super) struct AAudioLibrary {
    create_builder: CreateBuilder,
    set_sample_rate: SetOption,
    set_channel_count: SetOption,
    set_format: SetOption,
    set_performance_mode: SetOption,
    open_stream: OpenStream,
    delete_builder: OfBuilder,
    set_buffer_size: SetBufferSize,
    request_start: OfStream,
    write: Write,
    close: OfStream,
    result_text: ResultText,
}

impl AAudioLibrary {
    pub(super) fn load(path: &Path) -> Result<Self, DeviceError> {
        let library = load_and_keep(path)?;
        // SAFETY: these are the types that Android's headers give these names.
        unsafe {
            Ok(AAudioLibrary {
                create_builder: find_function(library, "AAudio_createStreamBuilder")?,
                set_sample_rate: find_function(library, "AAudioStreamBuilder_setSampleRate")?,
                set_channel_count: find_function(library, "AAudioStreamBuilder_setChannelCount")?,
                set_format: find_function(library, "AAudioStreamBuilder_setFormat")?,
                set_performance_mode: find_function(
                    library,
                    "AAudioStreamBuilder_setPerformanceMode",
                )?,
                open_stream: find_function(library, "AAudioStreamBuilder_openStream")?,
                delete_builder: find_function(library, "AAudioStreamBuilder_delete")?,
                set_buffer_size: find_function(library, "AAudioStream_setBufferSizeInFrames")?,
                request_start: find_function(library, "AAudioStream_requestStart")?,
                write: find_function(library, "AAudioStream_write")?,
                close: find_function(library, "AAudioStream_close")?,
                result_text: find_function(library, "AAudio_convertResultToText")?,
            })
        }
    }

    /// Converts a function's negative result to an error.
    fn check(&self, function: &'static str, result: i32) -> Result<i32, DeviceError> {
        if result >= 0 {
            return Ok(result);
        }
        // SAFETY: its texts are constants.
        let text = unsafe { text_of((self.result_text)(result), result.into()) };
        Err(DeviceError::Failed(function, text))
    }

    /// Opens a playback stream of two channels of floats. A builder's default direction is playback.
    fn open_stream(&self) -> Result<*mut Stream, DeviceError> {
        let mut builder = ptr::null_mut();
        // SAFETY: there is room for a pointer.
        let created = unsafe { (self.create_builder)(&raw mut builder) };
        self.check("AAudio_createStreamBuilder", created)?;
        let mut stream = ptr::null_mut();
        // SAFETY: the builder was created, and is used up to its deletion; there is room for a pointer.
        let opened = unsafe {
            (self.set_sample_rate)(builder, SAMPLE_RATE as i32);
            (self.set_channel_count)(builder, 2);
            (self.set_format)(builder, FLOAT);
            (self.set_performance_mode)(builder, LOW_LATENCY);
            let opened = (self.open_stream)(builder, &raw mut stream);
            (self.delete_builder)(builder);
            opened
        };
        self.check("AAudioStreamBuilder_openStream", opened)?;
        Ok(stream)
    }
}

impl OpenOutput for AAudioLibrary {
    fn open(&self) -> Result<Box<dyn WriteFrames + '_>, DeviceError> {
        let output = AAudioOutput { library: self, stream: self.open_stream()? };
        let buffer = (u64::from(LATENCY_MICROS) * u64::from(SAMPLE_RATE) / 1_000_000) as i32;
        // SAFETY: the stream is open. It takes the nearest size that it has.
        unsafe { (self.set_buffer_size)(output.stream, buffer) };
        // SAFETY: the stream is open.
        let started = unsafe { (self.request_start)(output.stream) };
        self.check("AAudioStream_requestStart", started)?;
        Ok(Box::new(output))
    }
}

/// An open stream.
struct AAudioOutput<'a> {
    library: &'a AAudioLibrary,
    stream: *mut Stream,
}

impl WriteFrames for AAudioOutput<'_> {
    fn write(&mut self, frames: &[[f32; 2]]) -> Result<(), DeviceError> {
        let (mut left, name) = (frames, "AAudioStream_write");
        while !left.is_empty() {
            let (from, count) = (left.as_ptr().cast(), left.len() as i32);
            // SAFETY: the stream is open and takes two floats a frame, of which there are so many.
            let written =
                unsafe { (self.library.write)(self.stream, from, count, WRITE_TIMEOUT_NANOS) };
            // Unplugging headphones disconnects the stream.
            let written = self.library.check(name, written)? as usize;
            if written == 0 {
                return Err(DeviceError::Failed(name, "no frames in half a second".into()));
            }
            left = &left[written.min(left.len())..];
        }
        Ok(())
    }
}

impl Drop for AAudioOutput<'_> {
    fn drop(&mut self) {
        // SAFETY: the stream is open, and nobody uses it any more.
        unsafe { (self.library.close)(self.stream) };
    }
}
