//! Mock runtimes with the restrictions of headsets' runtimes, found as on a headset. Each is a library of its
//! own, compiled from `mock.c` by the C compiler that Rust links with.

use std::ffi::c_int;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::OnceLock;
use std::{fs, ptr};

use openxr as xr;

use paros_headset::runtime::{
    BROKERS, Candidate, ContentRow, FoundRuntime, NoRuntime, RuntimeSearch, list_candidates,
};
use paros_quest::error::Error;
use paros_quest::options::ShellOptions;
use paros_quest::platform::Platform;
use paros_quest::runtime::{AndroidContext, LinkedCalls, find_runtime_once};
use paros_quest::shell::run_shell;

/// A package without a loader.
const NO_LOADER: &str = "libopenxr_loader.so";

/// The numbers of calls of a mock's functions: initialisation, negotiation, instance creation, and functions
/// that no loader requests from a runtime before there is an instance.
type Counts = [c_int; 4];

fn folder() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("runtimes");
    fs::create_dir_all(&folder).expect("room on the disk");
    folder
}

/// Compiles a mock that no other test uses.
fn build_mock(name: &str, definitions: &[&str]) -> PathBuf {
    let library = folder().join(name);
    fs::create_dir_all(library.parent().expect("a folder")).expect("room on the disk");
    let source = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/runtimes/mock.c");
    let mut cc = Command::new("cc");
    cc.args(["-shared", "-fPIC", "-Wall", "-o"]).arg(&library).arg(source);
    cc.args(definitions.iter().map(|definition| format!("-D{definition}")));
    assert!(cc.status().expect("a C compiler").success(), "cc makes {}", library.display());
    library
}

fn count_calls(library: &Path) -> Counts {
    // SAFETY: it is a mock, which has no initialisers.
    let library = unsafe { libloading::Library::new(library) }.expect("a mock");
    [&b"initialized"[..], b"negotiated", b"created", b"strayed"].map(|name| {
        // SAFETY: the mock has a number of this name.
        unsafe { **library.get::<*const c_int>(name).expect("a number") }
    })
}

/// Returns calls with the context that mocks expect.
fn linked_calls() -> LinkedCalls {
    let [vm, activity] = [16, 32].map(ptr::without_provenance_mut);
    // SAFETY: mocks alone are opened, and they don't follow these pointers.
    unsafe { LinkedCalls::new(Some(AndroidContext { vm, activity })) }
}

/// Returns the candidates if the installable broker has these rows, and the device these partitions.
fn candidates(rows: &[&Path], partitions: &[&Path]) -> Vec<Candidate> {
    let text = |path: &Path| Some(path.to_str().expect("UTF-8").to_owned());
    let row = |library: &&Path| -> ContentRow {
        let name = library.file_name().expect("a name");
        vec![text(library.parent().expect("a folder")), text(name.as_ref()), None, None]
    };
    let query = |table: &str, _: &[&str]| {
        let is_asked = table.contains(BROKERS[0]) && table.ends_with("/active");
        Ok(if is_asked { rows.iter().map(row).collect() } else { vec![] })
    };
    list_candidates(NO_LOADER.as_ref(), query, partitions).collect()
}

fn find_in_rows(rows: &[&Path]) -> Result<FoundRuntime<xr::Entry>, NoRuntime> {
    RuntimeSearch::new().find_once(&mut linked_calls(), candidates(rows, &[]))
}

fn assert_works(found: Result<FoundRuntime<xr::Entry>, NoRuntime>, tried: usize) {
    let found = found.unwrap_or_else(|error| panic!("{error}"));
    assert!(found.entry.enumerate_extensions().expect("it has one").khr_vulkan_enable2);
    // The package's loader is always tried.
    assert_eq!(found.tried.len(), 1 + tried, "{:?}", found.tried);
    assert!(
        found.tried[0].to_string().starts_with("tried libopenxr_loader.so, named by the package: ")
    );
}

#[test]
fn an_exported_initialisation_goes_before_the_negotiation() {
    let mock = build_mock("exporter.so", &["EXPORTS"]);
    assert_works(find_in_rows(&[&mock]), 0);
    assert_eq!(count_calls(&mock), [1, 1, 0, 0]);
}

#[test]
fn an_initialisation_among_the_functions_goes_after_the_negotiation() {
    let mock = build_mock("plain.so", &[]);
    assert_works(find_in_rows(&[&mock]), 0);
    assert_eq!(count_calls(&mock), [1, 1, 0, 0]);
}

#[test]
fn a_runtime_is_initialised_and_negotiated_with_once() {
    let mock = build_mock("once.so", &["EXPORTS"]);
    let mut search = RuntimeSearch::new();
    for _ in 0..3 {
        let found = search.find_once(&mut linked_calls(), candidates(&[&mock], &[]));
        assert!(found.is_ok_and(|found| found.entry.enumerate_extensions().is_ok()));
    }
    assert_eq!(count_calls(&mock), [1, 1, 0, 0]);
    // A new search acts like a new process, except that the library is still initialised: it refuses.
    let why = find_in_rows(&[&mock]).err().expect("it was initialised");
    assert!(why.to_string().contains("failed: ERROR_INITIALIZATION_FAILED"), "{why}");
}

