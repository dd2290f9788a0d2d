//! One process serves a folder: two would each count bytes, memory and logins without the other.

use std::fs::{File, OpenOptions};
use std::path::Path;
use std::thread;
use std::time::Duration;

use paros_shell::durable;
use rustix::fs::{FlockOperation, flock};
use rustix::io::Errno;

use crate::error::Error;

/// A folder that this process serves alone. The kernel frees it with the process, however that ends.
#[derive(Debug)]
pub(crate) struct FolderLock {
    // Held for its drop.
    _file: File,
}

impl FolderLock {
    /// Takes a folder, which is made where there is none.
    ///
    /// # Errors
    /// [`Error::Input`] where another process serves it; or what the disk says.
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

    /// The same, for a moment: waits for others who take it for a moment too.
    ///
    /// # Errors
    /// Those of [`FolderLock::take`].
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
