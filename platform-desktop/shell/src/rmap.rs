//! The `.rmap` file format: a header, the three range maps of a volume as they lie in memory, and a
//! CRC-32. Reading checks every byte.
//!
//! Little-endian throughout. `L` is the number of intervals a column holds.
//!
//! | offset | bytes | what |
//! |---|---|---|
//! | 0 | 4 | magic, `RMAP` |
//! | 4 | 2 | version, 1 |
//! | 6 | 2 | N, voxels along an edge: 16, 32, 64, 128 or 256 |
//! | 8 | 1 | L, 1 |
//! | 9 | 1 | flags, none defined: 0 |
//! | 10 | 2 | zero |
//! | 12 | 2 L N² | columns along x: line y, place z |
//! | 12 + 2 L N² | 2 L N² | columns along y: line z, place x |
//! | 12 + 4 L N² | 2 L N² | columns along z: line y, place x |
//! | 12 + 6 L N² | 4 | CRC-32 (IEEE 802.3) of all bytes before it |
//!
//! A column at (line, place) of its map is interval number `line * N + place`: two bytes, the
//! complement of its first voxel, then its last voxel. Two zero bytes are an empty column. Every
//! interval is tight: its two end voxels lie in their columns of all three maps.

mod fault;

use std::io::{self, Read};
use std::path::Path;

use paros_core::{Axis, Column, Grid, Range, RangeMaps, Size};

use crate::durable;
pub use fault::{RmapError, RmapFault, RmapFaultAt};

const MAGIC: [u8; 4] = *b"RMAP";
const VERSION: u16 = 1;
const HEADER_BYTES: usize = 12;
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

/// Reads and checks the header alone. What follows it may still be wrong.
///
/// # Errors
/// When the file cannot be read or its header is not one.
pub fn read_header(path: &Path) -> Result<RmapHeader, RmapError> {
    let mut start = Vec::with_capacity(HEADER_BYTES);
    let file = durable::open_regular_file(path).map_err(|source| read_error(path, source))?;
    file.take(HEADER_BYTES as u64)
        .read_to_end(&mut start)
        .map_err(|source| read_error(path, source))?;
    parse_header(&start).map_err(|found| format_error(path, found))
}

/// Reads a volume of N^3 voxels. `maps` is unchanged unless the whole file is valid.
///
/// # Errors
/// When the file cannot be read, is no `.rmap`, is damaged, or holds another size.
pub fn read<const N: usize>(path: &Path, maps: &mut RangeMaps<N>) -> Result<(), RmapError>
where
    Grid<N>: Size,
{
    let header = read_header(path)?;
    if header.grid_side != N {
        let fault = RmapFault::OtherSize { found: header.grid_side, expected: N };
        return Err(format_error(path, RmapFaultAt { offset: 6, fault }));
    }
    let mut bytes = Vec::with_capacity(header.file_length() + 1);
    durable::open_regular_file(path)
        .and_then(|file| file.take(header.file_length() as u64 + 1).read_to_end(&mut bytes))
        .map_err(|source| read_error(path, source))?;
    decode(&bytes, maps).map_err(|found| format_error(path, found))
}

/// Writes a volume, whole or not at all.
///
/// # Errors
/// When the folder or the disk refuses.
pub fn write<const N: usize>(path: &Path, maps: &RangeMaps<N>) -> Result<(), durable::WriteError>
where
    Grid<N>: Size,
{
    durable::write_file(path, &encode(maps))
}

