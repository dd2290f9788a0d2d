//! The log of deletions: a file of lines beside the database, that is synced with each. Copied elsewhere more often than a
//! backup is made, it tells a restore what was deleted since.

use std::fs::{File, OpenOptions};
use std::io::{self, Read as _, Write as _};
use std::os::unix::fs::OpenOptionsExt as _;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use paros_booth_rules::Deletion;
use paros_shell::durable;

use crate::error::Error;

/// Its name in a booth's folder.
pub(crate) const DELETIONS: &str = "deletions";

/// A booth's log of deletions.
#[derive(Debug)]
pub(crate) struct DeletionLog {
    path: PathBuf,
    /// One after the other.
    turn: Mutex<()>,
}

impl DeletionLog {
    /// That of a folder. A line that a power cut left unfinished is removed: its deletion is logged anew.
    ///
    /// # Errors
    /// What the disk says.
    pub(crate) fn open(folder: &Path) -> io::Result<Self> {
        let path = folder.join(DELETIONS);
        let mut options = OpenOptions::new();
        let opened = options.read(true).write(true).create(true).truncate(false).mode(0o600);
        let mut file = opened.open(&path)?;
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes)?;
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        if whole < bytes.len() {
            file.set_len(whole as u64)?;
        }
        file.sync_all()?;
        File::open(folder)?.sync_all()?;
        Ok(DeletionLog { path, turn: Mutex::new(()) })
    }

    /// Adds lines.
    ///
    /// # Errors
    /// What the disk says. Then no part of them is there, as far as the disk allows that.
    pub(crate) fn append(&self, deletions: &[Deletion]) -> io::Result<()> {
        let _turn = self.turn.lock().unwrap_or_else(PoisonError::into_inner);
        let lines: String = deletions.iter().map(Deletion::to_line).collect();
        let mut file = OpenOptions::new().append(true).open(&self.path)?;
        let before = file.metadata()?.len();
        let added = file.write_all(lines.as_bytes()).and_then(|()| file.sync_data());
        if added.is_err() {
            let _ = file.set_len(before);
        }
        added
    }
}

/// Reads a log. A last line without an end is one that a power cut left, and is passed over.
///
/// # Errors
/// What the disk says, or the first line that is none of a log.
pub(crate) fn read_deletions(path: &Path) -> Result<Vec<Deletion>, Error> {
    let bad = |why: &dyn std::fmt::Display| Error::Input(format!("{}: {why}", path.display()));
    let bytes = durable::read_regular_file(path).map_err(|error| bad(&error))?;
    let text =
        String::from_utf8(bytes).map_err(|_| bad(&"expected lines of a log of deletions"))?;
    let whole = text.rfind('\n').map_or("", |last| &text[..last]);
    let lines = whole.split_terminator('\n').enumerate();
    let read = |(k, line)| {
        let expected = "expected a deletion: id, headset, hash, badge, time";
        Deletion::parse_line(line).ok_or_else(|| bad(&format!("line {}: {expected}", k + 1)))
    };
    lines.map(read).collect()
}
