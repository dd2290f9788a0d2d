//! Traces: a header, then for every tick its input and the digests it led to, at fixed widths.
//!
//! Little-endian. Header, [`HEADER_BYTES`] bytes: `PTRC`; u16 trace version; u16 core version (what
//! a tick computes); u16 N; u16 zero; u32 ticks; u64 digest of the start volumes; u64 digest of the
//! world before the first tick. Record, [`RECORD_BYTES`] bytes: the input, then the u64 digests of the
//! world's parts after it, in the order of [`PARTS`].

use crate::codec::{BadBytes, Reader, Writer};
use crate::input::Input;
use crate::maps::Maps;
use crate::save::{PARTS, combine};
use crate::volume::{maps_digest, mix};
use crate::world::Starts;

/// Length of the header.
pub const HEADER_BYTES: usize = 32;

/// Length of a record.
pub const RECORD_BYTES: usize = Input::BYTES + 8 * PARTS.len();

/// Changes with every change of the bytes of a trace.
pub const TRACE_VERSION: u16 = 2;

/// Changes with every change of what a tick computes.
pub const CORE_VERSION: u16 = 7;

/// The first bytes of a trace.
pub const MAGIC: [u8; 4] = *b"PTRC";

/// What a header of another [`TRACE_VERSION`] is told to be.
pub const EXPECTED_TRACE: &str = "trace version 2";

/// What a header of another [`CORE_VERSION`] is told to be.
pub const EXPECTED_CORE: &str = "core version 7";

/// What a trace was recorded on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Header {
    /// Voxels a side.
    pub size: u16,
    /// Records that follow: tells a trace that was cut short between two of them.
    pub ticks: u32,
    /// [`starts_digest`] of the start volumes.
    pub starts: u64,
    /// The world's digest before the first tick.
    pub first: u64,
}

/// A tick of a trace.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Record {
    /// What the tick was given.
    pub input: Input,
    /// The digests of the world's parts that it led to, so that a replay can tell which differs.
    pub parts: [u64; PARTS.len()],
}

impl Header {
    /// Writes [`HEADER_BYTES`] bytes.
    pub fn write(&self, to: &mut Writer<'_>) {
        to.bytes(&MAGIC);
        to.u16(TRACE_VERSION);
        to.u16(CORE_VERSION);
        to.u16(self.size);
        to.u16(0);
        to.u32(self.ticks);
        to.u64(self.starts);
        to.u64(self.first);
    }

    /// Reads what [`Header::write`] wrote.
    ///
    /// # Errors
    /// [`BadBytes`] for another magic, version or size, or at the end.
    pub fn read(from: &mut Reader<'_>) -> Result<Self, BadBytes> {
        let bad = from.bad("the magic PTRC");
        if from.bytes(4)? != MAGIC {
            return Err(bad);
        }
        let bad = from.bad(EXPECTED_TRACE);
        if from.u16()? != TRACE_VERSION {
            return Err(bad);
        }
        let bad = from.bad(EXPECTED_CORE);
        if from.u16()? != CORE_VERSION {
            return Err(bad);
        }
        let bad = from.bad("a size of 128 or 256");
        let size = from.u16()?;
        if size != 128 && size != 256 {
            return Err(bad);
        }
        let bad = from.bad("zero");
        if from.u16()? != 0 {
            return Err(bad);
        }
        Ok(Header { size, ticks: from.u32()?, starts: from.u64()?, first: from.u64()? })
    }
}

impl Record {
    /// The digest that the tick led to.
    #[must_use]
    pub fn digest(&self) -> u64 {
        combine(self.parts)
    }

    /// Writes [`RECORD_BYTES`] bytes.
    pub fn write(&self, to: &mut Writer<'_>) {
        self.input.write(to);
        self.parts.iter().for_each(|digest| to.u64(*digest));
    }

    /// Reads what [`Record::write`] wrote.
    ///
    /// # Errors
    /// [`BadBytes`] at the end, or for an input that can't be.
    pub fn read(from: &mut Reader<'_>) -> Result<Self, BadBytes> {
        let input = Input::read(from)?;
        let mut parts = [0; PARTS.len()];
        for digest in &mut parts {
            *digest = from.u64()?;
        }
        Ok(Record { input, parts })
    }
}

/// One digest of all volumes that a session can start from.
#[must_use]
pub fn starts_digest<const N: usize>(starts: &Starts<'_, N>) -> u64 {
    let all = [Some(starts.lump), Some(starts.creative), starts.own];
    let figures = starts.figures.iter().map(|maps| Some(*maps));
    all.into_iter().chain(figures).fold(N as u64, |sum, maps: Option<&Maps<N>>| {
        mix(sum.rotate_left(23) ^ maps.map_or(1, maps_digest))
    })
}