/// Encodes a volume as the bytes of a file.
#[must_use]
pub fn encode<const N: usize>(maps: &RangeMaps<N>) -> Vec<u8>
where
    Grid<N>: Size,
{
    let header = RmapHeader { version: VERSION, grid_side: N, intervals_per_column: 1 };
    let mut bytes = Vec::with_capacity(header.file_length());
    bytes.extend(MAGIC);
    bytes.extend(VERSION.to_le_bytes());
    bytes.extend((N as u16).to_le_bytes());
    bytes.extend([1, 0, 0, 0]);
    for axis in Axis::ALL {
        for line in 0..N {
            for column in maps.line(axis, line) {
                bytes.extend(column.0.iter().flat_map(|range| range.to_bytes()));
            }
        }
    }
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// The CRC-32 at the end of this volume's file: a fingerprint of its voxels.
#[must_use]
pub fn volume_checksum<const N: usize>(maps: &RangeMaps<N>) -> u32
where
    Grid<N>: Size,
{
    stored_checksum(&encode(maps))
}

/// Decodes the bytes of a file. `maps` is unchanged unless all of them are valid.
///
/// # Errors
/// The first fault found and where it lies.
pub fn decode<const N: usize>(bytes: &[u8], maps: &mut RangeMaps<N>) -> Result<(), RmapFaultAt>
where
    Grid<N>: Size,
{
    let header = parse_header(bytes)?;
    if header.grid_side != N {
        let fault = RmapFault::OtherSize { found: header.grid_side, expected: N };
        return Err(RmapFaultAt { offset: 6, fault });
    }
    let columns = RmapColumns { bytes: checked_columns(bytes, &header)?, grid_side: N };
    columns.check_ranges()?;
    columns.check_tightness()?;
    for axis in Axis::ALL {
        for address in columns.column_addresses() {
            maps.set_column(
                axis,
                address,
                Column([columns.range_or_empty_if_invalid(axis, address)]),
            );
        }
    }
    Ok(())
}

fn read_error(path: &Path, source: io::Error) -> RmapError {
    RmapError::Unreadable { path: path.to_owned(), source }
}

fn format_error(path: &Path, RmapFaultAt { offset, fault }: RmapFaultAt) -> RmapError {
    RmapError::Bad { path: path.to_owned(), offset, fault }
}

fn parse_header(bytes: &[u8]) -> Result<RmapHeader, RmapFaultAt> {
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
    if version != VERSION {
        return at(4, RmapFault::Version(version));
    }
    if !SIZES.contains(&n) {
        return at(6, RmapFault::Size(n));
    }
    if layers != 1 {
        return at(8, RmapFault::Layers(layers));
    }
    if let Some(i) = fill.iter().position(|&byte| byte != 0) {
        return at(9 + i, RmapFault::Flags(fill[i]));
    }
    Ok(RmapHeader { version, grid_side: n.into(), intervals_per_column: layers.into() })
}

/// Checks length and checksum and returns the bytes of the columns.
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

/// The last four bytes of a whole file.
fn stored_checksum(bytes: &[u8]) -> u32 {
    bytes.last_chunk().map_or(0, |&last| u32::from_le_bytes(last))
}

/// The column bytes of a file with one interval per column, not yet known to be tight.
struct RmapColumns<'a> {
    bytes: &'a [u8],
    grid_side: usize,
}

impl RmapColumns<'_> {
    fn column_addresses(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let n = self.grid_side;
        (0..n * n).map(move |i| (i / n, i % n))
    }

    /// The offset of a column's two bytes from the end of the header.
    fn offset_after_header(&self, axis: Axis, (line, place): (usize, usize)) -> usize {
        2 * ((axis as usize * self.grid_side + line) * self.grid_side + place)
    }

    fn column_bytes(&self, axis: Axis, address: (usize, usize)) -> [u8; 2] {
        let at = self.offset_after_header(axis, address);
        [self.bytes[at], self.bytes[at + 1]]
    }

    /// A column's range. Two bytes that are no range give the empty one.
    fn range_or_empty_if_invalid(&self, axis: Axis, address: (usize, usize)) -> Range {
        Range::from_bytes(self.column_bytes(axis, address), self.grid_side).unwrap_or(Range::EMPTY)
    }

    fn check_ranges(&self) -> Result<(), RmapFaultAt> {
        for axis in Axis::ALL {
            for address in self.column_addresses() {
                let bytes = self.column_bytes(axis, address);
                if Range::from_bytes(bytes, self.grid_side).is_none() {
                    let fault = RmapFault::Range { axis, address, bytes };
                    let offset = HEADER_BYTES + self.offset_after_header(axis, address);
                    return Err(RmapFaultAt { offset, fault });
                }
            }
        }
        Ok(())
    }

    /// A range is the hull of its column's occupied voxels exactly when both its ends are occupied,
    /// for no voxel outside it can be.
    fn check_tightness(&self) -> Result<(), RmapFaultAt> {
        for axis in Axis::ALL {
            for address in self.column_addresses() {
                let range = self.range_or_empty_if_invalid(axis, address);
                if range.is_empty() {
                    continue;
                }
                for (byte, end) in [range.first(), range.last()].into_iter().enumerate() {
                    let voxel = axis.voxel_at(address, end);
                    if let Some(missing) = self.first_axis_not_holding(voxel) {
                        let fault = RmapFault::Loose { axis, voxel, missing };
                        let offset = HEADER_BYTES + self.offset_after_header(axis, address) + byte;
                        return Err(RmapFaultAt { offset, fault });
                    }
                }
            }
        }
        Ok(())
    }

    /// The first axis along which the column through a voxel does not hold it.
    fn first_axis_not_holding(&self, voxel: [usize; 3]) -> Option<Axis> {
        let holds = |axis: Axis| {
            self.range_or_empty_if_invalid(axis, axis.column_address(voxel))
                .contains(voxel[axis as usize])
        };
        Axis::ALL.into_iter().find(|&axis| !holds(axis))
    }
}
