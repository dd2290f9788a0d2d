//! The shell twice in one process, as when Android destroys an activity and creates another one in the same
//! process. Usage: `again FOLDER`. The first run quits with its first frames; the second one takes the test
//! commands from standard input.

use std::path::PathBuf;

use openxr as xr;
use paros_headset::start_up::StartUp;
use paros_quest::error::Error;
use paros_quest::options::ShellOptions;
use paros_quest::platform::{PlainPlatform, Platform, PlatformStatus};
use paros_quest::shell::run_shell;

/// The number of polls with a studio after which the run quits: some frames.
const POLLS: u32 = 20;

/// The host's platform, which requests the end of the first run.
#[derive(Default)]
struct QuittingPlatform {
    has_studio: bool,
    polls: u32,
}

impl Platform for QuittingPlatform {
    fn load_openxr(&mut self) -> Result<xr::Entry, Error> {
        PlainPlatform.load_openxr()
    }

    fn poll_status(&mut self) -> PlatformStatus {
        self.polls += u32::from(self.has_studio);
        PlatformStatus { quit_requested: self.polls > POLLS, ..PlatformStatus::default() }
    }

    fn note_start_up(&mut self, start: StartUp) {
        self.has_studio = start == StartUp::Ready;
    }
}

fn main() {
    let folder = std::env::args().nth(1).map(PathBuf::from);
    let first = ShellOptions { folder, ..ShellOptions::default() };
    run_shell::<128>(&mut QuittingPlatform::default(), &first).expect("a session");
    eprintln!("the first run has ended");
    let second = ShellOptions { test_commands: true, ..first };
    run_shell::<128>(&mut PlainPlatform, &second).expect("another session");
}
