//! Parcels. A parcel has the same bytes as a file on the headset's disk and as the body of a `PUT`.
//!
//! | bytes | content |
//! |---|---|
//! | 4 | the length of the head, a `u32`, little-endian, at most [`MAX_HEAD_BYTES`] |
//! | that length | the head: [`UploadFacts`] as JSON |
//! | `volume_bytes` | the volume, an `.rmap`, packed by deflate (RFC 1951, no header) |
//! | `trace_bytes` | the trace, packed like the volume; empty if no trace is sent |
//! | 32 | the SHA-256 of all bytes before |

use miniz_oxide::deflate::compress_to_vec;

use crate::limits::{MAX_HEAD_BYTES, MAX_PARCEL_FILE_BYTES};
use crate::{ContentHash, ProtocolError, UploadFacts};

/// Compression level of deflate: a volume takes a few milliseconds, and the next level saves little.
const LEVEL: u8 = 6;

/// Bytes of the field for the head's length.
const LENGTH_BYTES: usize = 4;

/// A parcel with valid hash and lengths, in memory (`Vec<u8>`) or borrowed (`&[u8]`). The packed files aren't
/// validated.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Parcel<B = Vec<u8>> {
    facts: UploadFacts,
    file: B,
}

/// The reason why bytes aren't a valid parcel.
#[derive(Debug, thiserror::Error)]
pub enum ParcelFault {
    /// The file is longer than a parcel may be.
    #[error("byte {MAX_PARCEL_FILE_BYTES}: expected the end of the parcel, found {found} bytes")]
    TooLong {
        /// Length of the file in bytes.
        found: u64,
    },
    /// The hash at the end doesn't match: bytes were changed or lost.
    #[error("byte {offset}: expected the SHA-256 of the bytes before")]
    Damaged {
        /// The offset of the hash in the file.
        offset: usize,
    },
    /// A part has the wrong length.
    #[error("byte {offset}: expected {expected} bytes of {part}, found {found}")]
    Length {
        /// The part's offset in the file.
        offset: usize,
        /// The name of the part.
        part: &'static str,
        /// The length that the preceding bytes declare.
        expected: u64,
        /// The number of bytes that are present.
        found: u64,
    },
    /// The declared length of the head is too large.
    #[error("byte 0: expected the length of a head, at most {MAX_HEAD_BYTES}, found {found}")]
    HeadLength {
        /// The declared length.
        found: u32,
    },
    /// The head can't be read, or has invalid values.
    #[error("byte {LENGTH_BYTES}: {0}")]
    Head(#[from] ProtocolError),
}

impl Parcel {
    /// Packs files into a parcel, and sets the lengths in `facts`. `trace` is `None` if no trace is sent.
    ///
    /// # Errors
    /// Returns an error for what the booth would refuse: empty or too long files, or invalid `facts`.
    pub fn pack(
        facts: &UploadFacts,
        volume: &[u8],
        trace: Option<&[u8]>,
    ) -> Result<Self, ProtocolError> {
        let trace = trace.unwrap_or_default();
        let packed = compress_to_vec(volume, LEVEL);
        let packed_trace =
            if trace.is_empty() { Vec::new() } else { compress_to_vec(trace, LEVEL) };
        // A length beyond `u32` saturates, and the check below rejects it.
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

    /// Returns the bytes of the file.
    #[must_use]
    pub fn into_file(self) -> Vec<u8> {
        self.file
    }
}

impl<B: AsRef<[u8]>> Parcel<B> {
    /// Reads a parcel file without unpacking it.
    ///
    /// # Errors
    /// Returns a [`ParcelFault`]. After [`Damaged`](ParcelFault::Damaged) the sender may retry. Any other
    /// fault means another version, or not a parcel.
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

    /// Returns the facts of the head.
    #[must_use]
    pub const fn facts(&self) -> &UploadFacts {
        &self.facts
    }

    /// Returns the bytes of the file, including the hash.
    #[must_use]
    pub fn file_bytes(&self) -> &[u8] {
        self.file.as_ref()
    }

    /// Returns the hash of the parcel.
    #[must_use]
    pub fn hash(&self) -> ContentHash {
        let hash = self.file_bytes().last_chunk();
        ContentHash(*hash.unwrap_or(&[0; ContentHash::BYTES]))
    }

    /// Returns the head and the packed volume.
    #[must_use]
    pub fn sculpture(&self) -> &[u8] {
        let file = self.file_bytes();
        &file[..file.len() - ContentHash::BYTES - self.facts.trace_bytes as usize]
    }

    /// Returns the packed volume.
    #[must_use]
    pub fn volume(&self) -> &[u8] {
        let sculpture = self.sculpture();
        &sculpture[sculpture.len() - self.facts.volume_bytes as usize..]
    }

    /// Returns the packed trace; empty if none was sent.
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

    /// Reads the head of a parcel. Returns the head and the bytes after it.
    ///
    /// # Errors
    /// Returns an error if the bytes don't begin with a valid head.
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

/// Appends the SHA-256 of `bytes` to `bytes`.
#[must_use]
pub fn append_hash(mut bytes: Vec<u8>) -> Vec<u8> {
    bytes.extend(ContentHash::of(&bytes).0);
    bytes
}

/// Splits a file into its content and the SHA-256 at its end. Returns `None` if the hash doesn't match.
#[must_use]
pub fn split_hash(file: &[u8]) -> Option<(&[u8], ContentHash)> {
    let (bytes, hash) = file.split_last_chunk::<{ ContentHash::BYTES }>()?;
    let hash = ContentHash(*hash);
    (ContentHash::of(bytes) == hash).then_some((bytes, hash))
}
