//! Parcels: a head with the facts, a packed volume, a packed trace.

use miniz_oxide::deflate::compress_to_vec;
use paros_protocol::limits::MAX_PARCEL_BYTES;
use paros_protocol::{ContentHash, ProtocolError, UploadFacts};
use sha2::{Digest, Sha256};

/// Deflate's level: a volume takes some milliseconds, and the next one adds little.
const LEVEL: u8 = 6;

/// A parcel, as it is in a file and as it is sent: the facts, the packed volume, the packed trace, and the SHA-256 of all
/// these bytes.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Parcel {
    facts: UploadFacts,
    file: Vec<u8>,
}

/// Bytes that the file of a parcel has at most.
pub(super) const MAX_FILE_BYTES: u64 = MAX_PARCEL_BYTES + ContentHash::BYTES as u64;

/// Why bytes are no parcel.
#[derive(Debug, thiserror::Error)]
pub enum ParcelFault {
    /// The head is none.
    #[error("a parcel's head: {0}")]
    Head(#[from] ProtocolError),
    /// The head tells another length.
    #[error("a parcel's files have {found} bytes; expected {told}")]
    Length {
        /// As the head tells it; the most that a parcel has where they are too many.
        told: u64,
        /// As it is.
        found: u64,
    },
    /// The file's hash is of other bytes.
    #[error("a parcel's file: expected the hash of its bytes")]
    Damaged,
}

impl Parcel {
    /// Packs files. The lengths that `facts` has are put right; `trace` is `None` where none is sent.
    ///
    /// # Errors
    /// Where the booth would refuse it: a file that is empty or too long, or other facts that no sculpture has.
    pub fn pack(
        facts: &UploadFacts,
        volume: &[u8],
        trace: Option<&[u8]>,
    ) -> Result<Self, ParcelFault> {
        let packed = compress_to_vec(volume, LEVEL);
        let trace = trace.unwrap_or_default();
        let packed_trace =
            if trace.is_empty() { Vec::new() } else { compress_to_vec(trace, LEVEL) };
        let found = (volume.len() + trace.len()) as u64;
        let length = |len: usize| {
            let told = ParcelFault::Length { told: MAX_PARCEL_BYTES, found };
            u32::try_from(len).map_err(|_| told)
        };
        let facts = UploadFacts {
            volume_bytes: length(packed.len())?,
            volume_raw_bytes: length(volume.len())?,
            trace_bytes: length(packed_trace.len())?,
            trace_raw_bytes: length(trace.len())?,
            ..*facts
        };
        let mut file = [&facts.to_head()[..], &packed, &packed_trace].concat();
        file.extend_from_slice(&Sha256::digest(&file));
        Parcel::from_file(file)
    }

    /// Takes a file's bytes as a parcel. What is packed isn't looked at.
    ///
    /// # Errors
    /// `Damaged` if the hash isn't that of the bytes before; otherwise another version's: a head that can't be read, or tells
    /// another length.
    pub fn from_file(file: Vec<u8>) -> Result<Self, ParcelFault> {
        let at = file.len().checked_sub(ContentHash::BYTES).ok_or(ParcelFault::Damaged)?;
        let (bytes, hash) = file.split_at(at);
        if Sha256::digest(bytes)[..] != *hash {
            return Err(ParcelFault::Damaged);
        }
        let (facts, packed) = UploadFacts::split_head(bytes)?;
        let (told, found) = (facts.packed_bytes(), packed.len() as u64);
        if told != found {
            return Err(ParcelFault::Length { told, found });
        }
        Ok(Parcel { facts, file })
    }

    /// What its head says.
    #[must_use]
    pub const fn facts(&self) -> &UploadFacts {
        &self.facts
    }

    /// The file: what is on the disk, and what is sent.
    #[must_use]
    pub fn file_bytes(&self) -> &[u8] {
        &self.file
    }

    /// The file.
    #[must_use]
    pub fn into_file(self) -> Vec<u8> {
        self.file
    }
}
