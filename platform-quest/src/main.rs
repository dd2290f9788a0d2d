//! The `paros-quest` command: the headset's shell on Linux, for any OpenXR runtime.

use std::io::{self, Write};
use std::process::ExitCode;

use clap::Parser;
use paros_quest::arguments::HeadsetArgs;
use paros_quest::error::Error;
use paros_quest::log::write_log_line;
use paros_quest::platform::PlainPlatform;
use paros_quest::shell::run_shell;
use paros_shell::durable::{WriteTarget, take_storage_warnings};
use paros_shell::replay::{ReplayError, write_replay_digests};
use paros_shell::sizes::GRID_SIDES;
use paros_shell::with_size;

fn main() -> ExitCode {
    let done = run_command(&HeadsetArgs::parse());
    for warning in take_storage_warnings() {
        write_log_line(format_args!("{warning}"));
    }
    match done {
        Ok(report) => {
            // A closed pipe is no error.
            let _ = io::stdout().lock().write_all(report.as_bytes());
            ExitCode::SUCCESS
        }
        Err(RunFailure { message, exit_code }) => {
            // Standard error may be closed; the exit code still reports the failure.
            write_log_line(format_args!("{message}"));
            exit_code
        }
    }
}

/// The message for standard error, and the exit code.
struct RunFailure {
    message: String,
    exit_code: ExitCode,
}

/// Replays a trace or runs the shell. Returns the text for standard output.
fn run_command(args: &HeadsetArgs) -> Result<String, RunFailure> {
    if let (Some(trace), Some(digests)) = (&args.replay, &args.digests) {
        write_replay_digests(trace, digests).map_err(|error| replay_failure(&error))?;
        return Ok(format!("{}: all as recorded\n", trace.display()));
    }
    let loaded = args.load_settings().map_err(|why| input_failure(&why))?;
    for line in loaded.log_lines() {
        write_log_line(format_args!("{line}"));
    }
    if let Some(record) = &args.record {
        // Fail before the session, not at its end.
        WriteTarget::resolve_and_check_writable(record)
            .map_err(|error| replay_failure(&ReplayError::Write(error)))?;
    }
    let options = args.to_options(&loaded);
    let size = loaded.settings.size.unwrap_or(GRID_SIDES[0]);
    let done = with_size!(size, N => run_shell::<N>(&mut PlainPlatform, &options));
    match done {
        Ok(printed) => Ok(printed.map_or(String::new(), |path| format!("{}\n", path.display()))),
        Err(error) => {
            let exit_code = match error {
                Error::Input(_) => ExitCode::from(2),
                _ => ExitCode::FAILURE,
            };
            Err(RunFailure { message: error.message_with_remedy(), exit_code })
        }
    }
}

fn input_failure(why: &str) -> RunFailure {
    RunFailure { message: why.into(), exit_code: ExitCode::from(2) }
}

fn replay_failure(error: &ReplayError) -> RunFailure {
    RunFailure { message: error.to_string(), exit_code: replay_exit_code(error) }
}

/// Returns the exit code of a failed replay: 2 for a path at which no file can be created, as the argument is
/// wrong; failure for other write errors.
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
