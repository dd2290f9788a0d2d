//! The built library that the tests put into packages.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use paros_shell::require::require_or_skip;

/// Returns the last built library, if it and the packing tools exist.
pub(crate) fn find_built_library() -> Option<PathBuf> {
    let target = env::var_os("CARGO_TARGET_DIR").map_or("target".into(), PathBuf::from);
    let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(target);
    let library = target.join("aarch64-linux-android/release/libparos_quest.so");
    let tools = ["aapt2", "zipalign", "apksigner", "keytool"];
    let starts = |tool: &&str| Command::new(tool).output().is_ok();
    let part = match (library.is_file(), tools.iter().find(|tool| !starts(tool))) {
        (_, Some(tool)) => Err(format!("no {tool}")),
        (false, None) => Err("no library for Android: cargo run -p paros-package".into()),
        (true, None) => Ok(library),
    };
    require_or_skip(part).expect("the package is made before the tests")
}
