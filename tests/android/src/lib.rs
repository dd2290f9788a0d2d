//! Support for the tests of the Android library: checks that the library and the tools to run it exist.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Checks that the library is built, and that the tools to run it and `more_tools` are installed.
///
/// # Errors
/// The name of the missing part.
pub fn check_parts(more_tools: &[&str]) -> Result<(), String> {
    let tools = ["qemu-aarch64-static", "aarch64-linux-gnu-gcc", "aarch64-linux-gnu-nm"];
    let missing = |tool: &&&str| Command::new(tool).arg("--version").output().is_err();
    let target = env::var_os("CARGO_TARGET_DIR").map_or("target".into(), PathBuf::from);
    let target = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(target);
    match tools.iter().chain(more_tools).find(missing) {
        Some(tool) => Err(format!("no {tool}")),
        None if !target.join("aarch64-linux-android/release/libparos_quest.so").exists() => {
            Err("no library for Android: cargo run -p paros-package".into())
        }
        None => Ok(()),
    }
}
