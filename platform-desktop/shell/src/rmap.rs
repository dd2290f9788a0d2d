//! The `.rmap` file format: a header, the three range maps of a volume as they lie in memory, and a
//! CRC-32. Reading checks every byte.
//!
//! All numbers are little-endian. `L` is the number of intervals a column holds, 1 to 4. Files with L = 1 are
//! written as version 1, others as version 2; both are read.
//!
//! | offset | bytes | what |
//! |---|---|---|
//! | 0 | 4 | magic, `RMAP` |
//! | 4 | 2 | version: 1 where L is 1, otherwise 2 |
//! | 6 | 2 | N, voxels along an edge: 16, 32, 64, 128 or 256 |
//! | 8 | 1 | L |
//! | 9 | 1 | flags, none defined: 0 |
//! | 10 | 2 | zero |
//! | 12 | 2 L N² | columns along x: line y, place z |
//! | 12 + 2 L N² | 2 L N² | columns along y: line z, place x |
//! | 12 + 4 L N² | 2 L N² | columns along z: line y, place x |
//! | 12 + 6 L N² | 4 | CRC-32 (IEEE 802.3) of all bytes before it |
//!
//! The column at (line, place) of its map has the number `line * N + place`. It has L intervals, the lowest
//! first, with at least one voxel between two of them, and empty ones last. An interval is two bytes: the
//! complement of its first voxel, then its last voxel; two zero bytes are an empty interval.
//!
//! The volume is the set of voxels that lie in their columns of all three maps. Every interval is *tight*:
//! its two end voxels are in the volume. If L is more than 1, every column is *saturated*: if its last
//! interval is empty, all voxels of the others are in the volume. See [`Volume`](paros_core::Volume).
//!
//! A file is read exactly into maps with more intervals per column: its gaps are kept, and the longest other
//! empty runs become gaps where there is room. Two volumes of the same voxels may hold different gaps; then
//! their files, and so their checksums, differ.

mod columns;
mod fault;

use std::io::{self, Read};
use std::path::Path;

use paros_core::RangeMaps;
use paros_core::limits::MAX_INTERVALS;
use paros_core::volume::{Axis, Grid, Size};

use crate::durable;
use crate::sizes::GRID_SIDES;
use columns::FileColumns;
pub use fault::{RmapError, RmapFault, RmapFaultAt};

/// The first bytes of a file.
pub const MAGIC: [u8; 4] = *b"RMAP";
/// The versions for one interval per column, and for several.
const VERSION_OF_ONE: u16 = 1;
const VERSION_OF_MORE: u16 = 2;
const HEADER_BYTES: usize = 12;
const SIZE_OFFSET: usize = 6;
const INTERVALS_OFFSET: usize = 8;
const CHECKSUM_BYTES: usize = 4;
const SIZES: [u16; 5] = [16, 32, 64, 128, 256];

/// The header of an `.rmap` file.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RmapHeader {
    /// Format version.
    pub version: u16,
    /// Voxels along an edge of the grid (N).
    pub grid_side: usize,
    /// Intervals per column (L).
    pub intervals_per_column: usize,
}

impl RmapHeader {
    /// Length of the whole file in bytes.
    #[must_use]
    pub fn file_length(&self) -> usize {
        HEADER_BYTES
            + 3 * self.grid_side * self.grid_side * self.intervals_per_column * 2
            + CHECKSUM_BYTES
    }
}

/// Reads and checks only the header. The bytes after it may still be wrong.
///
/// # Errors
/// Returns an error if the file cannot be read or its header is invalid.
pub fn read_header(path: &Path) -> Result<RmapHeader, RmapError> {
    let mut start = Vec::with_capacity(HEADER_BYTES);
    let file = durable::open_regular_file(path).map_err(|source| read_error(path, source))?;
    file.take(HEADER_BYTES as u64)
        .read_to_end(&mut start)
        .map_err(|source| read_error(path, source))?;
    parse_header(&start).map_err(|found| format_error(path, found))
}

/// Reads and checks only the header, which must be a sculpture's: its size must be one of [`GRID_SIDES`].
///
/// # Errors
/// Returns the errors of [`read_header`], and an error for another size.
pub fn read_sculpture_header(path: &Path) -> Result<RmapHeader, RmapError> {
    let header = read_header(path)?;
    if !GRID_SIDES.contains(&header.grid_side) {
        let fault = RmapFault::UnusableSize(header.grid_side);
        return Err(format_error(path, RmapFaultAt { offset: SIZE_OFFSET, fault }));
    }
    Ok(header)
}

