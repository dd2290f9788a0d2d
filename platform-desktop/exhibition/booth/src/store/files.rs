//! Where the bytes of sculptures are: in a folder, or in a bucket.

use paros_booth_rules::ParcelFiles;

/// Files of a booth.
pub trait Files: ParcelFiles {
    /// Bytes of all kept files.
    fn used_bytes(&self) -> u64;
}
