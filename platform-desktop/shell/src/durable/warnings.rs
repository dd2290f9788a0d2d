//! What a storage refused though the files are written. The same would be refused with every file: so each
//! kind is told once in a process.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// What a storage lacks.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum StorageLimit {
    /// A folder can't be synced: a loss of power may undo the last files.
    UnsyncedFolder,
    /// There are no hard links: files get their names by renaming.
    NoLinks,
}

/// A storage's refusal that lost no file.
#[derive(Debug)]
pub struct StorageWarning {
    /// What is lacking.
    pub limit: StorageLimit,
    /// The folder where it was met first.
    pub folder: PathBuf,
    /// The system's reason.
    pub source: io::Error,
}

/// Warnings that were met in this process.
struct Warnings {
    met: Vec<StorageLimit>,
    untold: Vec<StorageWarning>,
}

static WARNINGS: Mutex<Warnings> = Mutex::new(Warnings { met: Vec::new(), untold: Vec::new() });

/// Removes and returns the warnings that nobody has taken yet: at most one of a kind in a process.
#[must_use]
pub fn take_storage_warnings() -> Vec<StorageWarning> {
    let mut warnings = WARNINGS.lock().unwrap_or_else(PoisonError::into_inner);
    std::mem::take(&mut warnings.untold)
}

/// Notes a refusal, if it is the first of its kind.
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
