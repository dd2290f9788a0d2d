//! Options of instance and device creation.

use std::ffi::CStr;

/// Options of instance and device creation.
#[derive(Clone, Default, Debug)]
pub struct Options {
    /// Instance extensions that the shell needs, for its window.
    pub instance_extensions: Vec<&'static CStr>,
    /// Device extensions that the shell needs, for its swapchain.
    pub device_extensions: Vec<&'static CStr>,
    /// `true` to enable the Khronos validation layer and collect its messages.
    pub validation: bool,
    /// Part of the wanted device's name, ignoring case; `None` chooses the best device.
    pub device_name: Option<String>,
    /// `true` to leave 16-bit floats unused where supported.
    pub single_precision: bool,
    /// `true` to upload by copy commands alone, without compute writes.
    pub copies_only: bool,
    /// `true` to request fragment density maps, for a format with [`TargetFormat::density_map`].
    ///
    /// [`TargetFormat::density_map`]: crate::gpu::TargetFormat::density_map
    pub density_map: bool,
    /// `true` to request fragment counts, for benchmarks.
    pub fragment_counts: bool,
    /// Replaces the device's function table, to measure calls or inject faults.
    pub device_hook: Option<fn(ash::Device) -> ash::Device>,
}
