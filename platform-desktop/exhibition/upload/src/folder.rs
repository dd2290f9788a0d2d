//! The folder of an outbox, with atomic writes.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use paros_shell::claim::SessionClaim;
use paros_shell::durable::{self, WriteError};

/// A time before every file of an outbox: 2026, since 1970.
const FIRST_TIME: Duration = Duration::from_secs(56 * 365 * 86_400);

/// A folder that only one outbox writes to. A change survives a power cut after its call has returned.
pub trait OutboxFolder {
    /// Returns the names of all files.
    ///
    /// # Errors
    /// Errors of the disk.
    fn list(&self) -> io::Result<Vec<String>>;

    /// Reads a file.
    ///
    /// # Errors
    /// Errors of the disk; `NotFound` if there is no such file; a file of more than `most` bytes.
    fn read(&self, name: &str, most: u64) -> io::Result<Vec<u8>>;

    /// Writes a file atomically, and replaces one of the same name.
    ///
    /// # Errors
    /// Errors of the disk. The file is unchanged; if only the last sync failed, it may have the new content.
    fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()>;

    /// Renames a file, and replaces one of the new name.
    ///
    /// # Errors
    /// Errors of the disk.
    fn rename(&mut self, from: &str, to: &str) -> io::Result<()>;

    /// Returns the seconds since a file was written or renamed, by the wall clock; 0 if unknown, such as
    /// after the clock was set back.
    fn age_seconds(&self, name: &str) -> u64;

    /// Removes a file, if there is one.
    ///
    /// # Errors
    /// Errors of the disk.
    fn remove(&mut self, name: &str) -> io::Result<()>;
}

/// A folder on a disk.
#[derive(Debug)]
pub struct DiskFolder {
    path: PathBuf,
    // Unlocks the folder when dropped.
    _claim: SessionClaim,
}

impl DiskFolder {
    /// Creates the folder, if it doesn't exist, and claims it for this process.
    ///
    /// # Errors
    /// Returns an error if the system refuses, a file has that name, or another process has the outbox open.
    pub fn open(path: &Path) -> Result<Self, WriteError> {
        durable::make_folder(path)?;
        // Make the folders durable before any file in them. Errors are ignored: some storages can't sync
        // folders.
        for parent in path.ancestors().skip(1).take(2) {
            let _ = File::open(parent).and_then(|folder| folder.sync_all());
        }
        // Grids have a side greater than 0, so that number 0 is the outbox's own claim.
        let claim = SessionClaim::claim_lowest_free_number(path, 0);
        if claim.number() > 1 {
            let source = io::Error::new(io::ErrorKind::ResourceBusy, "another process has it open");
            return Err(WriteError { path: path.to_owned(), action: "open the outbox", source });
        }
        Ok(DiskFolder { path: path.to_owned(), _claim: claim })
    }
}

impl OutboxFolder for DiskFolder {
    fn list(&self) -> io::Result<Vec<String>> {
        let mut names = Vec::new();
        for entry in fs::read_dir(&self.path)? {
            // Names that aren't UTF-8 are no outbox files.
            names.extend(entry?.file_name().into_string());
        }
        Ok(names)
    }

    fn read(&self, name: &str, most: u64) -> io::Result<Vec<u8>> {
        durable::read_regular_file_up_to(&self.path.join(name), most)
    }

    fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()> {
        durable::write_file(&self.path.join(name), bytes).map_err(|error| error.source)
    }

    fn rename(&mut self, from: &str, to: &str) -> io::Result<()> {
        let path = self.path.join(from);
        // On a storage that can't set the time, the age counts from when the file was written.
        let _ = File::options()
            .write(true)
            .open(&path)
            .and_then(|file| file.set_modified(SystemTime::now()));
        durable::rename_file(&path, to).map_err(|error| error.source)
    }

    fn age_seconds(&self, name: &str) -> u64 {
        let modified = fs::metadata(self.path.join(name)).and_then(|found| found.modified());
        // A device whose clock isn't set yet is in 1970.
        let is_set =
            |at: &SystemTime| at.duration_since(UNIX_EPOCH).is_ok_and(|at| at > FIRST_TIME);
        let age = modified.ok().filter(is_set).and_then(|at| at.elapsed().ok());
        age.map_or(0, |age| age.as_secs())
    }

    fn remove(&mut self, name: &str) -> io::Result<()> {
        durable::remove_file(&self.path.join(name)).map_err(|error| error.source)
    }
}
