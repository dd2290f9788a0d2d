//! Runs `paros-bench` as a script does: rows with all their keys, and bad input rejected.

mod rows;
mod vulkan;

use std::process::{Command, Stdio};

/// A `paros-bench` process that does without what the machine lacks.
fn bench_command(args: &[&str]) -> Command {
    let mut bench = Command::new(env!("CARGO_BIN_EXE_paros-bench"));
    bench.args(args).stdin(Stdio::null()).env_remove("PAROS_REQUIRE");
    bench
}
