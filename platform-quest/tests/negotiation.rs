//! Negotiation with the library of a real runtime, Monado, from the tree that `monado-tree.sh` makes.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use openxr as xr;
use paros_headset::runtime::{BROKERS, NEGOTIATE_FUNCTION, RuntimeSearch, query_broker};
use paros_quest::runtime::LinkedCalls;
use paros_shell::require::require_or_skip;

/// Set to the library's path in the child process, which runs on the tree's libraries.
const INSIDE: &str = "PAROS_INSIDE_RUNTIME";
/// Set if the broker names another negotiation function.
const RENAMED: &str = "PAROS_RENAMED";

/// Finds the folder `monado-tree` beside this build.
fn find_tree() -> Result<PathBuf, String> {
    let root = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("monado-tree");
    let why = "platform-quest/tests/monado-tree.sh makes it";
    fs::canonicalize(&root).map_err(|error| format!("no {}: {error}; {why}", root.display()))
}

#[test]
fn the_library_that_a_broker_names_is_negotiated_with() {
    if let Some(library) = env::var_os(INSIDE) {
        return negotiate_as_on_a_headset(Path::new(&library));
    }
    let Some(root) = require_or_skip(find_tree()).expect("Monado") else { return };
    let libraries = root.join("usr/lib/x86_64-linux-gnu");
    let monado = libraries.join("libopenxr_monado.so");
    let rerun = |library: &Path| rerun_on_tree(&root, &libraries, library);
    assert_eq!(check_negotiation(&mut rerun(&monado)), Ok(()));
    let told =
        check_negotiation(rerun(&monado).env(RENAMED, "1")).expect_err("its names are OpenXR's");
    assert!(told.contains("no OpenXR runtime: it has no maker_negotiate"), "{told}");
    let renamed = build_renamed_runtime(&monado);
    assert_eq!(check_negotiation(rerun(&renamed).env(RENAMED, "1")), Ok(()));
}

/// Returns a command that runs this test again in a process on the tree's libraries.
fn rerun_on_tree(root: &Path, libraries: &Path, library: &Path) -> Command {
    let beside = ["", "pulseaudio", "blas", "lapack"].map(|name| libraries.join(name));
    let paths = beside.map(|path| path.display().to_string()).join(":");
    let mut again = Command::new(root.join("usr/lib64/ld-linux-x86-64.so.2"));
    again.arg("--library-path").arg(paths).arg(env::current_exe().expect("this test"));
    again.args([
        "--exact",
        "negotiation::the_library_that_a_broker_names_is_negotiated_with",
        "--nocapture",
    ]);
    // No Monado service runs here.
    let empty = Path::new(env!("CARGO_TARGET_TMPDIR")).join("no-service");
    fs::create_dir_all(&empty).expect("room on the disk");
    again.env("XDG_RUNTIME_DIR", empty).env(INSIDE, library);
    again
}

/// Runs the command. An error contains its output if the negotiation failed.
fn check_negotiation(again: &mut Command) -> Result<(), String> {
    let output = again.output().expect("it starts again");
    let told =
        [output.stdout, output.stderr].map(|told| String::from_utf8_lossy(&told).into_owned());
    let told = told.concat();
    if output.status.success() && told.contains("negotiated") { Ok(()) } else { Err(told) }
}

/// Builds a library that forwards to Monado's, with another name for the negotiation function. Needs
/// the C compiler that Rust links with.
fn build_renamed_runtime(monado: &Path) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let [source, library] = ["maker.c", "libmaker.so"].map(|name| folder.join(name));
    let text = format!(
        "int {NEGOTIATE_FUNCTION}(void *, void *);\n\
         int maker_negotiate(void *a, void *b) {{ return {NEGOTIATE_FUNCTION}(a, b); }}\n"
    );
    fs::write(&source, text).expect("room on the disk");
    let mut cc = Command::new("cc");
    cc.args(["-shared", "-fPIC", "-Wl,--allow-shlib-undefined", "-o"]).arg(&library);
    let status = cc.arg(source).arg(monado).status();
    assert!(status.is_ok_and(|status| status.success()), "cc makes {}", library.display());
    library
}

/// Negotiates as on a headset; a closure stands in for the runtime broker.
fn negotiate_as_on_a_headset(library: &Path) {
    let text = |text: &str| Some(text.to_owned());
    let folder = library.parent().and_then(Path::to_str).expect("a folder");
    let name = library.file_name().and_then(OsStr::to_str).expect("a name");
    let named = query_broker(BROKERS[0], &mut |table, _| {
        let renames = if env::var_os(RENAMED).is_some() { "1" } else { "0" };
        Ok(vec![match table.ends_with("/functions") {
            false => vec![text(folder), text(name), text("maker"), text(renames)],
            true => vec![text(NEGOTIATE_FUNCTION), text("maker_negotiate")],
        }])
    });
    // SAFETY: it is a runtime.
    let mut calls = unsafe { LinkedCalls::new(None) };
    let found = RuntimeSearch::new().find_once(&mut calls, named);
    let entry = found.unwrap_or_else(|error| panic!("{error}")).entry;
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
