//! Where the bytes of sculptures are kept.

use std::collections::BTreeMap;
use std::io;
use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_protocol::{ContentHash, SculptureId};

use crate::deletions::Deletion;
use crate::time::BoothTime;

/// A file that is kept.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct KeptName {
    /// The sculpture.
    pub id: SculptureId,
    /// Of the parcel that it came in, so that what another parcel left behind is never taken for it.
    pub hash: ContentHash,
    /// Which of its files it is.
    pub part: KeptPart,
}

/// The files of a sculpture.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum KeptPart {
    /// The parcel's head and first file, packed as it came.
    Sculpture,
    /// The trace, packed as it came.
    Trace,
    /// A picture of it, which the booth drew.
    Picture,
}

impl KeptPart {
    /// All of them.
    pub const ALL: [KeptPart; 3] = [KeptPart::Sculpture, KeptPart::Trace, KeptPart::Picture];
}

/// A disk with kept files. All calls may come from several threads at once.
pub trait ParcelFiles: Send + Sync {
    /// Keeps a file, in place of one of the same name. It outlives a power cut from when this returns.
    ///
    /// # Errors
    /// What the disk says. Then the file is as it was.
    fn keep(&self, name: &KeptName, bytes: &[u8]) -> io::Result<()>;

    /// The bytes of a kept file.
    ///
    /// # Errors
    /// What the disk says; `NotFound` where there is none.
    fn read_kept(&self, name: &KeptName) -> io::Result<Vec<u8>>;

    /// Removes a kept file, if there is one.
    ///
    /// # Errors
    /// What the disk says.
    fn remove_kept(&self, name: &KeptName) -> io::Result<()>;

    /// Adds deletions to the log of them, which outlives the database. They outlive a power cut from when this returns;
    /// some may be there twice.
    ///
    /// # Errors
    /// What the disk says.
    fn log_deletions(&self, deletions: &[Deletion]) -> io::Result<()>;

    /// Forgets deletions of before a time: no headset and no copy brings them back any more.
    ///
    /// # Errors
    /// What the disk says. Then the log is as it was.
    fn forget_deletions_before(&self, time: BoothTime) -> io::Result<()>;
}

/// Files in memory, for tests and simulations.
#[derive(Debug, Default)]
pub struct MemoryFiles {
    files: Mutex<Files>,
}

#[derive(Debug, Default)]
struct Files {
    kept: BTreeMap<KeptName, Vec<u8>>,
    deletions: Vec<Deletion>,
}

impl MemoryFiles {
    /// None.
    #[must_use]
    pub fn new() -> Self {
        MemoryFiles::default()
    }

    /// The names of those that are kept.
    #[must_use]
    pub fn kept_names(&self) -> Vec<KeptName> {
        self.lock().kept.keys().copied().collect()
    }

    /// The log of deletions.
    #[must_use]
    pub fn deletions(&self) -> Vec<Deletion> {
        self.lock().deletions.clone()
    }

    fn lock(&self) -> MutexGuard<'_, Files> {
        self.files.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl ParcelFiles for MemoryFiles {
    fn keep(&self, name: &KeptName, bytes: &[u8]) -> io::Result<()> {
        self.lock().kept.insert(*name, bytes.to_vec());
        Ok(())
    }

    fn read_kept(&self, name: &KeptName) -> io::Result<Vec<u8>> {
        self.lock().kept.get(name).cloned().ok_or(io::ErrorKind::NotFound.into())
    }

    fn remove_kept(&self, name: &KeptName) -> io::Result<()> {
        self.lock().kept.remove(name);
        Ok(())
    }

    fn log_deletions(&self, deletions: &[Deletion]) -> io::Result<()> {
        self.lock().deletions.extend_from_slice(deletions);
        Ok(())
    }

    fn forget_deletions_before(&self, time: BoothTime) -> io::Result<()> {
        self.lock().deletions.retain(|deletion| deletion.deleted_at >= time);
        Ok(())
    }
}
