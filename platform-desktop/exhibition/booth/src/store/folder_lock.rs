//! A lock for one server process per folder: two would not share their counts of bytes, memory and logins.

use std::fs::{File, OpenOptions};
use std::path::Path;
use std::thread;
use std::time::Duration;

use paros_shell::durable;
use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;

use crate::error::Error;

/// An exclusive lock of a folder. The kernel releases it when the process ends, even if it is killed.
#[derive(Debug)]
pub(crate) struct FolderLock {
    // The open file holds the lock until it is dropped.
    _file: File,
}

impl FolderLock {
    /// Locks a folder, and makes it if there is none.
    ///
    /// # Errors
    /// [`Error::Input`] if another process holds the lock; an I/O error.
    pub(crate) fn take(folder: &Path) -> Result<Self, Error> {
        durable::make_folder(folder).map_err(|error| Error::at(folder, error))?;
        let path = folder.join("lock");
        let file = OpenOptions::new().write(true).create(true).truncate(false).open(&path);
        let file = file.map_err(|error| Error::at(&path, error))?;
        match flock(&file, FlockOperation::NonBlockingLockExclusive) {
            Ok(()) => Ok(FolderLock { _file: file }),
            Err(Errno::WOULDBLOCK) => {
                let why = "another booth runs in this folder; end it first, or name another";
                Err(Error::Input(format!("{}: {why}", folder.display())))
            }
            Err(error) => Err(Error::at(&path, error)),
        }
    }

    /// Locks a folder for a short time. Waits up to ten seconds for another process that does the same.
    ///
    /// # Errors
    /// The errors of [`FolderLock::take`].
    pub(crate) fn take_in_turn(folder: &Path) -> Result<Self, Error> {
        for _ in 0..100 {
            match FolderLock::take(folder) {
                Err(Error::Input(_)) => thread::sleep(Duration::from_millis(100)),
                taken => return taken,
            }
        }
        FolderLock::take(folder)
    }
}
