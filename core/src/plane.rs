//! Bit rows of a whole grid: one N-bit row along x for each (y, z).

use core::mem;

use crate::maps::{Axis, Column, Maps, Range};
use crate::row::{Bits, Row};
use crate::size::{Grid, Size};

/// N x N bit rows, addressed `(y, z)`: the word-parallel twin of the maps. 256 KiB at 128.
#[derive(Clone, PartialEq, Eq, Debug)]
#[repr(C)]
pub struct Plane<const N: usize>
where
    Grid<N>: Size,
{
    rows: [[<Grid<N> as Size>::Row; N]; N],
}

impl<const N: usize> Plane<N>
where
    Grid<N>: Size,
{
    /// No voxel. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the plane about by value
    pub const fn new() -> Self {
        Plane { rows: [[<Grid<N> as Size>::Row::EMPTY; N]; N] }
    }

    /// Removes every voxel, in place.
    pub fn clear(&mut self) {
        self.rows.as_flattened_mut().fill(<Grid<N> as Size>::Row::EMPTY);
    }

    /// Becomes a copy of `other`, in place.
    pub fn copy_from(&mut self, other: &Self) {
        self.rows.copy_from_slice(&other.rows);
    }

    /// The row at (y, z).
    #[must_use]
    #[inline]
    pub fn row(&self, y: usize, z: usize) -> <Grid<N> as Size>::Row {
        self.rows[y][z]
    }

    /// The row at (y, z), to be changed.
    #[inline]
    pub fn row_mut(&mut self, y: usize, z: usize) -> &mut <Grid<N> as Size>::Row {
        &mut self.rows[y][z]
    }

    /// Words `first..first + WORDS` of all rows.
    #[must_use]
    #[inline]
    pub const fn strip<const WORDS: usize>(&self, first: usize) -> Strip<'_, N, WORDS> {
        Strip { plane: self, first }
    }

    /// The N rows of layer y, by z.
    #[must_use]
    #[inline]
    pub fn layer(&self, y: usize) -> &[<Grid<N> as Size>::Row; N] {
        &self.rows[y]
    }

    /// The N rows of layer y, by z, to be changed.
    #[inline]
    pub fn layer_mut(&mut self, y: usize) -> &mut [<Grid<N> as Size>::Row; N] {
        &mut self.rows[y]
    }

    /// Whether a voxel is set.
    #[must_use]
    #[inline]
    pub fn contains(&self, [x, y, z]: [usize; 3]) -> bool {
        self.rows[y][z].contains(x)
    }

    /// Number of voxels set.
    #[must_use]
    pub fn count(&self) -> u64 {
        self.rows.as_flattened().iter().map(|row| u64::from(row.count())).sum()
    }

    /// Becomes the intersection of the three range maps.
    ///
    /// Each range of the Y and Z maps toggles its column's bit where it starts and just past its
    /// end; running exclusive-ors along the column turn the toggles into occupancy, all columns of a
    /// line at a time.
    pub fn expand(&mut self, maps: &Maps<N>) {
        let mut ends = [<Grid<N> as Size>::Row::EMPTY; 257];
        for (y, layer) in self.rows.iter_mut().enumerate() {
            cross_sections::<N>(maps.line(Axis::Z, y), &mut ends, |z, section| layer[z] = section);
        }
        for z in 0..N {
            cross_sections::<N>(maps.line(Axis::Y, z), &mut ends, |y, section| {
                self.rows[y][z] &= section;
            });
        }
        for (y, layer) in self.rows.iter_mut().enumerate() {
            for (row, column) in layer.iter_mut().zip(maps.line(Axis::X, y)) {
                *row &= column.row();
            }
        }
    }

    /// Writes the tight hulls of these voxels: the maps of their closure. The plane itself is not
    /// closed by this; [`Plane::expand`] of the maps is the closure.
    pub fn hulls(&self, maps: &mut Maps<N>) {
        for y in 0..N {
            for z in 0..N {
                maps.set_column(Axis::X, (y, z), Column([Range::hull(self.rows[y][z])]));
            }
            Self::write_line(maps, Axis::Z, y, |z| self.rows[y][z]);
        }
        for z in 0..N {
            Self::write_line(maps, Axis::Y, z, |y| self.rows[y][z]);
        }
    }

    /// Writes a line of N columns, given their voxels row by row along them.
    fn write_line(
        maps: &mut Maps<N>,
        axis: Axis,
        line: usize,
        row: impl Fn(usize) -> <Grid<N> as Size>::Row,
    ) {
        let mut first = [0u8; N];
        let mut seen = <Grid<N> as Size>::Row::EMPTY;
        for i in 0..N {
            for x in (row(i) & !seen).ones() {
                first[x] = i as u8;
            }
            seen |= row(i);
        }
        for x in (Grid::<N>::FULL & !seen).ones() {
            maps.set_column(axis, (line, x), Column::EMPTY);
        }
        for i in (0..N).rev() {
            for x in (row(i) & seen).ones() {
                maps.set_column(axis, (line, x), Column([Range::new(first[x].into(), i)]));
            }
            seen &= !row(i);
        }
    }
}

/// The same few words of every row of a plane: what is small works on no more.
#[derive(Clone, Copy, Debug)]
pub struct Strip<'a, const N: usize, const WORDS: usize>
where
    Grid<N>: Size,
{
    plane: &'a Plane<N>,
    first: usize,
}

impl<const N: usize, const WORDS: usize> Strip<'_, N, WORDS>
where
    Grid<N>: Size,
{
    /// Its words of the row at (y, z).
    #[must_use]
    #[inline]
    pub fn row(&self, y: usize, z: usize) -> Row<WORDS> {
        self.plane.rows[y][z].part(self.first)
    }
}

/// Tells at each place along a line's columns which of them hold it. `ends` is empty before and
/// after.
#[inline]
fn cross_sections<const N: usize>(
    line: &[Column; N],
    ends: &mut [<Grid<N> as Size>::Row; 257],
    mut tell: impl FnMut(usize, <Grid<N> as Size>::Row),
) where
    Grid<N>: Size,
{
    for (word, columns) in line.chunks(64).enumerate() {
        if columns.iter().all(|column| *column == Column::EMPTY) {
            continue;
        }
        for (i, column) in columns.iter().enumerate() {
            for range in column.0 {
                let end = range.hi() + 1;
                // An empty range begins at 255, behind its end: toggled twice there, it is none.
                for place in [range.lo().min(end), end] {
                    ends[place].set_word(word, ends[place].word(word) ^ 1 << i);
                }
            }
        }
    }
    let mut section = <Grid<N> as Size>::Row::EMPTY;
    for (at, ends) in ends[..N].iter_mut().enumerate() {
        section ^= mem::replace(ends, Bits::EMPTY);
        tell(at, section);
    }
    ends[N] = Bits::EMPTY;
}
