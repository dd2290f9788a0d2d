//! Options of the slicer and the printers.

use std::path::PathBuf;

use clap::Args;

/// Which slicer tells a print's time and material.
#[derive(Clone, Debug, Default, Args)]
pub struct SlicerOptions {
    /// PrusaSlicer's program, which tells a print's time and material; `none` for none. Otherwise it is looked for.
    #[arg(long, value_name = "PROGRAM")]
    pub slicer: Option<PathBuf>,
    /// A file of PrusaSlicer's settings, as its "Export Config" writes it. Otherwise its own defaults and PLA.
    #[arg(long, value_name = "FILE")]
    pub slicer_profile: Option<PathBuf>,
    /// A file that names printers on the network, which prints are sent to from the page.
    #[arg(long, value_name = "FILE")]
    pub printers: Option<PathBuf>,
}
