//! Files of sculptures in memory.

use std::collections::BTreeMap;
use std::io;
use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_booth_rules::{BoothTime, Deletion, KeptName, ParcelFiles};

/// A [`ParcelFiles`] implementation in memory.
#[derive(Debug, Default)]
pub(crate) struct MemoryFiles {
    files: Mutex<Files>,
}

#[derive(Debug, Default)]
struct Files {
    kept: BTreeMap<KeptName, Vec<u8>>,
    deletions: Vec<Deletion>,
}

impl MemoryFiles {
    /// Makes a store without files.
    pub(crate) fn new() -> Self {
        MemoryFiles::default()
    }

    /// Returns the names of the kept files.
    pub(crate) fn kept_names(&self) -> Vec<KeptName> {
        self.lock().kept.keys().copied().collect()
    }

    /// Returns the deletion log.
    pub(crate) fn deletions(&self) -> Vec<Deletion> {
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
