//! Instructions of a function's calls: this program runs itself under Callgrind, with what is
//! counted in a function of its own, and reads the totals of its many dumps.

use std::fs;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::Heard;
use crate::error::Error;

/// A folder of this process alone, gone when dropped.
pub(super) struct Folder(pub(super) PathBuf);

impl Folder {
    pub(super) fn new() -> Result<Self, Error> {
        let folder = std::env::temp_dir().join(format!("paros-bench-{}", std::process::id()));
        fs::create_dir_all(&folder)
            .map_err(|e| Error::Failure(format!("{}: can't be made: {e}", folder.display())))?;
        Ok(Folder(folder))
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Instructions of each call of a function, in order, while `bench --replay` plays `what`; or why
/// there are none.
///
/// The function is named whole: Callgrind finds no end to names with a `*` in front. It must not end
/// in a call, which would be a jump, of which Callgrind sees no end either.
///
/// What the child writes, a line for each part that it has played, `heard` hears.
pub(super) fn counts(
    function: &str,
    what: &Path,
    folder: &Folder,
    heard: Heard<'_>,
) -> Result<Vec<u64>, String> {
    let this = std::env::current_exe().map_err(|e| e.to_string())?;
    let dumps = folder.0.join("callgrind.out");
    let mut run = Command::new("valgrind")
        .args(["--tool=callgrind", "--combine-dumps=yes", "--dump-line=no", "--collect-atstart=no"])
        .args([format!("--toggle-collect={function}"), format!("--dump-after={function}")])
        .arg(format!("--callgrind-out-file={}", dumps.display()))
        .arg(this)
        .args(["bench", "--replay"])
        .arg(what)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|e| format!("valgrind can't be started: {e}"))?;
    let (parts, errors) = (run.stdout.take(), run.stderr.take());
    // Its errors are a few lines, for which the pipe has room until its parts are read.
    parts.into_iter().for_each(|parts| listen(parts, heard));
    let mut told = Vec::new();
    errors
        .map(|mut errors| errors.read_to_end(&mut told))
        .transpose()
        .map_err(|e| e.to_string())?;
    if !run.wait().map_err(|e| e.to_string())?.success() {
        let errors = String::from_utf8_lossy(&told);
        // Its own lines begin so; the program's reason is the last of the others.
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
        // The last dump, at the end of the program, holds no call.
        .filter(|&count| count > 0)
        .collect();
    if counts.is_empty() {
        return Err("valgrind counted nothing".into());
    }
    Ok(counts)
}

/// Until the child has no more to say.
fn listen(parts: impl Read, heard: Heard<'_>) {
    for line in BufReader::new(parts).lines().map_while(Result::ok) {
        // It is the bar's, and no more than that.
        if let Ok(part) = line.parse() {
            heard(part);
        }
    }
}
