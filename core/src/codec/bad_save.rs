//! The error of loading a saved world.

use core::fmt;

use crate::codec::bytes::BadBytes;
use crate::volume::range_maps::{Axis, ColumnAddress};

/// The offset of a save's version, which says the intervals of a column.
const VERSION_OFFSET: usize = 4;

/// What is expected where the bytes of a column are none.
pub(crate) const INTERVALS_OF_A_COLUMN: &str = "disjoint ranges within the grid, the lowest first";

/// Why bytes are no saved world of this size and number of intervals.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum BadSave {
    /// The bytes end within a value, or it is invalid.
    Value(BadBytes),
    /// The world that was saved has another number of intervals a column.
    Intervals {
        /// Of the saved world.
        saved: usize,
        /// Of this one.
        here: usize,
    },
    /// A column of the volume, of the mask or of an undo entry is invalid.
    Column {
        /// Where it lies, and what is expected.
        bad: BadBytes,
        /// Its axis.
        axis: Axis,
        /// Its line and place in its map.
        address: ColumnAddress,
    },
    /// An undo entry leads to a volume with an invalid column, once it is undone or redone.
    Entry {
        /// Its number, from 0, the oldest.
        entry: usize,
        /// Where it begins, and what is expected of the volume.
        bad: BadBytes,
        /// The column's axis.
        axis: Axis,
        /// The column's line and place in its map.
        address: ColumnAddress,
    },
}

impl BadSave {
    /// The offset of what is wrong from the start of the bytes.
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
