//! Parcels. The same bytes are the file on the headset's disk and the body of a `PUT`.
//!
//! | bytes | content |
//! |---|---|
//! | 4 | the length of the head, a `u32`, little-endian, at most [`MAX_HEAD_BYTES`] |
//! | that length | the head: [`UploadFacts`] as JSON |
//! | `volume_bytes` | the volume, an `.rmap`, packed by deflate (RFC 1951, no header) |
//! | `trace_bytes` | the trace, packed in the same way; nothing if none is sent |
//! | 32 | the SHA-256 of all bytes before |

use miniz_oxide::deflate::compress_to_vec;

use crate::limits::{MAX_HEAD_BYTES, MAX_PARCEL_FILE_BYTES};
use crate::{ContentHash, ProtocolError, UploadFacts};

/// Deflate's level: a volume takes some milliseconds, and the next level saves little.
const LEVEL: u8 = 6;

/// Bytes of the head's length.
const LENGTH_BYTES: usize = 4;

/// A parcel whose hash and lengths are right, in memory (`Vec<u8>`) or borrowed (`&[u8]`). The packed files may still be
/// anything.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Parcel<B = Vec<u8>> {
    facts: UploadFacts,
    file: B,
}

/// Why bytes are no parcel.
#[derive(Debug, thiserror::Error)]
pub enum ParcelFault {
    /// There are more bytes than a parcel may have.
    #[error("byte {MAX_PARCEL_FILE_BYTES}: expected the end of the parcel, found {found} bytes")]
    TooLong {
        /// Bytes of the file.
        found: u64,
    },
    /// Bytes were changed or lost: the hash at the end is of other bytes.
    #[error("byte {offset}: expected the SHA-256 of the bytes before")]
    Damaged {
        /// The place of the hash.
        offset: usize,
    },
    /// A part has another length.
    #[error("byte {offset}: expected {expected} bytes of {part}, found {found}")]
    Length {
        /// The part's place in the file.
        offset: usize,
        /// The part.
        part: &'static str,
        /// The part's length as the bytes before have it.
        expected: u64,
        /// Bytes that there are.
        found: u64,
    },
    /// The head's length is more than a head may have.
    #[error("byte 0: expected the length of a head, at most {MAX_HEAD_BYTES}, found {found}")]
    HeadLength {
        /// The length.
        found: u32,
    },
    /// The head can't be read, or has values that no sculpture has.
    #[error("byte {LENGTH_BYTES}: {0}")]
    Head(#[from] ProtocolError),
}

impl Parcel {
    /// Packs files. Sets the lengths in `facts`; `trace` is `None` if none is sent.
    ///
    /// # Errors
    /// The booth would refuse the parcel: a file is empty or too long, or `facts` are those of no sculpture.
    pub fn pack(
        facts: &UploadFacts,
        volume: &[u8],
        trace: Option<&[u8]>,
    ) -> Result<Self, ProtocolError> {
        let trace = trace.unwrap_or_default();
        let packed = compress_to_vec(volume, LEVEL);
        let packed_trace =
            if trace.is_empty() { Vec::new() } else { compress_to_vec(trace, LEVEL) };
        // No file may be so long: the check refuses it.
        let length = |bytes: &[u8]| u32::try_from(bytes.len()).unwrap_or(u32::MAX);
        let facts = UploadFacts {
            volume_bytes: length(&packed),
            volume_raw_bytes: length(volume),
            trace_bytes: length(&packed_trace),
            trace_raw_bytes: length(trace),
            ..*facts
        };
        facts.check()?;
        let file = append_hash([&facts.to_head()[..], &packed, &packed_trace].concat());
        Ok(Parcel { facts, file })
    }

