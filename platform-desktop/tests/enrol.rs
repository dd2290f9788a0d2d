//! `paros enrol`: its errors, and its result with a real booth; `paros exhibit`, which has its own booth.

use std::fs;
use std::net::TcpStream;
use std::os::unix::fs::PermissionsExt as _;
use std::process::Command;

use paros_booth_process::{BoothProcess, find_booth};
use paros_upload::enrolment::Enrolment;

use crate::support::TestFolder;

const FLEET: &str = "address = \"https://127.0.0.1:1\"\n\
    site = \"07070707070707070707070707070707\"\n\
    enrolment_token = \"0909090909090909090909090909090909090909090909090909090909090909\"\n\
    ca = \"\"\"\n-----BEGIN CERTIFICATE-----\nMAA=\n-----END CERTIFICATE-----\n\"\"\"\n";

#[test]
fn what_is_no_fleet_s_file_is_told_with_its_place() {
    let folder = TestFolder::new("enrol-refused");
    let enrol = ["enrol", "--file", "e.toml", "--fleet-file", "fleet.toml"];
    folder.refuses(&enrol, "fleet.toml: there is no such file; expected a fleet's file");
    for (from, to, told) in [
        ("https://", "http://", "fleet.toml: address: expected https:// and an address"),
        ("site = \"07", "site = \"7", "fleet.toml: site: expected 32 hexadecimal digits"),
        ("MAA=", "M", "fleet.toml: ca: expected a certificate in PEM"),
        ("address = ", "address ", "fleet.toml: line 1: expected TOML"),
    ] {
        folder.write("fleet.toml", FLEET.replacen(from, to, 1));
        folder.refuses(&enrol, told);
    }
    folder.refuses(&["enrol"], "--fleet-file");
    folder.refuses(&[&enrol[..], &["--name", "a\nb"]].concat(), "--name");
}

#[test]
fn a_booth_that_is_not_there_leaves_nothing_behind() {
    let folder = TestFolder::new("enrol-gone");
    folder.write("fleet.toml", FLEET);
    let output = folder.paros(&["enrol", "--file", "e.toml", "--fleet-file", "fleet.toml"]);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.contains("https://127.0.0.1:1: the booth isn't reached"), "{errors}");
    assert_eq!(folder.names(), ["fleet.toml"]);
}

#[test]
fn a_machine_enrols_by_a_fleet_s_file() {
    let folder = TestFolder::new("enrol-done");
    let Some(program) = find_booth() else { return };
    let booth = BoothProcess::start(&program, &folder.0, None);
    folder.write("fleet.toml", booth.make_fleet_file());
    let enrol = ["enrol", "--file", "kept/e.toml", "--fleet-file", "fleet.toml"];
    let said = folder.succeeds(&enrol);
    assert_eq!(said, format!("headset 1 of {}; kept in kept/e.toml\n", booth.address()));
    let mode = fs::metadata(folder.0.join("kept/e.toml")).expect("a file").permissions().mode();
    assert_eq!(mode & 0o777, 0o600);
    assert!(String::from_utf8(folder.read("kept/e.toml")).unwrap().contains("headset = 1\n"));
    folder.refuses(&enrol, "this machine is headset 1");
}

#[test]
fn without_a_booth_s_program_it_tells_what_builds_it() {
    let folder = TestFolder::new("exhibit-alone");
    let alone = folder.0.join("paros");
    fs::hard_link(env!("CARGO_BIN_EXE_paros"), &alone).expect("the same file system");
    let output = Command::new(&alone).arg("exhibit").current_dir(&folder.0).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{errors}");
    assert!(errors.contains("`cargo build --release -p paros-booth -p paros-desktop"), "{errors}");
    assert_eq!(folder.names(), ["paros"]);
}

/// There is no display here: the window doesn't open, and the booth ends with it.
#[test]
fn the_studio_is_enrolled_once_and_the_booth_ends_with_the_window() {
    let folder = TestFolder::new("exhibit");
    if find_booth().is_none() {
        return;
    }
    let file = folder.0.join("all/studio/paros/enrolment.toml");
    let exhibit = || {
        let arguments =
            ["exhibit", "--folder", "all", "--listen", "127.0.0.1:0", "--mails-to-files"];
        let output = folder.paros(&arguments);
        let errors = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(1), "{errors}");
        assert!(errors.contains("no window can be opened"), "{errors}");
        let said = String::from_utf8(output.stdout).expect("text");
        assert!(said.starts_with("booth: https://127.0.0.1:"), "{said}");
        for told in ["all/studio/paros/paros.toml (not there", "mails become files in "] {
            assert!(said.contains(told), "{said}");
        }
        Enrolment::read(&file).expect("whole").expect("it is enrolled")
    };
    let first = exhibit();
    let second = exhibit();
    assert_eq!((first.owner, first.token), (second.owner, second.token), "enrolled once");
    let place = second.address.trim_start_matches("https://").to_owned();
    assert!(TcpStream::connect(&place).is_err(), "the booth is still there");
}
