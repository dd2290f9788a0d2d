//! The editable volume: range maps and bit rows kept in step, every changed column journalled.

use crate::maps::{Axis, Column, Maps};
use crate::plane::Plane;
use crate::row::Bits;
use crate::size::{Grid, Size};

/// Who hears of each change that an edit makes.
pub trait Journal<const N: usize>
where
    Grid<N>: Size,
{
    /// Those `places` of a line of columns are about to be replaced; `old` is what the line holds.
    fn columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old: &[Column; N],
    );
    /// Voxels of row (y, z) are about to be occupied that were not when the edit began.
    fn added(&mut self, row: (usize, usize), voxels: <Grid<N> as Size>::Row);
}

/// Nobody.
impl<const N: usize> Journal<N> for ()
where
    Grid<N>: Size,
{
    fn columns(&mut self, _: Axis, _: usize, _: <Grid<N> as Size>::Row, _: &[Column; N]) {}
    fn added(&mut self, _: (usize, usize), _: <Grid<N> as Size>::Row) {}
}

/// N^3 voxels: three tight range maps, the bit rows of their intersection, and a running digest.
#[derive(Debug)]
pub struct Volume<const N: usize>
where
    Grid<N>: Size,
{
    maps: Maps<N>,
    rows: Plane<N>,
    digest: u64,
}

impl<const N: usize> Volume<N>
where
    Grid<N>: Size,
{
    /// The empty volume. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the volume about by value
    pub const fn new() -> Self {
        Volume { maps: Maps::new(), rows: Plane::new(), digest: 0 }
    }

    /// Becomes the volume of these maps, which must be tight.
    pub fn set_maps(&mut self, maps: &Maps<N>) {
        self.maps.copy_from(maps);
        self.restore();
    }

    /// Becomes the closure of the voxels set by `fill` in an empty plane.
    pub fn set_voxels(&mut self, fill: impl FnOnce(&mut Plane<N>)) {
        self.rows.clear();
        fill(&mut self.rows);
        self.rows.hulls(&mut self.maps);
        self.restore();
    }

    /// Rebuilds rows and digest from the maps, after they were replaced as a whole.
    pub fn restore(&mut self) {
        self.rows.expand(&self.maps);
        self.digest = maps_digest(&self.maps);
    }

    /// Rebuilds the bit rows from the maps, after single columns were replaced.
    pub fn restore_rows(&mut self) {
        self.rows.expand(&self.maps);
    }

    /// The range maps.
    #[must_use]
    pub const fn maps(&self) -> &Maps<N> {
        &self.maps
    }

    /// The bit rows.
    #[must_use]
    pub const fn rows(&self) -> &Plane<N> {
        &self.rows
    }

    /// The bit rows, to be changed by an edit that then makes the maps follow.
    pub(crate) fn rows_mut(&mut self) -> &mut Plane<N> {
        &mut self.rows
    }

    /// The sum of [`column_digest`] over all columns.
    #[must_use]
    pub const fn digest(&self) -> u64 {
        self.digest
    }

    /// Replaces those `places` of a line, which all change, by those of `new`, and journals them.
    #[inline]
    pub(crate) fn set_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        new: &[Column; N],
        journal: &mut impl Journal<N>,
    ) {
        if places.is_empty() {
            return;
        }
        let old = self.maps.line_mut(axis, line);
        journal.columns(axis, line, places, old);
        let mut sum = 0u64;
        for run in places.runs() {
            let run = run.lo()..=run.hi();
            let (old, new) = (&mut old[run.clone()], &new[run.clone()]);
            for ((old, new), key) in old.iter_mut().zip(new).zip(&KEYS[run]) {
                let change = column_number(*new).wrapping_sub(column_number(*old));
                sum = sum.wrapping_add(key.wrapping_mul(change));
                *old = *new;
            }
        }
        self.digest = self.digest.wrapping_add(sum.wrapping_mul(line_key(axis, line)));
    }

    /// Replaces one column without a word; the old one comes back.
    #[inline]
    pub(crate) fn swap_column(&mut self, axis: Axis, at: (usize, usize), column: Column) -> Column {
        let old = self.maps.column(axis, at);
        self.digest = self
            .digest
            .wrapping_sub(column_digest(axis, at, old))
            .wrapping_add(column_digest(axis, at, column));
        self.maps.set_column(axis, at, column);
        old
    }

    /// Whether every range is tight: both its ends are occupied. Always so after an edit; to be
    /// asked of maps that come from outside.
    #[must_use]
    pub fn is_tight(&self) -> bool {
        Axis::ALL.into_iter().all(|axis| {
            (0..N).all(|line| {
                self.maps.line(axis, line).iter().enumerate().all(|(place, column)| {
                    column.0.iter().filter(|range| !range.is_empty()).all(|range| {
                        let end = |i| self.rows.contains(axis.voxel((line, place), i));
                        end(range.lo()) && end(range.hi())
                    })
                })
            })
        })
    }

    /// Occupied voxels.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.rows.count()
    }

    /// Whether the ground layer y = 0 holds a voxel.
    #[must_use]
    pub fn touches_ground(&self) -> bool {
        self.rows.layer(0).iter().any(|row| !row.is_empty())
    }
}

/// The digest of a column at its place: its bytes as a number, times the keys of place and line. 0
/// for an empty one, so that all zero bytes digest to 0. Linear, so that the line's key is taken
/// once for all changes in a line.
#[must_use]
#[inline]
pub fn column_digest(axis: Axis, (line, place): (usize, usize), column: Column) -> u64 {
    column_key(axis, (line, place)).wrapping_mul(column_number(column))
}

/// What [`column_digest`] multiplies a column's bytes with.
#[inline]
pub(crate) fn column_key(axis: Axis, (line, place): (usize, usize)) -> u64 {
    KEYS[place].wrapping_mul(line_key(axis, line))
}

/// The part of a column's key that its line gives.
#[inline]
pub(crate) fn line_key(axis: Axis, line: usize) -> u64 {
    mix(u64::from_le_bytes([0, line as u8, axis as u8, 1, 0, 0, 0, 0])) | 1
}

/// Odd numbers that look random.
pub(crate) const KEYS: [u64; 257] = {
    let mut keys = [0; 257];
    let mut i = 0;
    while i < keys.len() {
        keys[i] = mix(i as u64 + 1) | 1;
        i += 1;
    }
    keys
};

/// A column's bytes as a number.
#[inline]
pub(crate) fn column_number(column: Column) -> u64 {
    u16::from_le_bytes(column.0[0].to_bytes()).into()
}

/// The sum of [`column_digest`] over all columns of the maps, from scratch.
#[must_use]
pub fn maps_digest<const N: usize>(maps: &Maps<N>) -> u64 {
    let mut sum = 0u64;
    for axis in Axis::ALL {
        for line in 0..N {
            let keyed = maps.line(axis, line).iter().zip(&KEYS);
            let of_line = keyed.fold(0u64, |sum, (column, key)| {
                sum.wrapping_add(key.wrapping_mul(column_number(*column)))
            });
            sum = sum.wrapping_add(of_line.wrapping_mul(line_key(axis, line)));
        }
    }
    sum
}

/// Scrambles 64 bits (the finaliser of MurmurHash3, Appleby 2011).
#[must_use]
#[inline]
pub const fn mix(mut h: u64) -> u64 {
    h ^= h >> 33;
    h = h.wrapping_mul(0xff51_afd7_ed55_8ccd);
    h ^= h >> 33;
    h = h.wrapping_mul(0xc4ce_b9fe_1a85_ec53);
    h ^ h >> 33
}
