//! Storage of the files of sculptures.

use std::io;

use paros_protocol::{ContentHash, SculptureId};

use crate::deletions::Deletion;
use crate::time::BoothTime;

/// The name of a kept file.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct KeptName {
    /// The sculpture.
    pub id: SculptureId,
    /// The hash of the parcel. It prevents that a leftover file of another parcel is taken for this file.
    pub hash: ContentHash,
    /// The part of the sculpture that the file holds.
    pub part: KeptPart,
}

/// The files of a sculpture.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum KeptPart {
    /// The parcel's head and volume, packed as received.
    Sculpture,
    /// The trace, packed as received.
    Trace,
    /// A picture of the sculpture, drawn by the booth.
    Picture,
}

impl KeptPart {
    /// All parts.
    pub const ALL: [KeptPart; 3] = [KeptPart::Sculpture, KeptPart::Trace, KeptPart::Picture];
}

/// A disk with kept files. Several threads may call it concurrently.
pub trait ParcelFiles: Send + Sync {
    /// Stores a file, and replaces one of the same name. The file survives a power cut after this returns.
    ///
    /// # Errors
    /// Errors of the disk. The file is then unchanged.
    fn keep(&self, name: &KeptName, bytes: &[u8]) -> io::Result<()>;

    /// Reads a kept file.
    ///
    /// # Errors
    /// Errors of the disk; `NotFound` if there is no such file.
    fn read_kept(&self, name: &KeptName) -> io::Result<Vec<u8>>;

    /// Removes a kept file, if there is one.
    ///
    /// # Errors
    /// Errors of the disk.
    fn remove_kept(&self, name: &KeptName) -> io::Result<()>;

    /// Appends deletions to the deletion log, which outlives the database. They survive a power cut after
    /// this returns. Duplicate lines are possible.
    ///
    /// # Errors
    /// Errors of the disk.
    fn log_deletions(&self, deletions: &[Deletion]) -> io::Result<()>;

    /// Removes deletions before a time from the log: no headset and no copy has those sculptures any more.
    ///
    /// # Errors
    /// Errors of the disk. The log is then unchanged.
    fn forget_deletions_before(&self, time: BoothTime) -> io::Result<()>;
}
