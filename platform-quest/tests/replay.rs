//! The command `paros-quest --replay`, run as a process.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use paros_core::TickInput;
use paros_core::codec::trace::{HEADER_BYTES, RECORD_BYTES};
use paros_core::limits::INTERVALS;
use paros_core::session::SessionMode;
use paros_shell::tick_runner;

fn run_replay(folder: &Path, trace: &str) -> Output {
    let mut quest = Command::new(env!("CARGO_BIN_EXE_paros-quest"));
    let arguments = ["--replay", trace, "--digests", "digests"];
    quest.args(arguments).current_dir(folder).output().expect("it runs")
}

/// The error has the same lines as that of `paros play`.
#[test]
fn a_replay_that_differs_stops_at_the_tick_and_names_the_part() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("replay");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    let mut bytes = tick_runner::with_fresh_world::<128, INTERVALS, _>(|mut stage| {
        stage.start_recording();
        stage.run_tick(&TickInput { start: SessionMode::FreeForm, ..TickInput::default() });
        (1..40).for_each(|_| stage.run_tick(&TickInput::default()));
        stage.end_recording_to_bytes().expect("a recording")
    });
    fs::write(folder.join("good.trace"), &bytes).expect("room on the disk");
    // Change the digests of the second and of the last part, in a tick in the middle.
    let digests = HEADER_BYTES + 20 * RECORD_BYTES + TickInput::BYTES;
    bytes[digests + 8] ^= 1;
    bytes[digests + 24] ^= 1;
    fs::write(folder.join("bad.trace"), &bytes).expect("room on the disk");

    let bad = run_replay(&folder, "bad.trace");
    let errors = String::from_utf8_lossy(&bad.stderr);
    assert_eq!(bad.status.code(), Some(2), "{errors}");
    let line = "paros-quest: bad.trace: tick 20: another state of volume (digest ";
    assert!(errors.starts_with(line) && errors.lines().count() == 1, "{errors}");
    assert!(!folder.join("digests").exists());
    let good = run_replay(&folder, "good.trace");
    assert!(good.status.success(), "{}", String::from_utf8_lossy(&good.stderr));
    let written = fs::read_to_string(folder.join("digests")).expect("digests");
    assert_eq!(written.lines().count(), 40);
}

#[test]
fn a_file_that_is_missing_is_named_once() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("replay-nothing");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder");
    let missing = run_replay(&folder, "nofile");
    let errors = String::from_utf8_lossy(&missing.stderr);
    assert_eq!(missing.status.code(), Some(2), "{errors}");
    assert!(errors.starts_with("paros-quest: nofile: cannot read: "), "{errors}");
    assert_eq!(errors.matches("nofile").count(), 1, "{errors}");
    assert!(!folder.join("digests").exists());
}
