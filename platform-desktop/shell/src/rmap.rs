//! The `.rmap` file: the three range maps of a volume as they lie in memory, between a header and a
//! checksum.
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

use paros_core::maps::{Axis, Column, Maps, Range};
use paros_core::size::{Grid, Size};

use crate::durable;
pub use fault::{Error, Fault};

const MAGIC: [u8; 4] = *b"RMAP";
const VERSION: u16 = 1;
const HEADER: usize = 12;
const CHECKSUM: usize = 4;
const SIZES: [u16; 5] = [16, 32, 64, 128, 256];

/// What a file says of itself, before its columns.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Header {
    /// Version of the layout.
    pub version: u16,
    /// Voxels along an edge.
    pub n: usize,
    /// Intervals a column.
    pub layers: usize,
}

impl Header {
    /// Length of the whole file in bytes.
    #[must_use]
    pub fn file_length(&self) -> usize {
        HEADER + 3 * self.n * self.n * self.layers * 2 + CHECKSUM
    }
}

/// Reads and checks the header alone; what follows it may still be wrong.
///
/// # Errors
/// When the file cannot be read or its header is not one.
pub fn peek(path: &Path) -> Result<Header, Error> {
    let mut start = Vec::with_capacity(HEADER);
    let file = durable::open(path).map_err(|source| unreadable(path, source))?;
    file.take(HEADER as u64).read_to_end(&mut start).map_err(|source| unreadable(path, source))?;
    header(&start).map_err(|(offset, fault)| bad(path, offset, fault))
}

/// Reads a volume of N^3 voxels. `maps` is untouched unless the whole file is right.
///
/// # Errors
/// When the file cannot be read, is no `.rmap`, is damaged, or holds another size.
pub fn read<const N: usize>(path: &Path, maps: &mut Maps<N>) -> Result<(), Error>
where
    Grid<N>: Size,
{
    let header = peek(path)?;
    if header.n != N {
        return Err(bad(path, 6, Fault::OtherSize { found: header.n, expected: N }));
    }
    let mut bytes = Vec::with_capacity(header.file_length() + 1);
    durable::open(path)
        .and_then(|file| file.take(header.file_length() as u64 + 1).read_to_end(&mut bytes))
        .map_err(|source| unreadable(path, source))?;
    decode(&bytes, maps).map_err(|(offset, fault)| bad(path, offset, fault))
}

/// Writes a volume, whole or not at all.
///
/// # Errors
/// When the folder or the disk refuses.
pub fn write<const N: usize>(path: &Path, maps: &Maps<N>) -> Result<(), durable::Error>
where
    Grid<N>: Size,
{
    durable::write(path, &encode(maps))
}

/// The bytes of a file.
#[must_use]
pub fn encode<const N: usize>(maps: &Maps<N>) -> Vec<u8>
where
    Grid<N>: Size,
{
    let header = Header { version: VERSION, n: N, layers: 1 };
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

/// The checksum that a file of this volume ends in: a short name for its exact voxels.
#[must_use]
pub fn checksum<const N: usize>(maps: &Maps<N>) -> u32
where
    Grid<N>: Size,
{
    stored_checksum(&encode(maps))
}

/// Reads the bytes of a file. `maps` is untouched unless all of them are right.
///
/// # Errors
/// The first fault found and the offset of the byte where it lies.
pub fn decode<const N: usize>(bytes: &[u8], maps: &mut Maps<N>) -> Result<(), (usize, Fault)>
where
    Grid<N>: Size,
{
    let header = header(bytes)?;
    if header.n != N {
        return Err((6, Fault::OtherSize { found: header.n, expected: N }));
    }
    let columns = Columns { bytes: checked_columns(bytes, &header)?, n: N };
    columns.check_ranges()?;
    columns.check_tightness()?;
    for axis in Axis::ALL {
        for address in columns.addresses() {
            maps.set_column(axis, address, Column([columns.range(axis, address)]));
        }
    }
    Ok(())
}

fn unreadable(path: &Path, source: io::Error) -> Error {
    Error::Unreadable { path: path.to_owned(), source }
}

fn bad(path: &Path, offset: usize, fault: Fault) -> Error {
    Error::Bad { path: path.to_owned(), offset, fault }
}

fn header(bytes: &[u8]) -> Result<Header, (usize, Fault)> {
    if let Some(&magic) = bytes.first_chunk()
        && magic != MAGIC
    {
        return Err((0, Fault::Magic(magic)));
    }
    let Some(&[_, _, _, _, v0, v1, n0, n1, layers, fill @ ..]) = bytes.first_chunk::<HEADER>()
    else {
        return Err((bytes.len(), Fault::Truncated { expected: HEADER }));
    };
    let (version, n) = (u16::from_le_bytes([v0, v1]), u16::from_le_bytes([n0, n1]));
    if version != VERSION {
        return Err((4, Fault::Version(version)));
    }
    if !SIZES.contains(&n) {
        return Err((6, Fault::Size(n)));
    }
    if layers != 1 {
        return Err((8, Fault::Layers(layers)));
    }
    if let Some(i) = fill.iter().position(|&byte| byte != 0) {
        return Err((9 + i, Fault::Flags(fill[i])));
    }
    Ok(Header { version, n: n.into(), layers: layers.into() })
}

/// The bytes of the columns, once length and checksum are right.
fn checked_columns<'a>(bytes: &'a [u8], header: &Header) -> Result<&'a [u8], (usize, Fault)> {
    let length = header.file_length();
    if bytes.len() < length {
        return Err((bytes.len(), Fault::Truncated { expected: length }));
    }
    if bytes.len() > length {
        return Err((length, Fault::Trailing));
    }
    let summed = &bytes[..length - CHECKSUM];
    let (found, expected) = (stored_checksum(bytes), crc32fast::hash(summed));
    if found != expected {
        return Err((length - CHECKSUM, Fault::Checksum { found, expected }));
    }
    Ok(&summed[HEADER..])
}

