//! The `paros-quest` command: the headset's shell on Linux, for any OpenXR runtime.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use paros_core::input::Mode;
use paros_quest::error::Error;
use paros_quest::foveation::Foveation;
use paros_quest::host::Plain;
use paros_quest::options::Options;
use paros_quest::visitor::HANDOVER;
use paros_quest::{replay, shell};
use paros_shell::durable::Target;
use paros_shell::figures::Figure;

/// Sculpt in a headset, or play a recorded session again.
#[derive(Debug, Parser)]
#[command(name = "paros-quest", version)]
struct Args {
    /// Voxels along an edge: 128, or 256 for a fast machine.
    #[arg(long, default_value = "128", value_parser = ["128", "256"])]
    size: String,
    /// One folder for sessions and sculptures, instead of the user's own.
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// How sessions start: `free`, `creative`, or the name of a hidden figure.
    #[arg(long, default_value = "free", value_parser = mode)]
    mode: Mode,
    /// For how many seconds the headset must be off for who puts it on next to be another visitor:
    /// the sculpture is finished and kept, and a new session starts.
    #[arg(long, value_name = "SECONDS", default_value_t = HANDOVER.as_secs())]
    handover: u64,
    /// Write the trace of the session to a file; it starts anew.
    #[arg(long, value_name = "FILE", conflicts_with = "replay")]
    record: Option<PathBuf>,
    /// Play a trace again, as fast as it goes and without a headset; stop at the first tick that
    /// differs from the recording.
    #[arg(long, value_name = "TRACE", requires = "digests")]
    replay: Option<PathBuf>,
    /// Write every tick's digest to a file, one a line.
    #[arg(long, value_name = "FILE", requires = "replay")]
    digests: Option<PathBuf>,
    /// The display's rate, in hertz, where there is a choice.
    #[arg(long, default_value = "72")]
    rate: f32,
    /// Give the compositor depth too; pixels have one sample then.
    #[arg(long)]
    depth: bool,
    /// How coarsely pictures are shaded away from their middle: off, low, medium or high. Heat and a
    /// low battery raise it, unless it is off; without it there is none until they do.
    #[arg(long, value_name = "LEVEL", value_parser = foveation)]
    foveation: Option<Foveation>,
    /// Take commands from standard input, for tests.
    #[arg(long, hide = true)]
    script: bool,
    /// Have Vulkan's validation look on.
    #[arg(long, hide = true)]
    validation: bool,
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
        Ok(report) => {
            // A reader that has seen enough and left is no error.
            let _ = io::stdout().lock().write_all(report.as_bytes());
            ExitCode::SUCCESS
        }
        Err((why, code)) => {
            // Nobody may be listening there; the exit code still tells.
            let _ = writeln!(io::stderr(), "paros-quest: {why}");
            code
        }
    }
}

fn run(args: &Args) -> Result<String, (String, ExitCode)> {
    if let (Some(trace), Some(digests)) = (&args.replay, &args.digests) {
        let done = replay::replay(trace, digests);
        done.map_err(|error| (error.to_string(), replay_code(&error)))?;
        return Ok(format!("{}: all as recorded\n", trace.display()));
    }
    if let Some(record) = &args.record {
        // Before the sculpting, not after it.
        Target::tried(record).map_err(|error| {
            let error = replay::Error::Write(error);
            (error.to_string(), replay_code(&error))
        })?;
    }
    let options = Options {
        folder: args.folder.clone(),
        mode: args.mode,
        handover: Duration::from_secs(args.handover),
        record: args.record.clone(),
        rate: args.rate,
        depth: args.depth,
        foveation: args.foveation,
        script: args.script,
        validation: args.validation,
        ..Options::default()
    };
    let done = match &*args.size {
        "256" => shell::run::<256>(&mut Plain, &options),
        _ => shell::run::<128>(&mut Plain, &options),
    };
    done.map_err(|error| {
        let code = match error {
            Error::Input(_) => ExitCode::from(2),
            _ => ExitCode::FAILURE,
        };
        (error.with_remedy(), code)
    })
}

/// A place where no file can be is the argument's fault; a disk that refuses is not.
fn replay_code(error: &replay::Error) -> ExitCode {
    let replay::Error::Write(error) = error else { return ExitCode::from(2) };
    match error.source.kind() {
        io::ErrorKind::NotFound
        | io::ErrorKind::NotADirectory
        | io::ErrorKind::AlreadyExists
        | io::ErrorKind::InvalidFilename
        | io::ErrorKind::InvalidInput => ExitCode::from(2),
        _ => ExitCode::FAILURE,
    }
}

fn mode(name: &str) -> Result<Mode, String> {
    match name {
        "free" => Ok(Mode::FreeForm),
        "creative" => Ok(Mode::Creative),
        name => {
            let figure = Figure::HIDDEN.iter().position(|figure| figure.name() == name);
            let names: Vec<&str> = Figure::HIDDEN.iter().map(|figure| figure.name()).collect();
            let figure = figure
                .ok_or_else(|| format!("expected free, creative or one of {}", names.join(", ")))?;
            Ok(Mode::Constrained { figure: figure as u8 })
        }
    }
}

fn foveation(name: &str) -> Result<Foveation, String> {
    let found = Foveation::NAMED.into_iter().find(|(named, _)| *named == name);
    found.map(|(_, level)| level).ok_or_else(|| "expected off, low, medium or high".into())
}
