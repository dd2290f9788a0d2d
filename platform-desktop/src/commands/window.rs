//! `paros window`: a studio to sculpt in.

use std::io::{self, Write};
use std::path::PathBuf;

use paros_shell::durable::Target;

use super::demo;
use crate::error::Error;
use crate::window::{self, Closed, Options};

/// Sculpt in a window, with mouse and keyboard.
#[derive(Debug, Default, clap::Args)]
pub(super) struct Args {
    /// A mesh or a volume to begin with.
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// The folder for finished sculptures, instead of `Paros` at home.
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Voxels along an edge: 128, or 256 for a fast machine.
    #[arg(long, default_value = "128", value_parser = ["128", "256"])]
    size: String,
    /// Write the trace of the last session to a file, when the window is closed.
    #[arg(long, value_name = "TRACE")]
    record: Option<PathBuf>,
    /// What is done instead of by hand, line by line; `-` is standard input.
    #[arg(long, value_name = "FILE", hide = true)]
    script: Option<PathBuf>,
    /// Have Vulkan's validation look on.
    #[arg(long, hide = true)]
    validation: bool,
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    open(args).map_err(|closed| match closed {
        Closed::Unavailable(why) => Error::Failure(format!("no window can be opened: {why}")),
        Closed::Failed(error) => error,
    })
}

/// The window where there can be one, else the demo.
pub(super) fn run_or_demo() -> Result<String, Error> {
    match open(&Args::default()) {
        Ok(report) => Ok(report),
        Err(Closed::Failed(error)) => Err(error),
        Err(Closed::Unavailable(why)) => {
            // Nobody may be listening there.
            let _ = writeln!(io::stderr(), "no window can be opened ({why}): here is the demo");
            demo::run(&demo::Args::default())
        }
    }
}

fn open(args: &Args) -> Result<String, Closed> {
    if let Some(record) = &args.record {
        // Before the sculpting, not after it.
        Target::tried(record).map_err(|error| Closed::Failed(error.into()))?;
    }
    let options = Options {
        file: args.file.clone(),
        folder: args.folder.clone(),
        record: args.record.clone(),
        script: args.script.clone(),
        validation: args.validation,
    };
    match &*args.size {
        "256" => window::open::<256>(&options),
        _ => window::open::<128>(&options),
    }
}
