//! The `paros` command in a separate folder for each test.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

use paros_core::RangeMaps;
use paros_core::limits::INTERVALS;
use paros_core::volume::BitGrid;
use paros_shell::figures::Figure;
use paros_shell::rmap;

/// The smallest solid mesh, as OBJ.
pub(crate) const TETRAHEDRON: &str =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// The volume file of the toy at 128.
pub(crate) static TOY: LazyLock<Vec<u8>> = LazyLock::new(|| rmap::encode(&rasterize_toy()));

/// Returns the toy at 128, in its own buffers: a test that locks the shared ones of `statics` would block the
/// others.
pub(crate) fn rasterize_toy() -> Box<RangeMaps<128, INTERVALS>> {
    let mut maps = Box::new(RangeMaps::new());
    Figure::Toy.rasterize_into(&mut maps, &mut Box::new(BitGrid::new()));
    maps
}

/// Copies an executable file and makes it executable. A separate process writes the copy: while this process
/// has a file open for writing, a child that another test starts inherits the descriptor, and running the
/// file fails ("text file busy").
pub(crate) fn install_program(from: &Path, to: &Path) {
    let installed = Command::new("install").arg(from).arg(to).status();
    assert!(installed.is_ok_and(|status| status.success()), "cannot install {}", to.display());
}

/// A separate folder for a test.
pub(crate) struct TestFolder(pub(crate) PathBuf);

impl TestFolder {
    pub(crate) fn new(name: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("cli-{name}"));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        TestFolder(folder)
    }

    pub(crate) fn write(&self, name: &str, bytes: impl AsRef<[u8]>) {
        fs::write(self.0.join(name), bytes).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> Vec<u8> {
        fs::read(self.0.join(name)).unwrap()
    }

    pub(crate) fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(&self.0).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    pub(crate) fn paros(&self, args: &[&str]) -> Output {
        self.command(args).output().unwrap()
    }

    pub(crate) fn command(&self, args: &[&str]) -> Command {
        let mut paros = Command::new(env!("CARGO_BIN_EXE_paros"));
        paros.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WAYLAND_SOCKET");
        paros.args(args).current_dir(&self.0).stdin(Stdio::null());
        paros
    }

    /// Runs a command that must succeed without messages on standard error. Returns its output.
    pub(crate) fn succeeds(&self, args: &[&str]) -> String {
        let output = self.paros(args);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{args:?}: {errors}");
        assert!(errors.is_empty(), "{args:?}: {errors}");
        String::from_utf8(output.stdout).unwrap()
    }

    /// Runs a command that must fail with `word` in its message, and leave no file behind.
    #[track_caller]
    pub(crate) fn refuses(&self, args: &[&str], word: &str) {
        let before = self.names();
        let output = self.paros(args);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{args:?}: {errors}");
        assert!(errors.contains(word), "{args:?} should say {word:?}: {errors}");
        assert!(!errors.contains("panicked"), "{args:?}: {errors}");
        assert!(output.stdout.is_empty(), "{args:?}");
        assert_eq!(self.names(), before, "{args:?} left something behind");
    }
}
