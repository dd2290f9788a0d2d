//! `paros booth` runs the program beside it, or names the command that builds that program.

use std::fs;
use std::process::{Command, Output};

use crate::support::{TestFolder, install_program};

/// Creates a folder with the program.
fn folder_with_paros(name: &str) -> TestFolder {
    let folder = TestFolder::new(name);
    let paros = env!("CARGO_BIN_EXE_paros");
    fs::hard_link(paros, folder.0.join("paros")).expect("the same file system");
    folder
}

fn booth(folder: &TestFolder, arguments: &[&str]) -> Output {
    Command::new(folder.0.join("paros")).arg("booth").args(arguments).output().expect("it runs")
}

#[test]
fn it_names_the_command_where_it_isnt_built() {
    let folder = folder_with_paros("booth-not-built");
    let output = booth(&folder, &["--json"]);
    assert_eq!(output.status.code(), Some(1));
    let error = String::from_utf8(output.stderr).expect("text");
    assert!(error.contains("cargo build --release -p paros-booth"), "{error}");
}

#[test]
fn it_hands_all_arguments_on_and_ends_as_the_booth_does() {
    let folder = folder_with_paros("booth-built");
    folder.write("stand-in", "#!/bin/sh\nprintf '[%s]' \"$@\"\nexit 7\n");
    install_program(&folder.0.join("stand-in"), &folder.0.join("paros-booth"));
    let output = booth(&folder, &["--help", "-x", "--folder", "a b", "--", "--json"]);
    assert_eq!(output.status.code(), Some(7));
    let told = String::from_utf8(output.stdout).expect("text");
    assert_eq!(told, "[--help][-x][--folder][a b][--][--json]");
}
