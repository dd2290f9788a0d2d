//! `paros booth` becomes the program beside it, or names the command that builds that.

use std::fs::{self, Permissions};
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// One test after the other: a program that is being written is busy as long as a child that another test started in the
/// meantime has it open.
fn take_turn() -> MutexGuard<'static, ()> {
    static TURN: Mutex<()> = Mutex::new(());
    TURN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A folder with a copy of the program.
fn folder_with_paros(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("room on the disk");
    fs::copy(env!("CARGO_BIN_EXE_paros"), folder.join("paros")).expect("room on the disk");
    folder
}

fn booth(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(folder.join("paros")).arg("booth").args(arguments).output().expect("it runs")
}

#[test]
fn it_names_the_command_where_it_isnt_built() {
    let _turn = take_turn();
    let folder = folder_with_paros("booth-not-built");
    let output = booth(&folder, &["--json"]);
    assert_eq!(output.status.code(), Some(1));
    let error = String::from_utf8(output.stderr).expect("text");
    assert!(error.contains("cargo build --release -p paros-booth"), "{error}");
}

#[test]
fn it_hands_all_arguments_on_and_ends_as_the_booth_does() {
    let _turn = take_turn();
    let folder = folder_with_paros("booth-built");
    let stand_in = folder.join("paros-booth");
    fs::write(&stand_in, "#!/bin/sh\nprintf '[%s]' \"$@\"\nexit 7\n").expect("room on the disk");
    fs::set_permissions(&stand_in, Permissions::from_mode(0o755)).expect("it is ours");
    let output = booth(&folder, &["--help", "-x", "--folder", "a b", "--", "--json"]);
    assert_eq!(output.status.code(), Some(7));
    let told = String::from_utf8(output.stdout).expect("text");
    assert_eq!(told, "[--help][-x][--folder][a b][--][--json]");
}
