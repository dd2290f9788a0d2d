//! Builds the library: with an NDK if one is named, otherwise with Rust's own linker and stub libraries.

use std::env;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::error::PackageError;
use crate::stubs;
use crate::symbols::Symbols;
use crate::tools::{TARGET, Toolchain};

/// The library's file name, which `System.loadLibrary` derives from `paros_quest` in the manifest.
pub(crate) const NAME: &str = "libparos_quest.so";

/// The linker's arguments besides the library folders: every symbol must be resolved, no other library
/// replaces own symbols, segments are aligned for pages of 16 KiB, and the file has a build ID.
pub(crate) const LINK_ARGUMENTS: [&str; 6] = [
    "-zdefs",
    "-Bsymbolic",
    "-zmax-page-size=16384",
    "--hash-style=both",
    "--build-id=sha1",
    "-soname=libparos_quest.so",
];

/// Returns the folder of the whole project.
fn workspace_folder() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).ancestors().nth(2).unwrap_or(Path::new("/"))
}

/// Returns cargo's build folder: `CARGO_TARGET_DIR`, or `target` in the project.
pub(crate) fn target_folder() -> PathBuf {
    let folder = env::var_os("CARGO_TARGET_DIR").map_or_else(|| "target".into(), PathBuf::from);
    workspace_folder().join(folder)
}

/// Builds the library in release mode for an API level. Returns its path.
///
/// # Errors
/// A tool is missing, or the library does not compile or link.
pub(crate) fn build_library(symbols: &Symbols, api_level: u32) -> Result<PathBuf, PackageError> {
    let target = target_folder();
    let stubs = target.join("android/stubs");
    let toolchain = Toolchain::find().map_err(PackageError::Failure)?;
    let linker = match env::var_os("ANDROID_NDK_HOME").filter(|path| !path.is_empty()) {
        Some(ndk) => Linker::Ndk(find_clang(Path::new(&ndk), api_level)?),
        None => {
            stubs::write_stub_libraries(symbols, api_level, &toolchain.linker, &stubs)?;
            Linker::Rust { lld: toolchain.linker, stubs }
        }
    };
    eprintln!("library");
    let cargo = env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let status = Command::new(&cargo)
        .current_dir(workspace_folder())
        .args(["rustc", "--release", "--package", "paros-quest", "--lib", "--crate-type", "cdylib"])
        .args(["--target", TARGET, "--target-dir"])
        .arg(&target)
        // Generic code of several crates is compiled once, so that the package stays within its size limit.
        .env("CARGO_PROFILE_RELEASE_LTO", "fat")
        .env("CARGO_PROFILE_RELEASE_CODEGEN_UNITS", "1")
        .env("CARGO_ENCODED_RUSTFLAGS", linker.compiler_flags().join("\u{1f}".as_ref()))
        .status()
        .map_err(|e| PackageError::Failure(format!("{}: {e}", cargo.display())))?;
    if !status.success() {
        return Err(PackageError::Failure("the library was not built".into()));
    }
    Ok(target.join(TARGET).join("release").join(NAME))
}

/// The linker of the library.
#[derive(Debug)]
enum Linker {
    /// The NDK's compiler for an API level, which knows where its libraries are.
    Ndk(PathBuf),
    /// Rust's own linker, and the folder of the stub libraries.
    Rust { lld: PathBuf, stubs: PathBuf },
}

impl Linker {
    /// Returns the compiler's flags, which also keep this machine's paths out of the library.
    fn compiler_flags(&self) -> Vec<OsString> {
        let mut flags: Vec<OsString> = vec!["-Cstrip=symbols".into()];
        let mut flag = |name: &str, value: &Path| {
            flags.push([name.as_ref(), value.as_os_str()].into_iter().collect());
        };
        let cargo_home = env::var_os("CARGO_HOME").map(PathBuf::from);
        let cargo_home = cargo_home.or_else(|| Some(env::home_dir()?.join(".cargo")));
        if let Some(home) = cargo_home {
            flag("--remap-path-prefix=", &home.join("registry/src=registry"));
        }
        flag("--remap-path-prefix=", &workspace_folder().join("=paros/"));
        match self {
            Linker::Ndk(clang) => {
                flag("-Clinker=", clang);
                flags.extend(
                    LINK_ARGUMENTS.map(|argument| format!("-Clink-arg=-Wl,{argument}").into()),
                );
            }
            Linker::Rust { lld, stubs } => {
                flag("-Clinker=", lld);
                flag("-Clink-arg=-L", stubs);
                flags.push("-Clinker-flavor=ld.lld".into());
                flags
                    .extend(LINK_ARGUMENTS.map(|argument| format!("-Clink-arg={argument}").into()));
            }
        }
        flags
    }
}

/// Finds the NDK's compiler driver for an API level.
fn find_clang(ndk: &Path, api_level: u32) -> Result<PathBuf, PackageError> {
    let name = format!("{TARGET}{api_level}-clang");
    let hosts = ndk.join("toolchains/llvm/prebuilt");
    let folders = hosts.read_dir().into_iter().flatten().flatten();
    let found =
        folders.map(|host| host.path().join("bin").join(&name)).find(|clang| clang.is_file());
    let ndk = ndk.display();
    found.ok_or_else(|| PackageError::Input(format!("ANDROID_NDK_HOME: {ndk}: no NDK with {name}")))
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use super::{Linker, find_clang};
    use crate::test_support::scratch_folder;

    #[test]
    fn an_ndk_links_with_the_same_arguments() {
        let ndk = scratch_folder("ndk");
        let bin = ndk.at("toolchains/llvm/prebuilt/linux-x86_64/bin");
        let why = find_clang(&ndk.at(""), 29).expect_err("it is empty").to_string();
        assert!(why.contains("aarch64-linux-android29-clang"), "{why}");
        fs::create_dir_all(&bin).expect("room on the disk");
        fs::write(bin.join("aarch64-linux-android29-clang"), "").expect("room on the disk");
        let found = find_clang(&ndk.at(""), 29).expect("it is there now");
        assert!(found.starts_with(&bin) && find_clang(&ndk.at(""), 30).is_err());
        let flags = Linker::Ndk(found).compiler_flags();
        assert!(flags.iter().any(|flag| flag == "-Clink-arg=-Wl,-zdefs"));
        let stubs =
            Linker::Rust { lld: "lld".into(), stubs: Path::new("stubs").into() }.compiler_flags();
        assert!(stubs.iter().any(|flag| flag == "-Clink-arg=-zdefs"));
        assert!(!flags.iter().any(|flag| flag == "-Clinker-flavor=ld.lld"));
    }
}
