//! A package that contains a fleet file.

use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use paros_shell::headset::package::FLEET_ASSET;
use paros_upload::enrolment::FleetFile;

use crate::library::find_built_library;

/// A file that is not a library.
const TEXT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("room on the disk");
    folder
}

fn fleet_text() -> String {
    let (site, token) = ("1a".repeat(16), "3c".repeat(32));
    format!(
        "# Keep it to yourself.\naddress = \"https://booth.test:8443\"\nsite = \"{site}\"\n\
         enrolment_token = \"{token}\"\n\
         ca = \"\"\"\n-----BEGIN CERTIFICATE-----\nMIIB\n-----END CERTIFICATE-----\n\"\"\"\n"
    )
}

fn run_packager(folder: &Path, fleet: &Path, library: &Path) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_package"));
    command.env("ANDROID_USER_HOME", folder).arg("--fleet-file").arg(fleet);
    command.arg("--library").arg(library).arg("-o").arg(folder.join("fleet.apk"));
    command.output().expect("it starts")
}

#[test]
fn the_fleets_file_lies_in_the_package_as_it_is() {
    let Some(library) = find_built_library() else { return };
    let folder = folder("fleet-made");
    let fleet = folder.join("ours.toml");
    fs::write(&fleet, fleet_text()).expect("room on the disk");
    let made = run_packager(&folder, &fleet, &library);
    let told = [&made.stdout, &made.stderr].map(|text| String::from_utf8_lossy(text).into_owned());
    assert!(made.status.success(), "{told:?}");
    assert!(!told.concat().contains(&"3c".repeat(32)), "a secret is told");
    let package = fs::File::open(folder.join("fleet.apk")).expect("it was made");
    let mut package = zip::ZipArchive::new(package).expect("a package");
    let mut asset = package.by_name(&format!("assets/{FLEET_ASSET}")).expect("the file");
    let mut bytes = Vec::new();
    asset.read_to_end(&mut bytes).expect("it is whole");
    assert!(bytes == fleet_text().as_bytes());
    let read = FleetFile::parse("the package", &bytes).expect("a fleet's file");
    assert_eq!(read.address, "https://booth.test:8443");
}

#[test]
fn what_is_no_fleets_file_is_refused_and_nothing_is_made() {
    let folder = folder("fleet-refused");
    let fleet = folder.join("ours.toml");
    let refuses = |text: Option<&str>, why: &str| {
        let _ = fs::remove_file(&fleet);
        if let Some(text) = text {
            fs::write(&fleet, text).expect("room on the disk");
        }
        let output = run_packager(&folder, &fleet, Path::new(TEXT));
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains(&format!("ours.toml: {why}")), "{told}");
        assert!(!folder.join("fleet.apk").exists());
    };
    let whole = fleet_text();
    refuses(None, "there is no such file");
    refuses(Some("address ="), "line 1: expected TOML");
    refuses(Some(&whole.replace("https", "http")), "address: expected https:// and an address");
    refuses(Some(&whole.replace("BEGIN", "BEGUN")), "ca: expected a certificate in PEM");
    refuses(Some(&whole.replace("3c", "3")), "enrolment_token: expected 64 hexadecimal digits");
}
