//! Prints: the slicer that tells their time and material.

mod gcode;
mod slicer;
mod slices;

pub use slicer::SlicerOptions;

pub(crate) use slicer::Slicer;
pub(crate) use slices::slice_next;
