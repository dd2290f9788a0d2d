//! Makes the package for a Quest with only cargo and Debian's tools: no SDK, no Gradle, and an NDK only if
//! `ANDROID_NDK_HOME` names one.

mod apk;
mod content;
mod elf;
mod error;
mod icon;
mod library;
mod manifest;
mod resources;
mod signing;
mod stubs;
mod symbols;
#[cfg(test)]
mod test_support;
mod tools;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use clap::Parser;
use paros_shell::durable::{self, WriteTarget};
use paros_shell::headset::package::OPENXR_LOADER;

use crate::apk::PackageInspection;
use crate::content::OperatorContent;
use crate::error::PackageError;
use crate::manifest::{MANIFEST, MIN_API_LEVEL};
use crate::resources::Resources;
use crate::signing::SigningKey;
use crate::symbols::Symbols;
use crate::tools::Scratch;

/// Build the headset's app: a signed package (.apk) for a Quest.
#[derive(Debug, Parser)]
#[command(name = "package")]
struct PackageArgs {
    /// Package to write. By default `android/paros.apk` in cargo's target folder.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Sign with the key of this key store instead of the debug key.
    #[arg(long, value_name = "STORE", requires = "key_password")]
    key: Option<PathBuf>,
    /// Alias of the key, if the key store contains several keys.
    #[arg(long, value_name = "ALIAS", requires = "key")]
    key_alias: Option<String>,
    /// Source of the key store's password: env:NAME or file:PATH.
    #[arg(long, value_name = "WHERE", requires = "key")]
    key_password: Option<String>,
    /// Khronos' OpenXR loader for arm64, to package beside the library.
    ///
    /// The app tries this loader before those that the headset's brokers and manifest files name.
    #[arg(long, value_name = "FILE")]
    loader: Option<PathBuf>,
    /// Settings for all headsets that get the package. `paros settings template` writes a template.
    ///
    /// A settings file or the managed configuration on the headset overrides them.
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Fleet file with which the headsets enrol at a booth, as printed by `paros-booth fleet-file`.
    ///
    /// Anyone who has the package can enrol a headset.
    #[arg(long, value_name = "FILE")]
    fleet_file: Option<PathBuf>,
    /// Mesh of a hidden figure of your own; up to eight. Its file name becomes the mode's name (lion.obj:
    /// lion).
    #[arg(long, value_name = "MESH")]
    figure: Vec<PathBuf>,
    /// Package this library instead of building it.
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
}

fn main() -> ExitCode {
    match make_package(&PackageArgs::parse()) {
        Ok(report) => {
            println!("{report}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("package: {error}");
            error.exit_code()
        }
    }
}

/// Makes the package. Returns the report for standard output.
fn make_package(args: &PackageArgs) -> Result<String, PackageError> {
    let folder = library::target_folder().join("android");
    durable::make_folder(&folder).map_err(PackageError::failure)?;
    let output = args.output.clone().unwrap_or_else(|| folder.join("paros.apk"));
    let target = WriteTarget::resolve_and_check_writable(&output).map_err(PackageError::input)?;
    let loader = args.loader.as_deref().map(read_loader).transpose()?;
    let content =
        OperatorContent::read(args.settings.as_deref(), args.fleet_file.as_deref(), &args.figure)?;
    tools::check_tools(args.library.is_none())?;
    let key = match (&args.key, &args.key_password) {
        (Some(store), Some(password)) => {
            SigningKey::load_release(store, args.key_alias.as_deref(), password)?
        }
        _ => SigningKey::load_or_create_debug()?,
    };
    let library = obtain_library(args)?;

    let scratch = Scratch::within(&folder, "package")?;
    let [bare, unsigned, signed] =
        ["bare.apk", "unsigned.apk", "signed.apk"].map(|n| scratch.at(n));
    let resources = Resources::of_package(content.figure_names())?;
    manifest::compile_manifest(MANIFEST, &resources, &scratch, &bare)?;
    let mut libraries = vec![(library::NAME, library)];
    libraries.extend(loader.map(|bytes| (OPENXR_LOADER, bytes)));
    apk::write_package(&bare, &libraries, &content.into_assets()?, &unsigned)?;
    key.sign(&unsigned, &signed)?;
    let report = check_and_describe_package(&signed)?;
    target.write_file(&read_file(&signed)?).map_err(PackageError::failure)?;
    Ok(format!("{report}\n{}\n{}", output.display(), tools::adb_install_commands(&output)))
}

/// Returns the bytes of the library, which is built or given, after checking that Android can load it.
fn obtain_library(args: &PackageArgs) -> Result<Vec<u8>, PackageError> {
    let symbols = Symbols::load_all();
    let path = match &args.library {
        Some(path) => path.clone(),
        None => library::build_library(&symbols, MIN_API_LEVEL)?,
    };
    let bytes = read_file(&path)?;
    let faults = elf::find_library_faults(&bytes, &symbols, MIN_API_LEVEL);
    match (faults.is_empty(), &args.library) {
        (true, _) => Ok(bytes),
        (false, None) => Err(PackageError::Failure(describe_faults(&path, &faults))),
        (false, Some(_)) => Err(PackageError::Input(describe_faults(&path, &faults))),
    }
}

/// Reads a given loader, and checks its layout.
fn read_loader(path: &Path) -> Result<Vec<u8>, PackageError> {
    let bytes = read_file(path)?;
    match elf::find_layout_fault(&bytes) {
        None => Ok(bytes),
        Some(fault) => Err(PackageError::Input(describe_faults(path, &[fault]))),
    }
}

/// Checks the finished package. Returns its contents and its signer.
fn check_and_describe_package(package: &Path) -> Result<String, PackageError> {
    let PackageInspection { mut faults, listing } = apk::inspect_package(package)?;
    faults.extend(manifest::find_unmet_demands(package)?);
    if !faults.is_empty() {
        return Err(PackageError::Failure(describe_faults(package, &faults)));
    }
    tools::run_tool(
        "alignment's check",
        Command::new("zipalign").args(["-c", "-p", "4"]).arg(package),
    )?;
    let signer = signing::verify_and_describe_signer(package)?;
    Ok(format!("{listing}\n{signer}"))
}

fn describe_faults(path: &Path, faults: &[String]) -> String {
    format!("{}: {}", path.display(), faults.join("\n    "))
}

fn read_file(path: &Path) -> Result<Vec<u8>, PackageError> {
    fs::read(path).map_err(|e| PackageError::Input(format!("{}: {e}", path.display())))
}
