//! Runs `paros-bench` as a script does: complete rows, and errors for bad input.

mod rows;
mod vulkan;

use std::env;
use std::process::{Command, Stdio};

/// Returns the command of `paros-bench`, set to skip missing dependencies. `PAROS_BENCH` names another build
/// of the program: a release build measures ten times as fast.
fn bench_command(args: &[&str]) -> Command {
    let program = env::var_os("PAROS_BENCH");
    let mut bench = Command::new(program.unwrap_or(env!("CARGO_BIN_EXE_paros-bench").into()));
    bench.args(args).stdin(Stdio::null()).env_remove("PAROS_REQUIRE");
    bench
}
