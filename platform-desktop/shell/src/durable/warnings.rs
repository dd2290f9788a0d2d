//! Warnings about limits of a storage that lose no file. Every file would meet the same limit: so each kind
//! is reported once in a process.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// A limit of a storage.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StorageLimit {
    /// A folder can't be synced: a power failure may undo the last writes.
    UnsyncedFolder,
    /// There are no hard links: files are renamed instead.
    NoLinks,
}

/// A warning about a limit that lost no file.
#[derive(Debug)]
pub struct StorageWarning {
    /// The limit.
    pub limit: StorageLimit,
    /// The folder in which it occurred first.
    pub folder: PathBuf,
    /// The system's reason.
    pub source: io::Error,
}

/// The warnings of this process: all kinds that occurred, and those that have not been taken yet.
struct Warnings {
    met: Vec<StorageLimit>,
    untold: Vec<StorageWarning>,
}

static WARNINGS: Mutex<Warnings> = Mutex::new(Warnings { met: Vec::new(), untold: Vec::new() });

/// Removes and returns the pending warnings: at most one of each kind in a process.
#[must_use]
pub fn take_storage_warnings() -> Vec<StorageWarning> {
    let mut warnings = WARNINGS.lock().unwrap_or_else(PoisonError::into_inner);
    std::mem::take(&mut warnings.untold)
}

/// Records a warning if it is the first of its kind.
pub(super) fn note(limit: StorageLimit, folder: &Path, source: io::Error) {
    let mut warnings = WARNINGS.lock().unwrap_or_else(PoisonError::into_inner);
    if !warnings.met.contains(&limit) {
        warnings.met.push(limit);
        warnings.untold.push(StorageWarning { limit, folder: folder.into(), source });
    }
}

impl fmt::Display for StorageWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let StorageWarning { limit, folder, source } = self;
        let (action, outcome) = match limit {
            StorageLimit::UnsyncedFolder => {
                ("sync the folder", "files are written, but a loss of power may undo the last")
            }
            StorageLimit::NoLinks => ("link", "files get their names by renaming"),
        };
        write!(f, "{}: cannot {action}: {source}; {outcome}", folder.display())
    }
}
