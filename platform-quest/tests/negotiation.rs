//! Negotiation with a real runtime's library: Monado's, from the tree that `monado-tree.sh` makes.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use openxr as xr;
use paros_quest::runtime::{ask, open};
use paros_shell::require::require;

/// Set to the library in the process that runs on the tree's libraries.
const INSIDE: &str = "PAROS_INSIDE_RUNTIME";

/// The tree beside this build.
fn tree() -> Result<PathBuf, String> {
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("monado-tree");
    let why = "platform-quest/tests/monado-tree.sh makes it";
    fs::canonicalize(&root).map_err(|error| format!("no {}: {error}; {why}", root.display()))
}

#[test]
fn the_library_that_a_broker_names_is_negotiated_with() {
    if let Some(library) = env::var_os(INSIDE) {
        return inside(Path::new(&library));
    }
    let Some(root) = require(tree()).expect("Monado") else { return };
    let libraries = root.join("usr/lib/x86_64-linux-gnu");
    let beside = ["", "pulseaudio", "blas", "lapack"].map(|name| libraries.join(name));
    let paths = beside.map(|path| path.display().to_string()).join(":");
    let mut again = Command::new(root.join("usr/lib64/ld-linux-x86-64.so.2"));
    again.arg("--library-path").arg(paths).arg(env::current_exe().expect("this test"));
    again.args(["--exact", "the_library_that_a_broker_names_is_negotiated_with", "--nocapture"]);
    // No service is there to be met.
    let empty = Path::new(env!("CARGO_TARGET_TMPDIR")).join("no-service");
    fs::create_dir_all(&empty).expect("room on the disk");
    again.env("XDG_RUNTIME_DIR", empty).env(INSIDE, libraries.join("libopenxr_monado.so"));
    let output = again.output().expect("it starts again");
    let told =
        [output.stdout, output.stderr].map(|told| String::from_utf8_lossy(&told).into_owned());
    let told = told.concat();
    assert!(output.status.success() && told.contains("negotiated"), "{told}");
}

/// As on a headset, but for the broker, which is this.
fn inside(library: &Path) {
    let text =
        |path: Option<&std::ffi::OsStr>| path.and_then(|path| path.to_str()).map(str::to_owned);
    let named = ask(|_, _| {
        Ok(Some([text(library.parent().map(Path::as_os_str)), text(library.file_name())]))
    });
    let named = named.expect("it is named");
    assert_eq!(named, library);
    // SAFETY: it is a runtime.
    let entry = unsafe { open(&named, &()) }.expect("it negotiates");
    let extensions = entry.enumerate_extensions().expect("it has some");
    assert!(extensions.khr_vulkan_enable2 && extensions.ext_hand_tracking);
    let application = xr::ApplicationInfo {
        application_name: "paros",
        application_version: 0,
        engine_name: "paros",
        engine_version: 0,
        api_version: xr::Version::new(1, 0, 0),
    };
    let refused = entry.create_instance(&application, &xr::ExtensionSet::default(), &[], &());
    assert!(refused.is_err(), "there is no service");
    println!("negotiated");
}
