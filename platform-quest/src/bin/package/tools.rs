//! The programs of other packages that this one needs: found, asked for by name, run.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

use crate::error::Error;

/// What Debian calls the package that brings a file or a program.
const PACKAGES: [(&str, &str); 5] = [
    ("aapt2", "aapt"),
    ("zipalign", "zipalign"),
    ("apksigner", "apksigner"),
    ("keytool", "openjdk-17-jre-headless"),
    (FRAMEWORK, "android-framework-res"),
];

/// What the manifest's names are looked up in.
pub(crate) const FRAMEWORK: &str = "/usr/share/android-framework-res/framework-res.apk";

/// The target of the library.
pub(crate) const TARGET: &str = "aarch64-linux-android";

/// Whether all that packing and signing takes is there.
///
/// # Errors
/// What is missing, and the command that brings it.
pub(crate) fn check() -> Result<(), Error> {
    let missing: Vec<_> =
        PACKAGES.iter().filter(|(what, _)| !is_there(what)).map(|(_, package)| *package).collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(Error::Failure(format!(
        "missing: {0}; on Debian: apt install --no-install-recommends {0}",
        missing.join(" ")
    )))
}

fn is_there(what: &str) -> bool {
    let on_path = || env::split_paths(&env::var_os("PATH").unwrap_or_default()).any(has(what));
    if what.starts_with('/') { Path::new(what).exists() } else { on_path() }
}

fn has(program: &str) -> impl Fn(PathBuf) -> bool {
    move |folder| folder.join(program).is_file()
}

/// Runs a program, says so before on standard error, and hands back what it wrote.
///
/// # Errors
/// It won't start or ends in an error: what it said.
pub(crate) fn run(what: &str, command: &mut Command) -> Result<String, Error> {
    eprintln!("{what}");
    let program = command.get_program().to_owned();
    let program = Path::new(&program).file_name().unwrap_or_default().display();
    let output = command.output().map_err(|e| Error::Failure(format!("{program}: {e}")))?;
    if output.status.success() {
        return Ok(String::from_utf8_lossy(&output.stdout).into_owned());
    }
    let said =
        [output.stdout, output.stderr].map(|said| String::from_utf8_lossy(&said).into_owned());
    Err(Error::Failure(format!("{what}: {program} failed\n{}", said.concat().trim_end())))
}

/// Rust's own linker and the target's standard library.
#[derive(Debug)]
pub(crate) struct Toolchain {
    /// `rust-lld`, which comes with every compiler.
    pub(crate) linker: PathBuf,
}

impl Toolchain {
    /// The one of the compiler at hand.
    ///
    /// # Errors
    /// What is missing, and the command that brings it.
    pub(crate) fn find() -> Result<Self, Error> {
        let rustc = env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
        let ask = |arguments: &[&str]| -> Result<String, Error> {
            let output = Command::new(&rustc).args(arguments).output();
            let output = output.map_err(|e| Error::Failure(format!("{}: {e}", rustc.display())))?;
            Ok(String::from_utf8_lossy(&output.stdout).trim_end().to_owned())
        };
        let libraries = PathBuf::from(ask(&["--print", "sysroot"])?).join("lib/rustlib");
        let version = ask(&["-vV"])?;
        let host = version.lines().find_map(|line| line.strip_prefix("host: ")).unwrap_or_default();
        let linker = libraries.join(host).join("bin/rust-lld");
        if !linker.is_file() {
            return Err(Error::Failure(format!("{}: missing; rustup brings it", linker.display())));
        }
        if !libraries.join(TARGET).is_dir() {
            return Err(Error::Failure(format!("missing: rustup target add {TARGET}")));
        }
        Ok(Toolchain { linker })
    }
}

/// An empty folder that goes with the value. Nothing in it outlives the program.
#[derive(Debug)]
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    /// A folder of this process's own within another, which is made.
    ///
    /// # Errors
    /// The disk refuses.
    pub(crate) fn within(folder: &Path, name: &str) -> Result<Self, Error> {
        let path = folder.join(format!("{name}-{}", std::process::id()));
        let fail = |e| Error::Failure(format!("{}: {e}", path.display()));
        if path.exists() {
            fs::remove_dir_all(&path).map_err(fail)?;
        }
        fs::create_dir_all(&path).map_err(fail)?;
        Ok(Scratch(path))
    }

    /// A place in it.
    pub(crate) fn at(&self, name: impl AsRef<OsStr>) -> PathBuf {
        self.0.join(name.as_ref())
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        // What stays is rubbish in the target folder, no more.
        let _ = fs::remove_dir_all(&self.0);
    }
}