/// Reads a volume of N^3 voxels and at most K intervals per column. `maps` is unchanged unless the whole file
/// is valid.
///
/// # Errors
/// Returns an error if the file cannot be read, is no `.rmap`, is damaged, or has another size or more
/// intervals.
#[inline(never)]
pub fn read<const N: usize, const K: usize>(
    path: &Path,
    maps: &mut RangeMaps<N, K>,
) -> Result<(), RmapError>
where
    Grid<N>: Size,
{
    read_as(path, maps, Excess::Refuse).map(drop)
}

/// Reads a volume of N^3 voxels and any number of intervals per column. If the file has more than K, its
/// closure in K intervals is read. Returns the number of voxels that closure added. `maps` is unchanged
/// unless the whole file is valid.
///
/// # Errors
/// Returns an error if the file cannot be read, is no `.rmap`, is damaged, or has another size.
#[inline(never)]
pub fn read_closed<const N: usize, const K: usize>(
    path: &Path,
    maps: &mut RangeMaps<N, K>,
) -> Result<u64, RmapError>
where
    Grid<N>: Size,
{
    read_as(path, maps, Excess::Close)
}

fn read_as<const N: usize, const K: usize>(
    path: &Path,
    maps: &mut RangeMaps<N, K>,
    excess: Excess,
) -> Result<u64, RmapError>
where
    Grid<N>: Size,
{
    let header = read_header(path)?;
    check_fit::<N, K>(&header, excess).map_err(|found| format_error(path, found))?;
    let mut bytes = Vec::with_capacity(header.file_length() + 1);
    durable::open_regular_file(path)
        .and_then(|file| file.take(header.file_length() as u64 + 1).read_to_end(&mut bytes))
        .map_err(|source| read_error(path, source))?;
    decode_as(&bytes, maps, excess).map_err(|found| format_error(path, found))
}

/// Writes a volume atomically.
///
/// # Errors
/// Returns the error of [`durable::write_file`].
pub fn write<const N: usize, const K: usize>(
    path: &Path,
    maps: &RangeMaps<N, K>,
) -> Result<(), durable::WriteError>
where
    Grid<N>: Size,
{
    durable::write_file(path, &encode(maps))
}

/// Encodes a volume as the bytes of a file.
#[must_use]
#[inline(never)]
pub fn encode<const N: usize, const K: usize>(maps: &RangeMaps<N, K>) -> Vec<u8>
where
    Grid<N>: Size,
{
    const { assert!(0 < K && K <= MAX_INTERVALS) };
    let version = if K == 1 { VERSION_OF_ONE } else { VERSION_OF_MORE };
    let header = RmapHeader { version, grid_side: N, intervals_per_column: K };
    let mut bytes = Vec::with_capacity(header.file_length());
    bytes.extend(MAGIC);
    bytes.extend(version.to_le_bytes());
    bytes.extend((N as u16).to_le_bytes());
    bytes.extend([K as u8, 0, 0, 0]);
    for axis in Axis::ALL {
        for line in 0..N {
            for column in maps.line(axis, line) {
                bytes.extend(column.to_bytes().as_flattened());
            }
        }
    }
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// Returns the CRC-32 at the end of this volume's file: a fingerprint of its maps. With several intervals per
/// column, volumes of the same voxels may hold different gaps, and so have different fingerprints.
#[must_use]
#[inline(never)]
pub fn volume_checksum<const N: usize, const K: usize>(maps: &RangeMaps<N, K>) -> u32
where
    Grid<N>: Size,
{
    stored_checksum(&encode(maps))
}

/// Decodes the bytes of a file with at most K intervals per column. `maps` is unchanged unless the whole file
/// is valid.
///
/// # Errors
/// Returns the first fault and its offset.
#[inline(never)]
pub fn decode<const N: usize, const K: usize>(
    bytes: &[u8],
    maps: &mut RangeMaps<N, K>,
) -> Result<(), RmapFaultAt>
where
    Grid<N>: Size,
{
    decode_as(bytes, maps, Excess::Refuse).map(drop)
}

/// Decodes the bytes of a file, like [`read_closed`].
///
/// # Errors
/// Returns the first fault and its offset.
#[inline(never)]
pub fn decode_closed<const N: usize, const K: usize>(
    bytes: &[u8],
    maps: &mut RangeMaps<N, K>,
) -> Result<u64, RmapFaultAt>
where
    Grid<N>: Size,
{
    decode_as(bytes, maps, Excess::Close)
}

/// The handling of a file with more intervals per column than the maps.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Excess {
    Refuse,
    Close,
}

