//! What is known of a sculpture when its visit ends: the head of its parcel.

use crate::badge::BadgeNumber;
use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::limits::{
    MAX_PACKED_SURPLUS, MAX_PARCEL_BYTES, MAX_PARCEL_TRACE_BYTES, MAX_PARCEL_VOLUME_BYTES,
};
use crate::outbox::messages::SculptureId;
use crate::outbox::messages::fields::{
    fixed_bytes, read_badge, read_numbered, read_version, write_badge, write_version,
};
use crate::session::input::SessionMode;

/// How a session ended.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum FinishCause {
    /// The visitor was ready, or the time was up.
    Finished = 0,
    /// The visitor was gone before.
    Left = 1,
    /// The program ended before, and made the files at its next start.
    CutOff = 2,
}

/// On which side of the age the visitor is, from which on an address may be left without a parent.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum AgeGroup {
    /// Nobody asked.
    Unknown = 0,
    /// Below it.
    UnderAge = 1,
    /// Of that age.
    OfAge = 2,
}

/// The head of a parcel. After it come, in this order and each packed by deflate (RFC 1951, no header):
/// [`volume_bytes`](UploadFacts::volume_bytes) of the volume, an `.rmap`, and
/// [`trace_bytes`](UploadFacts::trace_bytes) of the trace; at the end the SHA-256 of all of it, the head too. The same
/// bytes are the file on the headset's disk and the body of a `PUT`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct UploadFacts {
    /// The sculpture's.
    pub id: SculptureId,
    /// The badge that the visitor was shown.
    pub badge: Option<BadgeNumber>,
    /// [`CORE_VERSION`](crate::codec::trace::CORE_VERSION) of the program.
    pub core_version: u16,
    /// Voxels along a side of the grid: 128 or 256.
    pub side: u16,
    /// How the session ended.
    pub cause: FinishCause,
    /// The visit's language, two small letters of ISO 639-1.
    pub language: [u8; 2],
    /// What the session started from, never [`SessionMode::None`].
    pub mode: SessionMode,
    /// The visitor's.
    pub age_group: AgeGroup,
    /// Seconds in which the visitor could sculpt.
    pub sculpting_seconds: u32,
    /// Seconds since 1970 by the headset's wall clock, which anybody may have set.
    pub finished_at: u64,
    /// The print's height in tenths of a millimetre, from 1.
    pub height_mm_tenths: u16,
    /// Length of the packed volume in bytes, from 1.
    pub volume_bytes: u32,
    /// Length of the volume unpacked, from 1.
    pub volume_raw_bytes: u32,
    /// Length of the packed trace in bytes; 0 where none is sent.
    pub trace_bytes: u32,
    /// Its length unpacked; 0 where none is sent.
    pub trace_raw_bytes: u32,
}

impl FinishCause {
    /// By number.
    pub const ALL: [FinishCause; 3] =
        [FinishCause::Finished, FinishCause::Left, FinishCause::CutOff];
}

impl AgeGroup {
    /// By number.
    pub const ALL: [AgeGroup; 3] = [AgeGroup::Unknown, AgeGroup::UnderAge, AgeGroup::OfAge];
}

fixed_bytes! { UploadFacts }

impl UploadFacts {
    /// Length of the head in bytes.
    pub const BYTES: usize = 61;

    /// Length of the whole parcel in bytes.
    #[must_use]
    pub const fn parcel_bytes(&self) -> u64 {
        Self::BYTES as u64 + self.volume_bytes as u64 + self.trace_bytes as u64
    }

    fn write(&self, to: &mut ByteWriter<'_>) {
        write_version(to);
        self.id.write(to);
        write_badge(to, self.badge);
        to.u16(self.core_version);
        to.u16(self.side);
        to.u8(self.cause as u8);
        to.bytes(&self.language);
        to.bytes(&self.mode.to_bytes());
        to.u8(self.age_group as u8);
        to.u32(self.sculpting_seconds);
        to.u64(self.finished_at);
        to.u16(self.height_mm_tenths);
        to.u32(self.volume_bytes);
        to.u32(self.volume_raw_bytes);
        to.u32(self.trace_bytes);
        to.u32(self.trace_raw_bytes);
    }

    fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        read_version(from)?;
        let id = SculptureId::read(from)?;
        let (badge, core_version) = (read_badge(from)?, from.u16()?);
        let bad = from.error_here("a grid's side, 128 or 256");
        let side = Some(from.u16()?).filter(|side| matches!(side, 128 | 256)).ok_or(bad)?;
        let cause = read_numbered(from, &FinishCause::ALL, "how a session ended, 0 to 2")?;
        let language = read_language(from)?;
        let mode = read_mode(from)?;
        let age_group = read_numbered(from, &AgeGroup::ALL, "an age group, 0 to 2")?;
        let (sculpting_seconds, finished_at) = (from.u32()?, from.u64()?);
        let bad = from.error_here("a height, from 1");
        let height_mm_tenths = Some(from.u16()?).filter(|&height| height > 0).ok_or(bad)?;
        let bad = from.error_here("a volume's lengths, packed and unpacked");
        let (volume_bytes, volume_raw_bytes) = (from.u32()?, from.u32()?);
        if !has_lengths_of_file(volume_bytes, volume_raw_bytes, MAX_PARCEL_VOLUME_BYTES) {
            return Err(bad);
        }
        let bad =
            from.error_here("a trace's lengths, packed and unpacked, in a parcel of its size");
        let (trace_bytes, trace_raw_bytes) = (from.u32()?, from.u32()?);
        let has_no_trace = (trace_bytes, trace_raw_bytes) == (0, 0);
        let facts = UploadFacts {
            id,
            badge,
            core_version,
            side,
            cause,
            language,
            mode,
            age_group,
            sculpting_seconds,
            finished_at,
            height_mm_tenths,
            volume_bytes,
            volume_raw_bytes,
            trace_bytes,
            trace_raw_bytes,
        };
        let is_file = has_lengths_of_file(trace_bytes, trace_raw_bytes, MAX_PARCEL_TRACE_BYTES);
        let fits = facts.parcel_bytes() <= MAX_PARCEL_BYTES;
        if fits && (has_no_trace || is_file) { Ok(facts) } else { Err(bad) }
    }
}

fn read_language(from: &mut ByteReader<'_>) -> Result<[u8; 2], BadBytes> {
    let bad = from.error_here("a language, two small letters");
    let language = [from.u8()?, from.u8()?];
    if language.iter().all(u8::is_ascii_lowercase) { Ok(language) } else { Err(bad) }
}

fn read_mode(from: &mut ByteReader<'_>) -> Result<SessionMode, BadBytes> {
    let bad = from.error_here("what a session starts from");
    let mode = SessionMode::from_bytes([from.u8()?, from.u8()?]);
    mode.filter(|&mode| mode != SessionMode::None).ok_or(bad)
}

/// Whether a file can have these lengths: deflate adds little to what it can't make shorter.
const fn has_lengths_of_file(packed: u32, raw: u32, max_raw: u32) -> bool {
    let longest = raw as u64 + raw as u64 / 1000 + MAX_PACKED_SURPLUS as u64;
    packed > 0 && raw > 0 && raw <= max_raw && packed as u64 <= longest
}
