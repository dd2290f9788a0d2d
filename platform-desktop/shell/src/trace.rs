//! Trace files, which are read and checked as a whole before the first tick is replayed.

use std::io;
use std::path::{Path, PathBuf};

use paros_core::codec::trace::{HEADER_BYTES, RECORD_BYTES, TickRecord, TraceHeader};
use paros_core::codec::{BadBytes, ByteReader};
use paros_core::limits::INTERVALS;

use crate::durable;

/// A trace in memory.
#[derive(Debug)]
pub struct Trace {
    header: TraceHeader,
    records: Vec<TickRecord>,
}

/// The reason why a file is no trace.
#[derive(Debug, thiserror::Error)]
pub enum TraceError {
    /// The file can't be read.
    #[error("{path}: cannot read: {1}", path = .0.display())]
    Read(PathBuf, io::Error),
    /// The header is invalid at a byte.
    #[error("{}: no trace: expected {} at byte {}", .0.display(), .1.expected, .1.offset)]
    Header(PathBuf, BadBytes),
    /// A tick's record is invalid at a byte of the file.
    #[error("{}: tick {tick}: expected {} at byte {}", path.display(), bad.expected, bad.offset)]
    Record {
        /// The file.
        path: PathBuf,
        /// The tick, from 0.
        tick: usize,
        /// The invalid bytes.
        bad: BadBytes,
    },
}

/// A fault of a trace file's bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TraceFault {
    /// The tick whose record is invalid, from 0; `None` for the header.
    pub tick: Option<usize>,
    /// The invalid bytes, and their offset in the file.
    pub bad: BadBytes,
}

/// The first difference of a replay from its trace.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum ReplayDivergence {
    /// The trace was recorded at another size.
    #[error("before tick 0: recorded at {recorded} voxels a side, played at {here}")]
    Size {
        /// The number in the trace.
        recorded: u16,
        /// The world's number.
        here: u16,
    },
    /// The trace was recorded with another number of intervals per column.
    #[error("before tick 0: intervals a column: {recorded} as recorded, {here} here")]
    Intervals {
        /// The number in the trace.
        recorded: u16,
        /// The world's number.
        here: u16,
    },
    /// The trace was recorded on other start volumes.
    #[error(
        "before tick 0: recorded on other start volumes (digest {recorded:016x}, these have {here:016x})"
    )]
    Starts {
        /// The digest in the trace.
        recorded: u64,
        /// The digest here.
        here: u64,
    },
    /// The trace was recorded from another state of the world.
    #[error(
        "before tick 0: recorded from another state (digest {recorded:016x}, this one has {here:016x})"
    )]
    State {
        /// The digest in the trace.
        recorded: u64,
        /// The digest here.
        here: u64,
    },
    /// A tick, the first such one, led to another state.
    #[error(
        "tick {tick}: another state of {part} (digest {here:016x}, the trace has {recorded:016x})"
    )]
    Tick {
        /// The tick, from 0.
        tick: usize,
        /// The first part of the state that differs, one of
        /// [`DIGEST_PARTS`](paros_core::internals::DIGEST_PARTS).
        part: &'static str,
        /// The digest in the trace.
        recorded: u64,
        /// The digest here.
        here: u64,
    },
}

impl Trace {
    /// Reads a trace file.
    ///
    /// # Errors
    /// Returns a [`TraceError`] with the file and the offset or tick.
    pub fn read(path: &Path) -> Result<Self, TraceError> {
        let bytes =
            durable::read_regular_file(path).map_err(|e| TraceError::Read(path.into(), e))?;
        Self::decode(&bytes).map_err(|TraceFault { tick, bad }| match tick {
            None => TraceError::Header(path.into(), bad),
            Some(tick) => TraceError::Record { path: path.into(), tick, bad },
        })
    }

    /// Decodes the bytes of a trace file.
    ///
    /// # Errors
    /// Returns a [`TraceFault`] whose offset counts from the file's start.
    pub fn decode(bytes: &[u8]) -> Result<Self, TraceFault> {
        let header = TraceHeader::read(&mut ByteReader::new(bytes))
            .map_err(|bad| TraceFault { tick: None, bad })?;
        let mut records = Vec::with_capacity(bytes.len() / RECORD_BYTES);
        let chunks = bytes[HEADER_BYTES..].chunks(RECORD_BYTES);
        for (tick, chunk) in chunks.enumerate() {
            let record = TickRecord::read(&mut ByteReader::new(chunk)).map_err(|bad| {
                let start = HEADER_BYTES + tick * RECORD_BYTES;
                TraceFault { tick: Some(tick), bad: BadBytes { offset: start + bad.offset, ..bad } }
            })?;
            records.push(record);
        }
        if records.len() != header.ticks as usize {
            let tick = records.len().min(header.ticks as usize);
            let expected = "as many ticks as the header says";
            return Err(TraceFault {
                tick: Some(tick),
                bad: BadBytes { offset: HEADER_BYTES + tick * RECORD_BYTES, expected },
            });
        }
        Ok(Trace { header, records })
    }

    /// Returns the header: size, tick count and digests.
    #[must_use]
    pub const fn header(&self) -> TraceHeader {
        self.header
    }

    /// Returns the records, one per tick.
    pub fn records(&self) -> impl ExactSizeIterator<Item = &TickRecord> {
        self.records.iter()
    }
}

impl ReplayDivergence {
    /// Returns the divergence of a trace whose columns have another number of intervals than any world here.
    #[must_use]
    pub const fn no_world_of_intervals(header: &TraceHeader) -> Self {
        ReplayDivergence::Intervals { recorded: header.intervals, here: INTERVALS as u16 }
    }
}
