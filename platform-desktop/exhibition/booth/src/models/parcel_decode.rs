//! Validation of a parcel's files before it is kept. Memory is bounded, and time is bounded by the parcel's
//! length.

use std::io::Read as _;

use flate2::read::DeflateDecoder;
use paros_core::codec::ByteReader;
use paros_core::codec::trace::{HEADER_BYTES, RECORD_BYTES, TickRecord, TraceHeader};
use paros_core::volume::{Grid, Size};
use paros_protocol::UploadFacts;
use paros_shell::rmap;
use paros_shell::statics::Resident;
use paros_shell::{with_intervals, with_size};

/// Checks that a parcel's files match its head.
///
/// # Errors
/// The part that doesn't match, and what was expected.
pub fn check_parcel(facts: &UploadFacts, volume: &[u8], trace: &[u8]) -> Result<(), String> {
    check_volume(facts, &unpack_volume(facts, volume)?)?;
    if facts.trace_bytes > 0 {
        check_trace(trace, facts.trace_raw_bytes).map_err(|why| format!("trace: {why}"))?;
    }
    Ok(())
}

/// Unpacks the volume of a parcel.
///
/// # Errors
/// A description of what is wrong with the volume.
pub(crate) fn unpack_volume(facts: &UploadFacts, packed: &[u8]) -> Result<Vec<u8>, String> {
    // The length is safe to allocate: it was limited when the head was parsed.
    unpack(packed, facts.volume_raw_bytes).map_err(|why| format!("volume: {why}"))
}

/// Unpacks all of `packed` to exactly `length` bytes. Stops at the first extra byte, so that a decompression
/// bomb is harmless.
fn unpack(packed: &[u8], length: u32) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::with_capacity(length as usize);
    let mut decoder = DeflateDecoder::new(packed);
    let read = decoder.by_ref().take(u64::from(length) + 1).read_to_end(&mut bytes);
    read.map_err(|error| format!("not packed by deflate: {error}"))?;
    if bytes.len() != length as usize {
        return Err(format!("unpacked it isn't {length} bytes long"));
    }
    if decoder.total_in() != packed.len() as u64 {
        return Err("bytes after its end".into());
    }
    Ok(bytes)
}

/// Checks a packed trace record by record, as an unpacked trace is too large for memory.
fn check_trace(packed: &[u8], length: u32) -> Result<(), String> {
    let mut unpacked = DeflateDecoder::new(packed).take(u64::from(length) + 1);
    let mut read = |bytes: &mut [u8]| {
        unpacked.read_exact(bytes).map_err(|error| format!("not packed, or too short: {error}"))
    };
    let mut head = [0; HEADER_BYTES];
    read(&mut head)?;
    let header = TraceHeader::read(&mut ByteReader::new(&head))
        .map_err(|bad| format!("byte {}: expected {}", bad.offset, bad.expected))?;
    let ticks = u64::from(header.ticks);
    if HEADER_BYTES as u64 + ticks * RECORD_BYTES as u64 != u64::from(length) {
        return Err(format!("{ticks} ticks aren't {length} bytes"));
    }
    let mut record = [0; RECORD_BYTES];
    for tick in 0..ticks {
        read(&mut record)?;
        TickRecord::read(&mut ByteReader::new(&record)).map_err(|bad| {
            format!("tick {tick}, byte {}: expected {}", bad.offset, bad.expected)
        })?;
    }
    let mut more = [0; 1];
    let is_over = unpacked.read(&mut more).is_ok_and(|count| count == 0);
    let decoder = unpacked.into_inner();
    let is_all = is_over && decoder.total_in() == packed.len() as u64;
    if is_all { Ok(()) } else { Err("bytes after its end".into()) }
}

fn check_volume(facts: &UploadFacts, bytes: &[u8]) -> Result<(), String> {
    let header = rmap::parse_header(bytes).map_err(|fault| fault.to_string())?;
    if header.grid_side != usize::from(facts.side) {
        return Err(format!("its side is {}, not that of its head", header.grid_side));
    }
    let intervals = header.intervals_per_column;
    let other = || Err(format!("{intervals} intervals a column; 1 or 2 are known here"));
    with_size!(header.grid_side, N => with_intervals!(
        intervals, K => decode_volume::<N, K>(bytes), else other(),
    ), else other())
}

fn decode_volume<const N: usize, const K: usize>(bytes: &[u8]) -> Result<(), String>
where
    Grid<N>: Size + Resident<N, K>,
{
    let mut maps = <Grid<N> as Resident<N, K>>::lock_range_maps();
    rmap::decode(bytes, &mut maps).map_err(|fault| fault.to_string())
}
