//! `replay TRACE DIGESTS`: plays a trace and writes every tick's digest, with the core and the shell alone,
//! so that a build for another processor takes seconds.

use std::path::Path;
use std::process::ExitCode;

use paros_shell::replay::write_replay_digests;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [trace, digests] = arguments.as_slice() else {
        eprintln!("replay TRACE DIGESTS");
        return ExitCode::from(2);
    };
    match write_replay_digests(Path::new(trace), Path::new(digests)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}
