//! Prints: the slicer that estimates time and material, and printers on the network.

mod gcode;
mod options;
mod printer_file;
mod printer_link;
mod printer_thread;
mod slice_folder;
mod slicer;
mod slices;

pub use options::SlicerOptions;

pub(crate) use gcode::parse_estimate;
pub(crate) use printer_file::parse_printers;
pub(crate) use printer_link::{Activity, read_answers};
pub(crate) use printer_thread::{Printer, PrinterView, start_printers};
pub(crate) use slicer::Slicer;
pub(crate) use slices::slice_next;
