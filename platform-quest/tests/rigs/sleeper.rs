//! The shell on a device whose sleep and boots a test controls. Usage: `sleeper FOLDER CLOCK [TRACE]`. The
//! optional file CLOCK has the seconds for which the device has slept since it booted, and, after a space,
//! the UUID of another boot. TRACE is recorded. It runs the test commands from standard input.

use std::fs;
use std::path::PathBuf;
use std::time::Duration;

use openxr as xr;
use paros_quest::error::Error;
use paros_quest::options::ShellOptions;
use paros_quest::platform::{PlainPlatform, Platform};
use paros_quest::shell::run_shell;
use paros_shell::last_use::BootId;

/// The factor by which the boot clock is slower than the host's while the device is awake: on a busy host a
/// start may take as long as a break that ends a visit.
const SLOWNESS: u32 = 20;

/// The host's platform with a boot clock of its own.
struct SleepingPlatform {
    clock: PathBuf,
}

impl SleepingPlatform {
    fn read_clock(&self) -> (u64, Option<BootId>) {
        let text = fs::read_to_string(&self.clock).unwrap_or_default();
        let (slept, boot) = text.split_once(' ').unwrap_or((&text, ""));
        (slept.parse().unwrap_or(0), BootId::parse_uuid(boot))
    }
}

impl Platform for SleepingPlatform {
    fn load_openxr(&mut self) -> Result<xr::Entry, Error> {
        PlainPlatform.load_openxr()
    }

    fn since_boot(&self) -> Duration {
        PlainPlatform.since_boot() / SLOWNESS + Duration::from_secs(self.read_clock().0)
    }

    fn boot_id(&self) -> Option<BootId> {
        self.read_clock().1.or(PlainPlatform.boot_id())
    }
}

fn main() {
    let mut args = std::env::args().skip(1).map(PathBuf::from);
    let folder = Some(args.next().expect("a folder"));
    let mut platform = SleepingPlatform { clock: args.next().expect("a clock") };
    let record = args.next();
    // The test compares pictures, and no software device is fast enough for the full size.
    let least_resolution_percent = 100;
    let options = ShellOptions {
        folder,
        record,
        test_commands: true,
        least_resolution_percent,
        ..ShellOptions::default()
    };
    run_shell::<128>(&mut platform, &options).expect("a session");
}
