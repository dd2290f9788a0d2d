//! Instruction counts by Callgrind (Valgrind). The program starts itself under Callgrind, which collects only
//! inside a named function and writes a dump after each of its calls. The dumps' totals are the counts.

use paros_headless::Error;
use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::OnProgress;

/// A temporary folder of this process, removed when dropped.
pub(super) struct ScratchFolder(pub(super) PathBuf);

impl ScratchFolder {
    pub(super) fn new() -> Result<Self, Error> {
        let folder = std::env::temp_dir().join(format!("paros-bench-{}", std::process::id()));
        fs::create_dir_all(&folder)
            .map_err(|e| Error::Failure(format!("{}: can't be made: {e}", folder.display())))?;
        Ok(ScratchFolder(folder))
    }
}

impl Drop for ScratchFolder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Counts the instructions of each call of a function, in order, while `paros-bench --replay` plays
/// `replayed_path`. Returns the reason if nothing can be counted.
///
/// `function_path` must be the full name: Callgrind doesn't notice the end of calls for patterns with a
/// leading `*`. The function must not end in a call either, which would be compiled to a jump.
///
/// The child writes the fraction done, a line each time; `on_progress` gets it.
pub(super) fn count_instructions_per_call(
    function_path: &str,
    replayed_path: &Path,
    scratch: &ScratchFolder,
    on_progress: OnProgress<'_>,
) -> Result<Vec<u64>, String> {
    let this = std::env::current_exe().map_err(|e| e.to_string())?;
    let dumps = scratch.0.join("callgrind.out");
    let mut run = Command::new("valgrind")
        .args(["--tool=callgrind", "--combine-dumps=yes", "--dump-line=no", "--collect-atstart=no"])
        .args([
            format!("--toggle-collect={function_path}"),
            format!("--dump-after={function_path}"),
        ])
        .arg(format!("--callgrind-out-file={}", dumps.display()))
        .arg(this)
        .args(["--replay"])
        .arg(replayed_path)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| format!("valgrind can't be started: {e}"))?;
    // Valgrind's messages are a few lines, which fit in the pipe until they are read.
    run.stdout.take().into_iter().for_each(|output| forward_progress(output, on_progress));
    let run = run.wait_with_output().map_err(|e| e.to_string())?;
    if !run.status.success() {
        let errors = String::from_utf8_lossy(&run.stderr);
        // Valgrind's own lines begin with `==`. The program's error is the last of the other lines.
        let why = errors.lines().rfind(|line| !line.starts_with("=="));
        return Err(format!("valgrind failed: {}", why.unwrap_or_default()));
    }
    let file = fs::File::open(&dumps).map_err(|e| e.to_string())?;
    let counts: Vec<u64> = BufReader::new(file)
        .split(b'\n')
        .map_while(Result::ok)
        .filter_map(|line| {
            std::str::from_utf8(&line).ok()?.strip_prefix("summary: ")?.trim().parse().ok()
        })
        // The last dump, at the end of the program, contains no call.
        .filter(|&count| count > 0)
        .collect();
    if counts.is_empty() {
        return Err("valgrind counted nothing".into());
    }
    Ok(counts)
}

/// Passes on the child's progress lines, until its output ends.
fn forward_progress(output: impl Read, on_progress: OnProgress<'_>) {
    for line in BufReader::new(output).lines().map_while(Result::ok) {
        // Progress only feeds the bar: lines that are no number are skipped.
        if let Ok(part) = line.parse() {
            on_progress(part);
        }
    }
}
