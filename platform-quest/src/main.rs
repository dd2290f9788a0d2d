//! The `paros-quest` command: the headset's shell on Linux, for any OpenXR runtime.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;
use paros_quest::arguments::Args;
use paros_quest::error::Error;
use paros_quest::host::Plain;
use paros_quest::{replay, shell};
use paros_shell::durable::Target;

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
    let options = args.options();
    let done = match args.size() {
        256 => shell::run::<256>(&mut Plain, &options),
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
