//! The `paros-quest` command: the headset's shell on Linux, for any OpenXR runtime.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;
use paros_quest::arguments::HeadsetArgs;
use paros_quest::error::Error;
use paros_quest::platform::PlainPlatform;
use paros_quest::shell::run_shell;
use paros_shell::durable::WriteTarget;
use paros_shell::replay::{ReplayError, write_replay_digests};
use paros_shell::with_size;

fn main() -> ExitCode {
    match run(&HeadsetArgs::parse()) {
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

fn run(args: &HeadsetArgs) -> Result<String, (String, ExitCode)> {
    if let (Some(trace), Some(digests)) = (&args.replay, &args.digests) {
        let done = write_replay_digests(trace, digests);
        done.map_err(|error| (error.to_string(), replay_exit_code(&error)))?;
        return Ok(format!("{}: all as recorded\n", trace.display()));
    }
    if let Some(record) = &args.record {
        // Before the sculpting, not after it.
        WriteTarget::resolve_and_check_writable(record).map_err(|error| {
            let error = ReplayError::Write(error);
            (error.to_string(), replay_exit_code(&error))
        })?;
    }
    let options = args.to_options();
    let done = with_size!(args.grid_size(), N => run_shell::<N>(&mut PlainPlatform, &options));
    done.map_err(|error| {
        let code = match error {
            Error::Input(_) => ExitCode::from(2),
            _ => ExitCode::FAILURE,
        };
        (error.with_remedy(), code)
    })
}

/// The exit code of a failed replay: a place where no file can be is the argument's fault, a disk that
/// refuses is not.
fn replay_exit_code(error: &ReplayError) -> ExitCode {
    let ReplayError::Write(error) = error else { return ExitCode::from(2) };
    match error.source.kind() {
        io::ErrorKind::NotFound
        | io::ErrorKind::NotADirectory
        | io::ErrorKind::AlreadyExists
        | io::ErrorKind::InvalidFilename
        | io::ErrorKind::InvalidInput => ExitCode::from(2),
        _ => ExitCode::FAILURE,
    }
}
