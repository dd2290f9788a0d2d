//! The head of a parcel: what is known of a sculpture when its visit ends.

use paros_core::badge::BadgeNumber;
use paros_core::session::SessionMode;
use serde::{Deserialize, Serialize};

use crate::limits::{
    MAX_HEAD_BYTES, MAX_PACKED_SURPLUS, MAX_PARCEL_BYTES, MAX_PARCEL_TRACE_BYTES,
    MAX_PARCEL_VOLUME_BYTES,
};
use crate::{BlockSerial, ProtocolError, SculptureId, expect, fields};

/// The cause of a session's end.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum FinishCause {
    /// The visitor finished, or the time was up.
    Finished,
    /// The visitor left before the end.
    Left,
    /// The program ended first, and made the files at its next start.
    CutOff,
}

/// The visitor's age group, relative to the age from which a visitor may leave an address without a parent.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum AgeGroup {
    /// The visitor wasn't asked.
    Unknown,
    /// Below that age.
    UnderAge,
    /// At that age or above.
    OfAge,
}

/// The head of a [`Parcel`](crate::Parcel).
#[derive(Clone, Copy, PartialEq, Eq, Debug, Serialize, Deserialize)]
pub struct UploadFacts {
    /// The id of the sculpture.
    pub id: SculptureId,
    /// The badge that the visitor was shown.
    #[serde(with = "fields::badge")]
    pub badge: Option<BadgeNumber>,
    /// The serial of the badge's block, which proves the lease of the badge; `None` for a provisional badge.
    pub badge_serial: Option<BlockSerial>,
    /// The program's [`CORE_VERSION`](paros_core::codec::trace::CORE_VERSION).
    pub core_version: u16,
    /// Voxels along a side of the grid: 128 or 256.
    pub side: u16,
    /// The cause of the session's end.
    pub cause: FinishCause,
    /// The visit's language, two small letters of ISO 639-1.
    #[serde(with = "fields::language")]
    pub language: [u8; 2],
    /// The start of the session, never [`SessionMode::None`].
    #[serde(with = "fields::Mode")]
    pub mode: SessionMode,
    /// The age group of the visitor.
    pub age_group: AgeGroup,
    /// Seconds in which the visitor could sculpt.
    pub sculpting_seconds: u32,
    /// Seconds since 1970 by the headset's wall clock. The clock may be wrong.
    pub finished_at: u64,
    /// The print's height in tenths of a millimetre, from 1.
    pub height_mm_tenths: u16,
    /// Length of the packed volume in bytes, from 1.
    pub volume_bytes: u32,
    /// Length of the volume unpacked, from 1.
    pub volume_raw_bytes: u32,
    /// Length of the packed trace in bytes; 0 if no trace is sent.
    pub trace_bytes: u32,
    /// Length of the trace unpacked; 0 if no trace is sent.
    pub trace_raw_bytes: u32,
}

impl UploadFacts {
    /// Returns the total length of the packed files in bytes.
    #[must_use]
    pub const fn packed_bytes(&self) -> u64 {
        self.volume_bytes as u64 + self.trace_bytes as u64
    }

    pub(crate) fn check(&self) -> Result<(), ProtocolError> {
        let UploadFacts { volume_bytes, volume_raw_bytes, trace_bytes, trace_raw_bytes, .. } =
            *self;
        expect(matches!(self.side, 128 | 256), "side", "128 or 256")?;
        expect(self.mode != SessionMode::None, "mode", "what a session starts from")?;
        let is_leased = self.badge.is_some_and(|badge| !badge.is_provisional());
        expect(
            is_leased || self.badge_serial.is_none(),
            "badge_serial",
            "none without a leased badge",
        )?;
        expect(self.height_mm_tenths > 0, "height_mm_tenths", "a height from 1")?;
        let is_volume = is_packed_file(volume_bytes, volume_raw_bytes, MAX_PARCEL_VOLUME_BYTES);
        expect(is_volume, "volume_bytes", "a volume's lengths, packed and unpacked")?;
        let is_trace = (trace_bytes, trace_raw_bytes) == (0, 0)
            || is_packed_file(trace_bytes, trace_raw_bytes, MAX_PARCEL_TRACE_BYTES);
        let fits = MAX_HEAD_BYTES as u64 + self.packed_bytes() <= MAX_PARCEL_BYTES;
        let expected = "a trace's lengths, packed and unpacked, in a parcel of its size";
        expect(is_trace && fits, "trace_bytes", expected)
    }
}

/// `true` if a file can have these lengths. Deflate adds at most a small overhead to incompressible data.
const fn is_packed_file(packed: u32, raw: u32, max_raw: u32) -> bool {
    let longest = raw as u64 + raw as u64 / 1000 + MAX_PACKED_SURPLUS as u64;
    packed > 0 && raw > 0 && raw <= max_raw && packed as u64 <= longest
}