/// The last four bytes of a whole file.
fn stored_checksum(bytes: &[u8]) -> u32 {
    bytes.last_chunk().map_or(0, |&last| u32::from_le_bytes(last))
}

/// The columns of a file with one interval each, before they are known to be tight.
struct Columns<'a> {
    bytes: &'a [u8],
    n: usize,
}

impl Columns<'_> {
    fn addresses(&self) -> impl Iterator<Item = (usize, usize)> + use<> {
        let n = self.n;
        (0..n * n).map(move |i| (i / n, i % n))
    }

    /// Where a column's two bytes start among the columns.
    fn offset(&self, axis: Axis, (line, place): (usize, usize)) -> usize {
        2 * ((axis as usize * self.n + line) * self.n + place)
    }

    fn pair(&self, axis: Axis, address: (usize, usize)) -> [u8; 2] {
        let at = self.offset(axis, address);
        [self.bytes[at], self.bytes[at + 1]]
    }

    /// A column's range; bytes that are none count as empty.
    fn range(&self, axis: Axis, address: (usize, usize)) -> Range {
        Range::from_bytes(self.pair(axis, address), self.n).unwrap_or(Range::EMPTY)
    }

    fn check_ranges(&self) -> Result<(), (usize, Fault)> {
        for axis in Axis::ALL {
            for address in self.addresses() {
                let bytes = self.pair(axis, address);
                if Range::from_bytes(bytes, self.n).is_none() {
                    let fault = Fault::Range { axis, address, bytes };
                    return Err((HEADER + self.offset(axis, address), fault));
                }
            }
        }
        Ok(())
    }

    /// A range is the hull of its column's occupied voxels exactly when both its ends are occupied,
    /// for no voxel outside it can be.
    fn check_tightness(&self) -> Result<(), (usize, Fault)> {
        for axis in Axis::ALL {
            for address in self.addresses() {
                let range = self.range(axis, address);
                if range.is_empty() {
                    continue;
                }
                for (byte, end) in [range.lo(), range.hi()].into_iter().enumerate() {
                    let voxel = axis.voxel(address, end);
                    if let Some(missing) = self.missing(voxel) {
                        let fault = Fault::Loose { axis, voxel, missing };
                        return Err((HEADER + self.offset(axis, address) + byte, fault));
                    }
                }
            }
        }
        Ok(())
    }

    /// The first axis whose column does not hold a voxel.
    fn missing(&self, voxel: [usize; 3]) -> Option<Axis> {
        let holds =
            |axis: Axis| self.range(axis, axis.address(voxel)).contains(voxel[axis as usize]);
        Axis::ALL.into_iter().find(|&axis| !holds(axis))
    }
}
