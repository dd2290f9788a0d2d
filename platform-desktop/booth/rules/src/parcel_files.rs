//! Where the bytes of sculptures are: parcels under way, and files that are kept.

use std::collections::BTreeMap;
use std::io;
use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_core::outbox::messages::{ContentHash, SculptureId};

use crate::deletions::Deletion;
use crate::time::BoothTime;

/// A parcel under way. Two headsets never share one, nor two parcels of an id.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct ParcelName {
    /// Whose it is.
    pub headset: u32,
    /// The sculpture.
    pub id: SculptureId,
    /// Of the whole parcel.
    pub hash: ContentHash,
}

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

/// A disk with parcels and kept files. All calls may come from several threads at once.
pub trait ParcelFiles: Send + Sync {
    /// Bytes held of a parcel; 0 where there is none.
    ///
    /// # Errors
    /// What the disk says.
    fn held_bytes(&self, parcel: &ParcelName) -> io::Result<u64>;

    /// Adds bytes to the end of a parcel if that is at `offset`, and makes it where there is none. Returns how many
    /// are held then. They may be lost with the power, or turn into others.
    ///
    /// # Errors
    /// What the disk says. Then some of the bytes may be held.
    fn append(&self, parcel: &ParcelName, offset: u64, bytes: &[u8]) -> io::Result<u64>;

    /// All bytes held of a parcel.
    ///
    /// # Errors
    /// What the disk says.
    fn read_parcel(&self, parcel: &ParcelName) -> io::Result<Vec<u8>>;

    /// Forgets a parcel, if there is one.
    ///
    /// # Errors
    /// What the disk says.
    fn drop_parcel(&self, parcel: &ParcelName) -> io::Result<()>;

    /// Makes room for another parcel of a headset: forgets those that nothing was added to for longest, until there are
    /// fewer than `most`.
    ///
    /// # Errors
    /// What the disk says.
    fn make_room(&self, headset: u32, most: usize) -> io::Result<()>;

    /// Forgets the parcels that nothing was added to since a time.
    ///
    /// # Errors
    /// What the disk says.
    fn drop_parcels_before(&self, time: BoothTime) -> io::Result<()>;

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
    parcels: BTreeMap<ParcelName, Held>,
    kept: BTreeMap<KeptName, Vec<u8>>,
    deletions: Vec<Deletion>,
    /// Pieces added so far.
    turns: u64,
}

#[derive(Debug, Default)]
struct Held {
    bytes: Vec<u8>,
    /// When the last piece was added, in pieces.
    turn: u64,
}

impl MemoryFiles {
    /// None.
    #[must_use]
    pub fn new() -> Self {
        MemoryFiles::default()
    }

    /// The names of parcels under way.
    #[must_use]
    pub fn parcel_names(&self) -> Vec<ParcelName> {
        self.lock().parcels.keys().copied().collect()
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
    fn held_bytes(&self, parcel: &ParcelName) -> io::Result<u64> {
        Ok(self.lock().parcels.get(parcel).map_or(0, |held| held.bytes.len() as u64))
    }

    fn append(&self, parcel: &ParcelName, offset: u64, bytes: &[u8]) -> io::Result<u64> {
        let mut files = self.lock();
        files.turns += 1;
        let turn = files.turns;
        let held = files.parcels.entry(*parcel).or_default();
        if held.bytes.len() as u64 == offset {
            held.bytes.extend_from_slice(bytes);
            held.turn = turn;
        }
        Ok(held.bytes.len() as u64)
    }

    fn read_parcel(&self, parcel: &ParcelName) -> io::Result<Vec<u8>> {
        let files = self.lock();
        let held = files.parcels.get(parcel).map(|held| held.bytes.clone());
        held.ok_or(io::ErrorKind::NotFound.into())
    }

    fn drop_parcel(&self, parcel: &ParcelName) -> io::Result<()> {
        self.lock().parcels.remove(parcel);
        Ok(())
    }

    fn make_room(&self, headset: u32, most: usize) -> io::Result<()> {
        let mut files = self.lock();
        let of_headset = files.parcels.iter().filter(|(name, _)| name.headset == headset);
        let mut by_age: Vec<_> = of_headset.map(|(name, held)| (held.turn, *name)).collect();
        by_age.sort_unstable();
        let too_many = (by_age.len() + 1).saturating_sub(most);
        for (_, name) in by_age.into_iter().take(too_many) {
            files.parcels.remove(&name);
        }
        Ok(())
    }

    /// They have no times: none is forgotten.
    fn drop_parcels_before(&self, _time: BoothTime) -> io::Result<()> {
        Ok(())
    }

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
