//! The error of loading a saved world.

use core::fmt;

use crate::codec::bytes::BadBytes;
use crate::volume::range_maps::{Axis, ColumnAddress};

/// The offset of a save's version, which includes the number of intervals of a column.
const VERSION_OFFSET: usize = 4;

/// The expectation reported for an invalid column.
pub(crate) const INTERVALS_OF_A_COLUMN: &str = "disjoint ranges within the grid, the lowest first";

/// The reason why bytes aren't a saved world of this size and number of intervals.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BadSave {
    /// The bytes end within a value, or the value is invalid.
    Value(BadBytes),
    /// The saved world has another number of intervals a column.
    Intervals {
        /// The saved world's number.
        saved: usize,
        /// This world's number.
        here: usize,
    },
    /// A column of the volume, of the mask or of an undo entry is invalid.
    Column {
        /// The column's offset, and what was expected.
        bad: BadBytes,
        /// Its axis.
        axis: Axis,
        /// Its line and place in its map.
        address: ColumnAddress,
    },
    /// Undoing or redoing an undo entry leads to a volume with an invalid column.
    Entry {
        /// Its index; 0 is the oldest.
        entry: usize,
        /// The entry's offset, and what was expected of the volume.
        bad: BadBytes,
        /// The column's axis.
        axis: Axis,
        /// The column's line and place in its map.
        address: ColumnAddress,
    },
}

impl BadSave {
    /// Returns the offset of the error from the start of the bytes.
    #[must_use]
    pub const fn offset(&self) -> usize {
        match self {
            BadSave::Value(bad) | BadSave::Column { bad, .. } | BadSave::Entry { bad, .. } => {
                bad.offset
            }
            BadSave::Intervals { .. } => VERSION_OFFSET,
        }
    }
}

impl From<BadBytes> for BadSave {
    fn from(bad: BadBytes) -> Self {
        BadSave::Value(bad)
    }
}

impl fmt::Display for BadSave {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            BadSave::Value(BadBytes { offset, expected }) => {
                write!(f, "expected {expected} at byte {offset}")
            }
            BadSave::Intervals { saved, here } => {
                write!(f, "intervals a column: {saved} as saved, {here} here")
            }
            BadSave::Column { bad: BadBytes { offset, expected }, axis, address } => {
                let (line, place) = address;
                write!(f, "expected {expected} at byte {offset}")?;
                write!(f, " (column along {axis:?}, line {line}, place {place})")
            }
            BadSave::Entry { entry, bad: BadBytes { offset, expected }, axis, address } => {
                let (line, place) = address;
                write!(f, "expected {expected} of the volume that undo entry {entry} leads to")?;
                write!(f, ", at byte {offset}")?;
                write!(f, " (column along {axis:?}, line {line}, place {place})")
            }
        }
    }
}

impl core::error::Error for BadSave {}
