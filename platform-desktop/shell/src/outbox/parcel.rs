//! Parcels: a head with the facts, a packed volume, a packed trace.

use miniz_oxide::deflate::compress_to_vec;
use paros_core::codec::BadBytes;
use paros_core::limits::MAX_PARCEL_BYTES;
use paros_core::outbox::messages::{ContentHash, SculptureId, UploadFacts};
use sha2::{Digest, Sha256};

/// Deflate's level: a volume takes some milliseconds, and the next one adds little.
const LEVEL: u8 = 6;

/// What stands before an id and a hash where a new id is made of them.
const RENEWAL_CONTEXT: &[u8] = b"paros renewed id v1\0";

/// A parcel whose bytes are what its head says.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Parcel {
    facts: UploadFacts,
    hash: ContentHash,
    bytes: Vec<u8>,
}

/// Bytes that the file of a parcel has at most.
pub(super) const MAX_FILE_BYTES: u64 = MAX_PARCEL_BYTES + ContentHash::BYTES as u64;

/// Why bytes are no parcel.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum ParcelFault {
    /// The head is none.
    #[error("at byte {} of a parcel's head: expected {}", .0.offset, .0.expected)]
    Head(BadBytes),
    /// The head tells another length.
    #[error("a parcel has {found} bytes; expected {told}")]
    Length {
        /// As the head tells it; of all files where that is no parcel's.
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
        Parcel::read([&facts.to_bytes()[..], &packed, &packed_trace].concat())
    }

    /// Takes bytes as a parcel.
    ///
    /// # Errors
    /// Where its head is none, or tells another length. What is packed isn't looked at.
    pub fn read(bytes: Vec<u8>) -> Result<Self, ParcelFault> {
        let head = bytes.get(..UploadFacts::BYTES).unwrap_or(&bytes);
        let facts = UploadFacts::from_bytes(head).map_err(ParcelFault::Head)?;
        let (told, found) = (facts.parcel_bytes(), bytes.len() as u64);
        if told != found {
            return Err(ParcelFault::Length { told, found });
        }
        let hash = ContentHash(Sha256::digest(&bytes).into());
        Ok(Parcel { facts, hash, bytes })
    }

    /// What its file holds: the parcel, and its hash.
    #[must_use]
    pub fn to_file(&self) -> Vec<u8> {
        [&self.bytes[..], &self.hash.0].concat()
    }

    /// Takes a file's bytes as a parcel.
    ///
    /// # Errors
    /// Where the hash isn't that of the bytes before, and those of [`Parcel::read`].
    pub fn read_file(mut bytes: Vec<u8>) -> Result<Self, ParcelFault> {
        let at = bytes.len().checked_sub(ContentHash::BYTES).ok_or(ParcelFault::Damaged)?;
        let told = bytes.split_off(at);
        let parcel = Parcel::read(bytes)?;
        if parcel.hash.0[..] == told[..] { Ok(parcel) } else { Err(ParcelFault::Damaged) }
    }

    /// The same under another id, which follows from the old one and what is in the parcel; as the sculpture of a headset of
    /// this number, as which its device may have enrolled anew.
    ///
    /// # Errors
    /// Where the number is 0.
    pub fn renew(&self, headset: u32) -> Result<Self, ParcelFault> {
        let digest = Sha256::new()
            .chain_update(RENEWAL_CONTEXT)
            .chain_update(self.facts.id.0)
            .chain_update(self.hash.0)
            .finalize();
        let mut id = [0; SculptureId::BYTES];
        id.copy_from_slice(&digest[..SculptureId::BYTES]);
        let facts = UploadFacts { id: SculptureId(id), headset, ..self.facts };
        Parcel::read([&facts.to_bytes()[..], &self.bytes[UploadFacts::BYTES..]].concat())
    }

    /// What its head says.
    #[must_use]
    pub const fn facts(&self) -> &UploadFacts {
        &self.facts
    }

    /// SHA-256 of all its bytes.
    #[must_use]
    pub const fn hash(&self) -> ContentHash {
        self.hash
    }

    /// All its bytes.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// How many they are: no parcel has more than [`MAX_PARCEL_BYTES`].
    pub(super) fn len(&self) -> u32 {
        u32::try_from(self.bytes.len()).unwrap_or(u32::MAX)
    }
}
