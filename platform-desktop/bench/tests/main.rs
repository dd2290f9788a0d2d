//! Runs `paros-bench` as a script does: rows with all their keys, and bad input rejected.

mod rows;
mod vulkan;

use std::env;
use std::process::{Command, Stdio};

/// A `paros-bench` process that does without what the machine lacks. `PAROS_BENCH` names another build of the program:
/// a release build measures ten times as fast.
fn bench_command(args: &[&str]) -> Command {
    let program = env::var_os("PAROS_BENCH");
    let mut bench = Command::new(program.unwrap_or(env!("CARGO_BIN_EXE_paros-bench").into()));
    bench.args(args).stdin(Stdio::null()).env_remove("PAROS_REQUIRE");
    bench
}
