//! The folder of an outbox: whole files or none.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use paros_shell::claim::SessionClaim;
use paros_shell::durable::{self, WriteError};

/// Before every file of an outbox, since 1970: 2026.
const FIRST_TIME: Duration = Duration::from_secs(56 * 365 * 86_400);

/// A folder that one outbox alone writes to. What has returned outlives a loss of power.
pub trait OutboxFolder {
    /// The names of all files.
    ///
    /// # Errors
    /// What the disk says.
    fn list(&self) -> io::Result<Vec<String>>;

    /// A file's bytes.
    ///
    /// # Errors
    /// What the disk says; `NotFound` where there is none; that it has more than `most` bytes.
    fn read(&self, name: &str, most: u64) -> io::Result<Vec<u8>>;

    /// Writes a file, whole or not at all, in place of one of the same name.
    ///
    /// # Errors
    /// What the disk says. Then the file is as it was, or, where only the last sync failed, as it was to be.
    fn write(&mut self, name: &str, bytes: &[u8]) -> io::Result<()>;

    /// Gives a file another name, in place of a file that has it.
    ///
    /// # Errors
    /// What the disk says.
    fn rename(&mut self, from: &str, to: &str) -> io::Result<()>;

    /// Seconds since a file was written or got its name, by the wall clock; 0 if that isn't known, as where the clock was
    /// set back.
    fn age_seconds(&self, name: &str) -> u64;

    /// Removes a file, if there is one.
    ///
    /// # Errors
    /// What the disk says.
    fn remove(&mut self, name: &str) -> io::Result<()>;
}

/// A folder on a disk.
#[derive(Debug)]
pub struct DiskFolder {
    path: PathBuf,
    // Held for its drop.
    _claim: SessionClaim,
}

impl DiskFolder {
    /// Makes the folder, if it isn't there, and claims it for this process.
    ///
    /// # Errors
    /// When the system refuses, a file has that name, or another process has the outbox open.
    pub fn open(path: &Path) -> Result<Self, WriteError> {
        durable::make_folder(path)?;
        // Their names are on the disk before anything in them is promised; a storage that can't sync folders does without.
        for parent in path.ancestors().skip(1).take(2) {
            let _ = File::open(parent).and_then(|folder| folder.sync_all());
        }
        // No grid has a side of 0: the claim is the outbox's own.
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
            // No file of an outbox has a name that isn't text.
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
        // A storage that can't say when leaves the time at which the file was written.
        let _ = File::options()
            .write(true)
            .open(&path)
            .and_then(|file| file.set_modified(SystemTime::now()));
        durable::rename_file(&path, to).map_err(|error| error.source)
    }

    fn age_seconds(&self, name: &str) -> u64 {
        let modified = fs::metadata(self.path.join(name)).and_then(|found| found.modified());
        // A device whose clock isn't set yet thinks that it is 1970.
        let is_set =
            |at: &SystemTime| at.duration_since(UNIX_EPOCH).is_ok_and(|at| at > FIRST_TIME);
        let age = modified.ok().filter(is_set).and_then(|at| at.elapsed().ok());
        age.map_or(0, |age| age.as_secs())
    }

    fn remove(&mut self, name: &str) -> io::Result<()> {
        durable::remove_file(&self.path.join(name)).map_err(|error| error.source)
    }
}
