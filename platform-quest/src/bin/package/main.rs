//! Makes the package for a Quest, with cargo and Debian's tools alone: no SDK, no Gradle, and an NDK
//! only where `ANDROID_NDK_HOME` names one.

mod apk;
mod elf;
mod error;
mod library;
mod manifest;
mod signing;
mod stubs;
mod symbols;
mod tools;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

use clap::Parser;
use paros_quest::runtime;
use paros_shell::durable::{self, Target};

use crate::error::Error;
use crate::manifest::{LEAST_LEVEL, MANIFEST};
use crate::signing::Key;
use crate::symbols::Symbols;
use crate::tools::Scratch;

/// Build the headset's app: a signed package (.apk) for a Quest.
#[derive(Debug, Parser)]
#[command(name = "package")]
struct Args {
    /// Where the package goes; without it, `android/paros.apk` in cargo's target folder.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Sign with this key store rather than with the debug key.
    #[arg(long, value_name = "STORE", requires = "key_password")]
    key: Option<PathBuf>,
    /// The key's name in its store, where that holds several.
    #[arg(long, value_name = "ALIAS", requires = "key")]
    key_alias: Option<String>,
    /// Where the store's password is: env:NAME or file:PATH.
    #[arg(long, value_name = "WHERE", requires = "key")]
    key_password: Option<String>,
    /// Khronos' OpenXR loader for arm64, to be put beside the library and used instead of asking the
    /// headset's runtime broker.
    #[arg(long, value_name = "FILE")]
    loader: Option<PathBuf>,
    /// Package this library instead of building it.
    #[arg(long, value_name = "FILE")]
    library: Option<PathBuf>,
}

fn main() -> ExitCode {
    match run(&Args::parse()) {
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

fn run(args: &Args) -> Result<String, Error> {
    let folder = library::target_folder().join("android");
    durable::make_folder(&folder).map_err(Error::failure)?;
    let output = args.output.clone().unwrap_or_else(|| folder.join("paros.apk"));
    let target = Target::tried(&output).map_err(Error::input)?;
    let loader = args.loader.as_deref().map(loader).transpose()?;
    tools::check(args.library.is_none())?;
    let key = match (&args.key, &args.key_password) {
        (Some(store), Some(password)) => Key::release(store, args.key_alias.as_deref(), password)?,
        _ => Key::debug()?,
    };
    let library = library(args)?;

    let scratch = Scratch::within(&folder, "package")?;
    let [bare, unsigned, signed] =
        ["bare.apk", "unsigned.apk", "signed.apk"].map(|n| scratch.at(n));
    manifest::compile(MANIFEST, &scratch, &bare)?;
    let mut libraries = vec![(library::NAME, library)];
    libraries.extend(loader.map(|bytes| (runtime::LOADER, bytes)));
    apk::write(&bare, &libraries, &unsigned)?;
    key.sign(&unsigned, &signed)?;
    let report = check(&signed)?;
    target.write(&read(&signed)?).map_err(Error::failure)?;
    Ok(format!("{report}\n{}\n{}", output.display(), tools::installation(&output)))
}

/// The bytes of the library, built or given, once Android is sure to load it.
fn library(args: &Args) -> Result<Vec<u8>, Error> {
    let symbols = Symbols::all();
    let path = match &args.library {
        Some(path) => path.clone(),
        None => library::build(&symbols, LEAST_LEVEL)?,
    };
    let bytes = read(&path)?;
    let faults = elf::faults(&bytes, &symbols, LEAST_LEVEL);
    match (faults.is_empty(), &args.library) {
        (true, _) => Ok(bytes),
        (false, None) => Err(Error::Failure(told(&path, &faults))),
        (false, Some(_)) => Err(Error::Input(told(&path, &faults))),
    }
}

/// The bytes of a loader that was given.
fn loader(path: &Path) -> Result<Vec<u8>, Error> {
    let bytes = read(path)?;
    match elf::fault(&bytes) {
        None => Ok(bytes),
        Some(fault) => Err(Error::Input(told(path, &[fault]))),
    }
}

/// What the finished package holds and who signed it, once nothing is wrong with it.
fn check(package: &Path) -> Result<String, Error> {
    let (mut faults, list) = apk::inspect(package)?;
    faults.extend(manifest::faults(package)?);
    if !faults.is_empty() {
        return Err(Error::Failure(told(package, &faults)));
    }
    tools::run("alignment's check", Command::new("zipalign").args(["-c", "-p", "4"]).arg(package))?;
    let signer = signing::verify(package)?;
    Ok(format!("{list}\n{signer}"))
}

fn told(path: &Path, faults: &[String]) -> String {
    format!("{}: {}", path.display(), faults.join("\n    "))
}

fn read(path: &Path) -> Result<Vec<u8>, Error> {
    fs::read(path).map_err(|e| Error::Input(format!("{}: {e}", path.display())))
}
