//! The external programs that the packager needs: looks for them, names the missing ones, and runs them.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::error::PackageError;

/// The required files and programs, each with the Debian package that provides it.
const PACKAGES: [(&str, &str); 5] = [
    ("aapt2", "aapt"),
    ("zipalign", "zipalign"),
    ("apksigner", "apksigner"),
    ("keytool", "default-jre-headless"),
    (FRAMEWORK, "android-framework-res"),
];

/// The framework's resources, in which the manifest's names are looked up.
pub(crate) const FRAMEWORK: &str = "/usr/share/android-framework-res/framework-res.apk";

/// The compilation target of the library.
pub(crate) const TARGET: &str = "aarch64-linux-android";

/// Checks that everything needed for packing and signing is installed, and, if `builds_library`, for building
/// the library.
///
/// # Errors
/// All missing parts, and the commands that install them, one a line.
pub(crate) fn check_tools(builds_library: bool) -> Result<(), PackageError> {
    let missing: Vec<_> = PACKAGES
        .iter()
        .filter(|(what, _)| !is_installed(what))
        .map(|(_, package)| *package)
        .collect();
    let apt = (!missing.is_empty())
        .then(|| format!("apt install --no-install-recommends {}", missing.join(" ")));
    let toolchain = if builds_library { Toolchain::find().err() } else { None };
    let lines: Vec<String> = apt.into_iter().chain(toolchain).collect();
    if lines.is_empty() {
        return Ok(());
    }
    Err(PackageError::Failure(format!("something is missing; on Debian:\n{}", lines.join("\n"))))
}

/// Returns the commands that install a package on a headset, preceded by the one that installs `adb` if it is
/// missing.
pub(crate) fn adb_install_commands(package: &Path) -> String {
    let adb = if is_installed("adb") { "" } else { "apt install adb\n" };
    format!("{adb}adb install -r {}", package.display())
}

fn is_installed(what: &str) -> bool {
    let on_path =
        || env::split_paths(&env::var_os("PATH").unwrap_or_default()).any(contains_program(what));
    if what.starts_with('/') { Path::new(what).exists() } else { on_path() }
}

fn contains_program(program: &str) -> impl Fn(PathBuf) -> bool {
    move |folder| folder.join(program).is_file()
}

/// Logs `step` on standard error, runs a program, and returns its standard output.
///
/// # Errors
/// The program can't be started or fails; the error contains its output.
pub(crate) fn run_tool(step: &str, command: &mut Command) -> Result<String, PackageError> {
    eprintln!("{step}");
    let program = command.get_program().to_owned();
    let program = Path::new(&program).file_name().unwrap_or_default().display();
    let output = command.output().map_err(|e| PackageError::Failure(format!("{program}: {e}")))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let said =
        [output.stdout, output.stderr].map(|said| String::from_utf8_lossy(&said).into_owned());
    Err(PackageError::Failure(format!("{step}: {program} failed\n{}", said.concat().trim_end())))
}

/// Rust's own linker and the target's standard library.
#[derive(Debug)]
pub(crate) struct Toolchain {
    /// `rust-lld`, which comes with every compiler.
    pub(crate) linker: PathBuf,
}

impl Toolchain {
    /// Finds the toolchain of the current Rust compiler.
    ///
    /// # Errors
    /// The command that installs the missing part.
    pub(crate) fn find() -> Result<Self, String> {
        let add = format!("rustup target add {TARGET}");
        let rustup = |why: String| format!("{add}  # {why}: by rustup, from https://rustup.rs");
        let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let ask = |arguments: &[&str]| -> Result<String, String> {
            let output = Command::new(&rustc).args(arguments).output();
            let output = output.map_err(|e| rustup(format!("{}: {e}", rustc.display())))?;
            Ok(String::from_utf8_lossy(&output.stdout).trim_end().to_owned())
        };
        let libraries = PathBuf::from(ask(&["--print", "sysroot"])?).join("lib/rustlib");
        let version = ask(&["-vV"])?;
        let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap_or_default();
        let linker = libraries.join(host).join("bin/rust-lld");
        if !linker.is_file() {
            return Err(rustup(format!("no {}", linker.display())));
        }
        if libraries.join(TARGET).is_dir() { Ok(Toolchain { linker }) } else { Err(add) }
    }
}

/// A temporary folder, which is deleted when the value is dropped.
#[derive(Debug)]
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    /// Creates an empty folder for this process within another one.
    ///
    /// # Errors
    /// The folder can't be created or emptied.
    pub(crate) fn within(folder: &Path, name: &str) -> Result<Self, PackageError> {
        let path = folder.join(format!("{name}-{}", std::process::id()));
        let fail = |e| PackageError::Failure(format!("{}: {e}", path.display()));
        if path.exists() {
            fs::remove_dir_all(&path).map_err(fail)?;
        }
        fs::create_dir_all(&path).map_err(fail)?;
        Ok(Scratch(path))
    }

    /// Returns a path in the folder.
    pub(crate) fn at(&self, name: impl AsRef<OsStr>) -> PathBuf {
        self.0.join(name.as_ref())
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // A leftover is only rubbish in the target folder.
        let _ = fs::remove_dir_all(&self.0);
    }
}