fn decode_as<const N: usize, const K: usize>(
    bytes: &[u8],
    maps: &mut RangeMaps<N, K>,
    excess: Excess,
) -> Result<u64, RmapFaultAt>
where
    Grid<N>: Size,
{
    let header = parse_header(bytes)?;
    check_fit::<N, K>(&header, excess)?;
    let columns = checked_columns(bytes, &header)?;
    match header.intervals_per_column {
        1 => FileColumns::<N, 1>::decode_into(columns, maps),
        2 => FileColumns::<N, 2>::decode_into(columns, maps),
        3 => FileColumns::<N, 3>::decode_into(columns, maps),
        _ => FileColumns::<N, MAX_INTERVALS>::decode_into(columns, maps),
    }
}

/// Checks that a volume fits into maps of N voxels a side and K intervals per column.
fn check_fit<const N: usize, const K: usize>(
    header: &RmapHeader,
    excess: Excess,
) -> Result<(), RmapFaultAt> {
    let (side, intervals) = (header.grid_side, header.intervals_per_column);
    if side != N {
        let fault = RmapFault::OtherSize { found: side, expected: N };
        return Err(RmapFaultAt { offset: SIZE_OFFSET, fault });
    }
    if intervals > K && excess == Excess::Refuse {
        let fault = RmapFault::OtherIntervals { found: intervals, expected: K };
        return Err(RmapFaultAt { offset: INTERVALS_OFFSET, fault });
    }
    Ok(())
}

fn read_error(path: &Path, source: io::Error) -> RmapError {
    RmapError::Unreadable { path: path.to_owned(), source }
}

fn format_error(path: &Path, RmapFaultAt { offset, fault }: RmapFaultAt) -> RmapError {
    RmapError::Bad { path: path.to_owned(), offset, fault }
}

/// Reads and checks the header at the start of a file's bytes. The bytes after it may still be wrong.
///
/// # Errors
/// Returns the first fault and its offset.
pub fn parse_header(bytes: &[u8]) -> Result<RmapHeader, RmapFaultAt> {
    if let Some(&magic) = bytes.first_chunk()
        && magic != MAGIC
    {
        return Err(RmapFaultAt { offset: 0, fault: RmapFault::Magic(magic) });
    }
    let at = |offset, fault| Err(RmapFaultAt { offset, fault });
    let Some(&[_, _, _, _, v0, v1, n0, n1, layers, fill @ ..]) =
        bytes.first_chunk::<HEADER_BYTES>()
    else {
        return at(bytes.len(), RmapFault::Truncated { expected: HEADER_BYTES });
    };
    let (version, n) = (u16::from_le_bytes([v0, v1]), u16::from_le_bytes([n0, n1]));
    if ![VERSION_OF_ONE, VERSION_OF_MORE].contains(&version) {
        return at(4, RmapFault::Version(version));
    }
    if !SIZES.contains(&n) {
        return at(SIZE_OFFSET, RmapFault::Size(n));
    }
    let held = if version == VERSION_OF_ONE { 1..=1 } else { 2..=MAX_INTERVALS };
    if !held.contains(&layers.into()) {
        return at(INTERVALS_OFFSET, RmapFault::Layers { version, found: layers });
    }
    if let Some(i) = fill.iter().position(|&byte| byte != 0) {
        return at(9 + i, RmapFault::Flags(fill[i]));
    }
    Ok(RmapHeader { version, grid_side: n.into(), intervals_per_column: layers.into() })
}

/// Checks length and checksum. Returns the bytes of the columns.
fn checked_columns<'a>(bytes: &'a [u8], header: &RmapHeader) -> Result<&'a [u8], RmapFaultAt> {
    let at = |offset, fault| Err(RmapFaultAt { offset, fault });
    let length = header.file_length();
    if bytes.len() < length {
        return at(bytes.len(), RmapFault::Truncated { expected: length });
    }
    if bytes.len() > length {
        return at(length, RmapFault::Trailing);
    }
    let summed = &bytes[..length - CHECKSUM_BYTES];
    let (found, expected) = (stored_checksum(bytes), crc32fast::hash(summed));
    if found != expected {
        return at(length - CHECKSUM_BYTES, RmapFault::Checksum { found, expected });
    }
    Ok(&summed[HEADER_BYTES..])
}

/// Returns the checksum in the last four bytes of a whole file.
fn stored_checksum(bytes: &[u8]) -> u32 {
    bytes.last_chunk().map_or(0, |&last| u32::from_le_bytes(last))
}