    /// The file.
    #[must_use]
    pub fn into_file(self) -> Vec<u8> {
        self.file
    }
}

impl<B: AsRef<[u8]>> Parcel<B> {
    /// Reads a file. Doesn't unpack anything.
    ///
    /// # Errors
    /// [`ParcelFault`]. After [`Damaged`](ParcelFault::Damaged) the sender may try again; otherwise the file is another
    /// version's, or no parcel.
    pub fn read(file: B) -> Result<Self, ParcelFault> {
        let bytes = file.as_ref();
        let found = bytes.len() as u64;
        if found > MAX_PARCEL_FILE_BYTES {
            return Err(ParcelFault::TooLong { found });
        }
        let offset = bytes.len().saturating_sub(ContentHash::BYTES);
        let (bytes, _) = split_hash(bytes).ok_or(ParcelFault::Damaged { offset })?;
        let (facts, packed) = UploadFacts::split_head(bytes)?;
        let (expected, found) = (facts.packed_bytes(), packed.len() as u64);
        if expected != found {
            let offset = bytes.len() - packed.len();
            return Err(ParcelFault::Length { offset, part: "packed files", expected, found });
        }
        Ok(Parcel { facts, file })
    }

    /// The head's facts.
    #[must_use]
    pub const fn facts(&self) -> &UploadFacts {
        &self.facts
    }

    /// The bytes of the file, hash included.
    #[must_use]
    pub fn file_bytes(&self) -> &[u8] {
        self.file.as_ref()
    }

    /// The hash of the parcel.
    #[must_use]
    pub fn hash(&self) -> ContentHash {
        let hash = self.file_bytes().last_chunk();
        ContentHash(*hash.unwrap_or(&[0; ContentHash::BYTES]))
    }

    /// The head and the packed volume.
    #[must_use]
    pub fn sculpture(&self) -> &[u8] {
        let file = self.file_bytes();
        &file[..file.len() - ContentHash::BYTES - self.facts.trace_bytes as usize]
    }

    /// The packed volume.
    #[must_use]
    pub fn volume(&self) -> &[u8] {
        let sculpture = self.sculpture();
        &sculpture[sculpture.len() - self.facts.volume_bytes as usize..]
    }

    /// The packed trace; empty if none was sent.
    #[must_use]
    pub fn trace(&self) -> &[u8] {
        &self.file_bytes()[self.sculpture().len()..][..self.facts.trace_bytes as usize]
    }
}

impl UploadFacts {
    /// Writes the head of a parcel: the length of the JSON, and the JSON.
    #[must_use]
    pub fn to_head(&self) -> Vec<u8> {
        let json = self.to_json();
        [&(json.len() as u32).to_le_bytes()[..], &json].concat()
    }

    /// Reads the head of a parcel. Returns it, and the bytes after it.
    ///
    /// # Errors
    /// The bytes don't begin with a head.
    pub fn split_head(parcel: &[u8]) -> Result<(Self, &[u8]), ParcelFault> {
        let cut = |offset, part, expected: usize, found: usize| ParcelFault::Length {
            offset,
            part,
            expected: expected as u64,
            found: found as u64,
        };
        let (length, rest) = parcel
            .split_first_chunk::<LENGTH_BYTES>()
            .ok_or_else(|| cut(0, "a head's length", LENGTH_BYTES, parcel.len()))?;
        let found = u32::from_le_bytes(*length);
        let length = found as usize;
        if length > MAX_HEAD_BYTES {
            return Err(ParcelFault::HeadLength { found });
        }
        let (json, rest) = rest
            .split_at_checked(length)
            .ok_or_else(|| cut(LENGTH_BYTES, "head", length, rest.len()))?;
        Ok((UploadFacts::from_json(json)?, rest))
    }
}

/// Appends the SHA-256 of bytes to them.
#[must_use]
pub fn append_hash(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.extend(ContentHash::of(&bytes).0);
    bytes
}

/// Splits a file into its bytes and the SHA-256 of them at its end. Returns `None` if the hash is of other bytes.
#[must_use]
pub fn split_hash(file: &[u8]) -> Option<(&[u8], ContentHash)> {
    let (bytes, hash) = file.split_last_chunk::<{ ContentHash::BYTES }>()?;
    let hash = ContentHash(*hash);
    (ContentHash::of(bytes) == hash).then_some((bytes, hash))
}
