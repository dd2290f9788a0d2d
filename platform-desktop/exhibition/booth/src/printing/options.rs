//! Options of the slicer and the printers.

use std::path::PathBuf;

use clap::Args;

/// Options of the slicer and the printers.
#[derive(Clone, Debug, Default, Args)]
pub struct SlicerOptions {
    /// PrusaSlicer's program, which estimates a print's time and material; `none` disables it. By default
    /// `prusa-slicer` in PATH.
    #[arg(long, value_name = "PROGRAM")]
    pub slicer: Option<PathBuf>,
    /// File of PrusaSlicer's settings, as written by "Export Config". By default PrusaSlicer's defaults with
    /// PLA.
    #[arg(long, value_name = "FILE")]
    pub slicer_profile: Option<PathBuf>,
    /// File that names printers on the network. Staff send prints to them from the staff page.
    #[arg(long, value_name = "FILE")]
    pub printers: Option<PathBuf>,
}
