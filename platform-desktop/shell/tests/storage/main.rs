//! Tests of storages with limits: each test runs again in a process with `shim.c` preloaded, built by the C
//! compiler that Rust links with.
#![cfg(target_os = "linux")]

use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;
use std::{env, fs};

use paros_core::TickInput;
use paros_core::session::{SessionMode, commands};
use paros_core::volume::Grid;
use paros_shell::durable::{self, StorageLimit, WriteTarget, take_storage_warnings};
use paros_shell::statics::Resident;
use paros_shell::studio::{Notice, Studio};
use paros_shell::studio_paths::StudioPaths;

/// The environment variable that is set in the process with the limited storage.
const INSIDE: &str = "PAROS_INSIDE_STORAGE";

static SHIM: LazyLock<PathBuf> = LazyLock::new(|| {
    let shim = Path::new(env!("CARGO_TARGET_TMPDIR")).join("storage-shim.so");
    let mut cc = Command::new("cc");
    cc.args(["-shared", "-fPIC", "-Wall", "-o"]).arg(&shim);
    cc.arg(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/storage/shim.c"));
    assert!(cc.status().expect("a C compiler").success(), "cc makes {}", shim.display());
    shim
});

/// Runs `body` in an empty folder, in a separate process whose storage refuses the operations that `refused`
/// names.
fn on_a_storage(test: &str, refused: &str, body: impl FnOnce(&Path)) {
    if let Some(folder) = env::var_os(INSIDE) {
        return body(Path::new(&folder));
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("room on the disk");
    let mut again = Command::new(env::current_exe().expect("this test"));
    again.args(["--exact", test, "--nocapture"]).env(INSIDE, &folder);
    again.env("LD_PRELOAD", &*SHIM).env("PAROS_REFUSE", refused);
    let output = again.output().expect("it starts again");
    let told = [output.stdout, output.stderr].concat();
    let told = String::from_utf8_lossy(&told);
    assert!(output.status.success() && told.contains("1 passed"), "{told}");
}

/// Returns the sorted names in a folder.
fn list(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("a file"));
    let mut names: Vec<_> = entries.map(|it| it.file_name().display().to_string()).collect();
    names.sort();
    names
}

fn targets<'a>(folder: &Path, files: &[(&str, &'a [u8])]) -> Vec<(WriteTarget, &'a [u8])> {
    let resolve = |name: &str| WriteTarget::resolve(&folder.join(name)).expect("a place");
    files.iter().map(|(name, bytes)| (resolve(name), *bytes)).collect()
}

#[test]
fn a_folder_that_can_t_be_synced_keeps_its_files() {
    on_a_storage("a_folder_that_can_t_be_synced_keeps_its_files", "folder-sync", |folder| {
        durable::write_file(&folder.join("a"), b"old").expect("written");
        let warnings = take_storage_warnings();
        let [warning] = &warnings[..] else { panic!("{warnings:?}") };
        assert_eq!((warning.limit, &*warning.folder), (StorageLimit::UnsyncedFolder, folder));
        let expected = ": cannot sync the folder: Invalid argument (os error 22); files are written, \
                        but a loss of power may undo the last";
        assert_eq!(warning.to_string(), format!("{}{expected}", folder.display()));
        durable::write_files(&targets(folder, &[("a", b"new"), ("b", b"two")])).expect("written");
        durable::create_new_files(&targets(folder, &[("c", b"3"), ("d", b"4")])).expect("written");
        assert_eq!(list(folder), ["a", "b", "c", "d"]);
        assert_eq!(fs::read(folder.join("a")).expect("a file"), b"new");
        assert_eq!(fs::read(folder.join("d")).expect("a file"), b"4");
        assert!(take_storage_warnings().is_empty(), "it is told once");
    });
}

#[test]
fn a_storage_without_links_takes_new_files_and_replaces_none() {
    on_a_storage("a_storage_without_links_takes_new_files_and_replaces_none", "link", |folder| {
        let create = |files: &[(&str, &[u8])]| durable::create_new_files(&targets(folder, files));
        create(&[("a", b"1"), ("b", b"2")]).expect("created");
        let warnings = take_storage_warnings();
        let [warning] = &warnings[..] else { panic!("{warnings:?}") };
        let expected =
            "cannot link: Operation not permitted (os error 1); files get their names by renaming";
        assert!(warning.to_string().ends_with(expected), "{warning}");
        // Another program takes the name between its choice and the write.
        let late = targets(folder, &[("c", b"3"), ("d", b"4")]);
        std::os::unix::fs::symlink("/no/such/file", folder.join("d")).expect("a link");
        let taken = durable::create_new_files(&late).expect_err("it is taken");
        assert_eq!(taken.source.kind(), ErrorKind::AlreadyExists);
        let taken = create(&[("e", b"5"), ("b", b"6")]).expect_err("it is taken");
        assert_eq!(taken.source.kind(), ErrorKind::AlreadyExists);
        assert_eq!(list(folder), ["a", "b", "d"]);
        assert_eq!(fs::read(folder.join("b")).expect("a file"), b"2");
        create(&[("f", b"7")]).expect("created");
        assert!(take_storage_warnings().is_empty(), "it is told once");
    });
}

#[test]
fn a_visitor_s_files_are_all_kept_and_the_storage_told_once() {
    let test = "a_visitor_s_files_are_all_kept_and_the_storage_told_once";
    on_a_storage(test, "folder-sync link", |folder| {
        let (mut resident, mut stl_buffers) =
            (Grid::<128>::lock_world(), Grid::<128>::lock_stl_buffers());
        let places = StudioPaths::inside_folder(folder);
        resident.start_volumes.offer_visitor_volume().fill_block();
        let mut studio =
            Studio::new(&mut resident, &mut stl_buffers, places, |_| Ok(b"drawn".into()));
        for _ in 0..2 {
            studio.run_tick(&TickInput { start: SessionMode::Own, ..TickInput::default() });
            studio.save_session_and_wait();
            studio.run_tick(&TickInput { commands: commands::FINISH, ..TickInput::default() });
            studio.save_all_and_wait().expect("nothing failed");
        }
        assert!(studio.paths().session_file(128).exists());
        let notices: Vec<_> = studio.take_notices().collect();
        let count = |text: &str| {
            let said = notices.iter().map(|notice| match notice {
                Notice::Good(said) | Notice::Bad(said) => said,
            });
            said.filter(|said| said.contains(text)).count()
        };
        assert_eq!(count("cannot sync the folder"), 1, "{notices:?}");
        assert_eq!(count("cannot link"), 1, "{notices:?}");
        let [first, second] = ["sculpture-001", "sculpture-002"]
            .map(|stem| ["stl", "rmap", "png"].map(|extension| format!("{stem}.{extension}")));
        let mut expected = [first, second].concat();
        expected.sort();
        assert_eq!(list(&studio.paths().sculptures), expected);
    });
}