#[test]
fn a_failed_initialisation_is_told_and_never_tried_again() {
    let failing = build_mock("failing.so", &["EXPORTS", "RETURNS=-2"]);
    let link = folder().join("failing-by-another-name.so");
    let _ = fs::remove_file(&link);
    std::os::unix::fs::symlink(&failing, &link).expect("room on the disk");
    let mut search = RuntimeSearch::new();
    let why = search.find_once(&mut linked_calls(), candidates(&[&failing, &link], &[]));
    let why = why.err().expect("it fails").to_string();
    let told = |library: &Path, row| {
        let source = format!("org.khronos.openxr.runtime_broker, row {row}");
        let library = library.display();
        format!(
            "tried {library}, named by {source}: xrInitializeLoaderKHR failed: ERROR_RUNTIME_FAILURE"
        )
    };
    assert!(why.contains(&told(&failing, 1)) && why.contains(&told(&link, 2)), "{why}");
    assert!(why.contains("; tried org.khronos.openxr.system_runtime_broker: no answer"), "{why}");
    assert_eq!(count_calls(&failing), [1, 0, 0, 0]);
    // The next row is still tried.
    let other = build_mock("after-failing.so", &["EXPORTS"]);
    let found = search.find_once(&mut linked_calls(), candidates(&[&failing, &other], &[]));
    assert_works(found, 1);
    assert_eq!(count_calls(&failing), [1, 0, 0, 0]);
}

#[test]
fn a_row_that_can_t_be_opened_is_passed_over() {
    let mock = build_mock("second.so", &["EXPORTS"]);
    let found = find_in_rows(&[Path::new("/no/such/first.so"), &mock]);
    let told = found.as_ref().map(|found| found.tried[1].to_string()).unwrap_or_default();
    assert_works(found, 1);
    let expected = "tried /no/such/first.so, named by org.khronos.openxr.runtime_broker, row 1: \
                    can't be opened: ";
    assert!(told.starts_with(expected) && told.contains("No such file"), "{told}");
}

#[test]
fn a_library_within_a_package_is_opened_by_the_linker() {
    // The host's linker can't load from packages, but a folder may have such a name.
    let mock = build_mock("base.apk!/lib/arm64-v8a/libx.so", &["EXPORTS"]);
    assert_works(find_in_rows(&[&mock]), 0);
    let package = folder().join("other.apk");
    fs::write(&package, "PK").expect("room on the disk");
    let within = folder().join("other.apk!/lib/arm64-v8a/libx.so");
    let why = find_in_rows(&[&within]).err().expect("there is no such folder").to_string();
    assert!(why.contains(&format!("tried {}, named by ", within.display())), "{why}");
}

#[test]
fn manifest_files_are_read_where_no_broker_answers() {
    let mock = build_mock("system/lib64/libmanifest.so", &["EXPORTS"]);
    let [odm, system] = ["odm", "system"].map(|name| folder().join(name));
    let manifests = system.join("etc/openxr/1");
    fs::create_dir_all(&manifests).expect("room on the disk");
    let text = r#"{"file_format_version": "1.0.0",
        "runtime": {"library_path": "../../../lib64/libmanifest.so"}}"#;
    fs::write(manifests.join("active_runtime.json"), text).expect("room on the disk");
    let find = |partitions: &[&Path]| {
        RuntimeSearch::new().find_once(&mut linked_calls(), candidates(&[], partitions))
    };
    assert_works(find(&[&odm, &system]), BROKERS.len());
    assert_eq!(count_calls(&mock), [1, 1, 0, 0]);
    let why = find(&[&odm]).err().expect("there is none").to_string();
    assert!(why.contains(&format!(" of {}: there is no such file", odm.display())), "{why}");
}

#[test]
fn a_packaged_loader_is_initialised_and_asked_before_brokers() {
    let loader = build_mock("loader.so", &["LOADER", "EXPORTS"]);
    let nobody = |_: &str, _: &[&str]| panic!("no broker is asked");
    let candidates = list_candidates(&loader, nobody, &[] as &[&str]);
    let found = RuntimeSearch::new().find_once(&mut linked_calls(), candidates);
    assert!(found.is_ok_and(|found| found.entry.enumerate_extensions().is_ok()));
    // Any function may be requested from a loader.
    let [initialized, negotiated, ..] = count_calls(&loader);
    assert_eq!([initialized, negotiated], [1, 0]);
}

/// A platform whose runtime loses every instance.
struct LosingPlatform;

static LOSING: OnceLock<PathBuf> = OnceLock::new();

impl Platform for LosingPlatform {
    fn load_openxr(&mut self) -> Result<xr::Entry, Error> {
        let mock = LOSING.get_or_init(|| build_mock("losing.so", &["EXPORTS"]));
        let found = find_runtime_once(&mut linked_calls(), candidates(&[mock], &[]));
        found.map(|found| found.entry).map_err(|error| Error::Unavailable(error.to_string()))
    }
}

#[test]
fn sessions_are_lost_and_the_runtime_is_kept() {
    let folder = folder().join("files");
    // Remove the failed starts of an earlier run, which would delay this one.
    let _ = std::fs::remove_dir_all(&folder);
    let options = ShellOptions { folder: Some(folder), ..ShellOptions::default() };
    let end = run_shell::<128>(&mut LosingPlatform, &options);
    let why = end.expect_err("every session is lost").to_string();
    assert_eq!(why, "OpenXR could not make an instance: ERROR_INSTANCE_LOST");
    let [initialized, negotiated, created, strayed] =
        count_calls(LOSING.get().expect("it was tried"));
    assert!(created > 2, "{created}");
    assert_eq!([initialized, negotiated, strayed], [1, 1, 0]);
}
