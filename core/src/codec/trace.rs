//! Traces: a header, then a record of each tick with its input and the resulting digests, at fixed widths.
//!
//! Little-endian. Header, [`HEADER_BYTES`] bytes: `PTRC`; u16 trace version; u16 core version (what
//! a tick computes); u16 N; u16 K, the intervals of a column, written as 0 where there is one; u32 ticks;
//! u64 digest of the start volumes; u64 digest of the world before the first tick. Record, [`RECORD_BYTES`]
//! bytes: the input, then the u64 digests of the world's parts after it, in the order of
//! [`DIGEST_PARTS`].

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::digest::{DIGEST_PARTS, combine_digests, mix_bits};
use crate::limits::MAX_INTERVALS;
use crate::session::input::TickInput;
use crate::session::start_volumes::StartVolumes;
use crate::volume::column_digest::maps_digest;
use crate::volume::range_maps::RangeMaps;

/// Length of the header in bytes.
pub const HEADER_BYTES: usize = 32;

/// Length of a record in bytes.
pub const RECORD_BYTES: usize = TickInput::BYTES + 8 * DIGEST_PARTS.len();

/// Version of the trace format. Increment it with every change of the format.
pub const TRACE_VERSION: u16 = 3;

/// Version of a tick's computation. Increment it with every change of the result, for any number of
/// intervals.
pub const CORE_VERSION: u16 = 13;

/// The first bytes of a trace.
pub const MAGIC: [u8; 4] = *b"PTRC";

/// The expectation reported for another [`TRACE_VERSION`].
pub const EXPECTED_TRACE_VERSION: &str = "trace version 3";

/// The expectation reported for another [`CORE_VERSION`].
pub const EXPECTED_CORE_VERSION: &str = "core version 13";

/// The header of a trace: the world it was recorded on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TraceHeader {
    /// Voxels a side.
    pub side: u16,
    /// Intervals of a column, 1 to [`MAX_INTERVALS`].
    pub intervals: u16,
    /// Number of records, used to detect a truncated trace.
    pub ticks: u32,
    /// [`digest_start_volumes`] of the start volumes.
    pub starts_digest: u64,
    /// The world's digest before the first tick.
    pub first_digest: u64,
}

/// A record of a trace: one tick.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct TickRecord {
    /// The tick's input.
    pub input: TickInput,
    /// The digests of the world's parts after the tick, so that a replay can name the part that
    /// differs.
    pub part_digests: [u64; DIGEST_PARTS.len()],
}

impl TraceHeader {
    /// Writes [`HEADER_BYTES`] bytes.
    pub fn write(&self, to: &mut ByteWriter<'_>) {
        to.bytes(&MAGIC);
        to.u16(TRACE_VERSION);
        to.u16(CORE_VERSION);
        to.u16(self.side);
        // Traces from before K was introduced have 0 here.
        to.u16(if self.intervals == 1 { 0 } else { self.intervals });
        to.u32(self.ticks);
        to.u64(self.starts_digest);
        to.u64(self.first_digest);
    }

    /// Reads the output of [`TraceHeader::write`].
    ///
    /// # Errors
    /// [`BadBytes`] for another magic or version, an unsupported size or number of intervals, or if the bytes
    /// end early.
    pub fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let bad = from.error_here("the magic PTRC");
        if from.bytes(4)? != MAGIC {
            return Err(bad);
        }
        let bad = from.error_here(EXPECTED_TRACE_VERSION);
        if from.u16()? != TRACE_VERSION {
            return Err(bad);
        }
        let bad = from.error_here(EXPECTED_CORE_VERSION);
        if from.u16()? != CORE_VERSION {
            return Err(bad);
        }
        let bad = from.error_here("a size of 128 or 256");
        let size = from.u16()?;
        if size != 128 && size != 256 {
            return Err(bad);
        }
        let bad = from.error_here("0 to 4 intervals a column");
        let intervals = from.u16()?.max(1);
        if usize::from(intervals) > MAX_INTERVALS {
            return Err(bad);
        }
        Ok(TraceHeader {
            side: size,
            intervals,
            ticks: from.u32()?,
            starts_digest: from.u64()?,
            first_digest: from.u64()?,
        })
    }
}

impl TickRecord {
    /// Returns the world's digest after the tick.
    #[must_use]
    pub fn digest(&self) -> u64 {
        combine_digests(self.part_digests)
    }

    /// Writes [`RECORD_BYTES`] bytes.
    pub fn write(&self, to: &mut ByteWriter<'_>) {
        self.input.write(to);
        self.part_digests.iter().for_each(|digest| to.u64(*digest));
    }

    /// Reads the output of [`TickRecord::write`].
    ///
    /// # Errors
    /// [`BadBytes`] if the bytes end early, or for an invalid input.
    pub fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let input = TickInput::read(from)?;
        let mut parts = [0; DIGEST_PARTS.len()];
        for digest in &mut parts {
            *digest = from.u64()?;
        }
        Ok(TickRecord { input, part_digests: parts })
    }
}

/// Returns the digest of all start volumes, in order.
#[must_use]
#[inline(never)]
pub fn digest_start_volumes<const N: usize, const K: usize>(
    starts: &StartVolumes<'_, N, K>,
) -> u64 {
    let all = [Some(starts.lump), Some(starts.creative), starts.own];
    let figures = starts.figures.iter().flat_map(|hidden| [hidden.figure, hidden.stone]).map(Some);
    all.into_iter().chain(figures).fold(N as u64, |sum, maps: Option<&RangeMaps<N, K>>| {
        mix_bits(sum.rotate_left(23) ^ maps.map_or(1, maps_digest))
    })
}
