//! Errors of reading `.rmap` files: the byte offset, what was found and what was expected.

use std::fmt;
use std::io;
use std::path::PathBuf;

use paros_core::limits::MAX_INTERVALS;
use paros_core::volume::{Axis, Range};

use crate::sizes::GRID_SIDE_NAMES;

use super::{SIZES, VERSION_OF_MORE, VERSION_OF_ONE};

/// The reason why a file was not read.
#[derive(Debug, thiserror::Error)]
pub enum RmapError {
    /// The system could not read the file.
    #[error("{}: cannot read: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The file's bytes are wrong.
    #[error("{}: at byte {offset}: {fault}", path.display())]
    Bad {
        /// The file.
        path: PathBuf,
        /// The offset in the file.
        offset: usize,
        /// The fault.
        fault: RmapFault,
    },
}

/// A fault of a file's bytes, and its offset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RmapFaultAt {
    /// The offset of the byte from the file's start.
    pub offset: usize,
    /// The fault.
    pub fault: RmapFault,
}

/// A fault of a file's bytes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum RmapFault {
    /// The magic number is not that of an `.rmap`.
    Magic([u8; 4]),
    /// A version that this program does not read.
    Version(u16),
    /// A size that no volume has.
    Size(u16),
    /// A number of intervals per column that its version doesn't allow.
    Layers {
        /// The version.
        version: u16,
        /// The number.
        found: u8,
    },
    /// A flag or filler that is not zero.
    Flags(u8),
    /// A valid size, but not the expected one.
    OtherSize {
        /// The file's N.
        found: usize,
        /// The expected N.
        expected: usize,
    },
    /// A size that the shells' sculptures can't have.
    UnusableSize(usize),
    /// More intervals per column than expected.
    OtherIntervals {
        /// The intervals of the file.
        found: usize,
        /// The intervals of the maps to be filled.
        expected: usize,
    },
    /// The file ends before its columns and checksum do.
    Truncated {
        /// The expected length in bytes.
        expected: usize,
    },
    /// Bytes follow the checksum.
    Trailing,
    /// The checksum is not that of the bytes before it.
    Checksum {
        /// The stored checksum.
        found: u32,
        /// The computed checksum.
        expected: u32,
    },
    /// Two bytes that are no range of a column of this grid.
    Range {
        /// The column's axis.
        axis: Axis,
        /// The column's line and place in its map.
        address: (usize, usize),
        /// The bytes.
        bytes: [u8; 2],
    },
    /// A range that overlaps the one before it, touches it, lies below it, or follows an empty one.
    Order {
        /// The column's axis.
        axis: Axis,
        /// The column's line and place in its map.
        address: (usize, usize),
        /// The range before it.
        below: Range,
        /// The range.
        found: Range,
    },
    /// A range that is not tight: another map leaves its end empty.
    Loose {
        /// The range's axis.
        axis: Axis,
        /// The end voxel.
        voxel: [usize; 3],
        /// The axis whose column does not hold that voxel.
        missing: Axis,
    },
    /// A column with room for another gap has an empty voxel inside a range.
    Unsaturated {
        /// The column's axis.
        axis: Axis,
        /// The lowest such voxel.
        voxel: [usize; 3],
    },
}

impl fmt::Display for RmapFaultAt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "at byte {}: {}", self.offset, self.fault)
    }
}

impl fmt::Display for RmapFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            RmapFault::Magic(found) => write!(
                f,
                "expected the magic \"RMAP\", found \"{}\": not a range map file",
                found.escape_ascii()
            ),
            RmapFault::Version(found) => {
                write!(f, "expected version {VERSION_OF_ONE} or {VERSION_OF_MORE}, found {found}")
            }
            RmapFault::Size(found) => {
                write!(f, "expected a size N out of {SIZES:?}, found {found}")
            }
            RmapFault::Layers { version: VERSION_OF_ONE, found } => {
                write!(f, "expected 1 interval a column, found {found}")
            }
            RmapFault::Layers { version, found } => write!(
                f,
                "expected 2 to {MAX_INTERVALS} intervals a column in version {version}, found {found}"
            ),
            RmapFault::UnusableSize(found) => {
                let sizes = GRID_SIDE_NAMES.join(" or ");
                write!(f, "expected a volume of size {sizes}, found {found}")
            }
            RmapFault::OtherIntervals { found, expected: 1 } => {
                write!(f, "expected columns of 1 interval, found columns of {found}")
            }
            RmapFault::OtherIntervals { found, expected } => {
                write!(f, "expected columns of at most {expected} intervals, found {found}")
            }
            RmapFault::Flags(found) => write!(f, "expected a zero byte, found {found:#04x}"),
            RmapFault::OtherSize { found, expected } => {
                write!(f, "expected a volume of size {expected}, found size {found}")
            }
            RmapFault::Truncated { expected } => {
                write!(f, "the file ends here, expected {expected} bytes: truncated")
            }
            RmapFault::Trailing => write!(f, "expected the end of the file, found more bytes"),
            RmapFault::Checksum { found, expected } => {
                write!(f, "expected the checksum {expected:08x}, found {found:08x}: damaged")
            }
            RmapFault::Range { axis, address, bytes: [not_lo, hi] } => write!(
                f,
                "expected a range inside the grid, found {}..={hi} ({})",
                !not_lo,
                column_name(axis, address)
            ),
            RmapFault::Order { axis, address, below, found } => write!(
                f,
                "expected {}, found {}..={} ({})",
                expected_after(below),
                found.first(),
                found.last(),
                column_name(axis, address)
            ),
            RmapFault::Loose { axis, voxel, missing } => write!(
                f,
                "expected a tight range, but its end voxel {voxel:?} along {axis:?} is not in its \
                 column along {missing:?} ({})",
                column_name(axis, axis.column_address(voxel))
            ),
            RmapFault::Unsaturated { axis, voxel } => write!(
                f,
                "expected voxel {voxel:?} to be occupied or in a gap, as there is room for one ({})",
                column_name(axis, axis.column_address(voxel))
            ),
        }
    }
}

fn column_name(axis: Axis, (line, place): (usize, usize)) -> String {
    format!("column along {axis:?}, line {line}, place {place}")
}

/// Returns a text that says what may follow a range of a column.
fn expected_after(below: Range) -> String {
    match below.is_empty() {
        true => "no range behind an empty one".into(),
        false => format!("a range behind {}..={} and a gap", below.first(), below.last()),
    }
}
