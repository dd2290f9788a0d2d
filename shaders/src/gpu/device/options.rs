//! Options of instance and device creation.

use std::ffi::CStr;

/// Options of instance and device creation.
#[derive(Clone, Default, Debug)]
pub struct Options {
    /// Instance extensions that the shell needs, for its window.
    pub instance_extensions: Vec<&'static CStr>,
    /// Device extensions that the shell needs, for its swapchain.
    pub device_extensions: Vec<&'static CStr>,
    /// Whether the Khronos validation layer is enabled, its messages collected.
    pub validation: bool,
    /// Part of the wanted device's name, ignoring case; without it the best device is chosen.
    pub device_name: Option<String>,
    /// Whether 16-bit floats stay unused where supported.
    pub single_precision: bool,
    /// Whether to upload by copy commands alone, without compute writes.
    pub copies_only: bool,
    /// Whether fragment density maps are requested, for a format with
    /// [`TargetFormat::density_map`].
    ///
    /// [`TargetFormat::density_map`]: crate::gpu::TargetFormat::density_map
    pub density_map: bool,
    /// Whether fragment counts are requested, for benchmarks.
    pub fragment_counts: bool,
    /// Replaces the device's function table, to measure calls or inject faults.
    pub device_hook: Option<fn(ash::Device) -> ash::Device>,
}
