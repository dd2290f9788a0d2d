//! Support for the tests of the library for Android: what they need.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Checks that the library was built, and that the tools to run it are there, and these besides.
///
/// # Errors
/// What is missing.
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
