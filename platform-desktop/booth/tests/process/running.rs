//! What a booth is told, and who else may run, while it serves.

use std::process::{Command, Output};

use crate::rig::BoothFolder;

/// Tries to serve a folder that is served.
fn start_second(folder: &BoothFolder) -> Output {
    let mut second = Command::new(env!("CARGO_BIN_EXE_paros-booth"));
    second.args(["--listen", "127.0.0.1:0", "--folder"]).arg(folder.path());
    second.output().expect("the program")
}

#[test]
fn a_second_one_in_a_folder_is_refused_until_the_first_has_ended() {
    let folder = BoothFolder::new("second");
    let mut booth = folder.start();
    let second = start_second(&folder);
    let told = String::from_utf8(second.stderr).expect("text");
    assert_eq!(second.status.code(), Some(2), "{told}");
    assert!(second.stdout.is_empty());
    let path = folder.path();
    let expected = format!("paros-booth: {}: another booth runs in this folder", path.display());
    assert!(told.starts_with(&expected), "{told}");
    assert_eq!(booth.client.get("/healthz").status, 200);
    folder.fleet_token();
    // However it ends.
    let killed = Command::new("kill").args(["-KILL", &booth.id().to_string()]).status();
    assert!(killed.expect("kill").success());
    booth.wait();
    let booth = folder.start();
    assert_eq!(booth.client.get("/healthz").status, 200);
}
