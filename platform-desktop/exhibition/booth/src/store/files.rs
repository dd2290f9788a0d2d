//! Storage of sculptures' files: in a folder, or in a bucket.

use std::io;

use paros_booth_rules::ParcelFiles;

/// Files of a booth.
pub trait Files: ParcelFiles {
    /// Returns the bytes of all kept files.
    fn used_bytes(&self) -> u64;

    /// Returns the bytes that sculptures may still take.
    fn room_bytes(&self) -> u64;

    /// Checks that files can be written.
    ///
    /// # Errors
    /// The error of the disk or the store.
    fn check_writes(&self) -> io::Result<()>;
}
