//! Where the bytes of sculptures are kept.

use std::io;

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
