//! `paros play` as a user meets it: a trace replays, and what can't be leaves nothing behind.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

use paros_core::{SessionMode, TickInput};
use paros_shell::require::require_or_skip;
use paros_shell::tick_runner;

/// A folder with `t.trace`, forty ticks of a session, `bad.trace`, whose last digest is wrong, and
/// `empty.trace`, in which no session starts.
fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("play-{name}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let recorded = |first: TickInput, more: usize| {
        tick_runner::with_fresh_world::<128, _>(|mut runner| {
            runner.start_recording();
            runner.run_tick(&first);
            (0..more).for_each(|_| runner.run_tick(&TickInput::default()));
            runner.end_recording_to_bytes().unwrap()
        })
    };
    fs::write(folder.join("empty.trace"), recorded(TickInput::default(), 0)).unwrap();
    let mut bytes =
        recorded(TickInput { start: SessionMode::FreeForm, ..TickInput::default() }, 39);
    fs::write(folder.join("t.trace"), &bytes).unwrap();
    *bytes.last_mut().unwrap() ^= 1;
    fs::write(folder.join("bad.trace"), bytes).unwrap();
    folder
}

fn play(folder: &Path, args: &[&str]) -> Output {
    let mut paros = Command::new(env!("CARGO_BIN_EXE_paros"));
    paros.arg("play").args(args).current_dir(folder).stdin(Stdio::null()).output().unwrap()
}

#[track_caller]
fn refuses(folder: &Path, args: &[&str], word: &str) {
    let count = || fs::read_dir(folder).unwrap().count();
    let before = count();
    let output = play(folder, args);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{args:?}: {errors}");
    assert!(errors.contains(word), "{args:?} should say {word:?}: {errors}");
    assert_eq!(count(), before, "{args:?} left something behind");
}

#[test]
fn a_trace_replays() {
    let folder = folder("replays");
    let args = ["t.trace", "--digests", "d", "--stl", "s.stl", "--frames", "f"];
    let output = play(&folder, &args);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(fs::read_to_string(folder.join("d")).unwrap().lines().count(), 40);
    assert!(fs::metadata(folder.join("s.stl")).unwrap().len() > 84);
    assert_eq!(fs::read_dir(folder.join("f")).unwrap().count(), 2);
}

#[test]
fn what_can_not_be_played_leaves_nothing() {
    let folder = folder("refuses");
    refuses(
        &folder,
        &["bad.trace", "--digests", "d", "--stl", "s"],
        "tick 39: another state of islands (",
    );
    refuses(&folder, &["t.trace", "--digests", "d", "--stl", "d"], "two outputs");
    refuses(&folder, &["t.trace", "--digests", "d", "--stl", "./d"], "two outputs");
    refuses(&folder, &["t.trace", "--digests", "t.trace"], "t.trace");
    let word = "empty.trace: nothing is left to print";
    refuses(&folder, &["empty.trace", "--digests", "d", "--stl", "s"], word);
    refuses(&folder, &["t.trace", "--digests", "d", "--stl", "none/s"], "none");
    refuses(&folder, &["t.trace", "--volume", "bad.trace", "--digests", "bad.trace"], "bad.trace");
    let cut = &fs::read(folder.join("t.trace")).unwrap()[..1000];
    fs::write(folder.join("cut.trace"), cut).unwrap();
    refuses(&folder, &["cut.trace", "--frames", "f"], "cut.trace");
}

/// Nobody listens: the exit code still tells.
#[test]
fn an_unwritable_standard_error_is_no_panic() {
    let full = fs::OpenOptions::new().write(true).open("/dev/full");
    let Some(full) = require_or_skip(full.map_err(|e| format!("/dev/full: {e}"))).unwrap() else {
        return;
    };
    let mut paros = Command::new(env!("CARGO_BIN_EXE_paros"));
    let status = paros.args(["info", "no.rmap"]).stderr(full).status().unwrap();
    assert_eq!(status.code(), Some(2));
}
