//! An occupancy bitmap of the whole grid: one N-bit row along x for each (y, z).

use core::mem;

use crate::volume::line_scan;
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column, RangeMaps};
use crate::volume::row::{BitRow, BitSet};
use crate::volume::size::{Grid, Size};

/// N^3 voxels, one bit each, as N x N bit rows addressed by (y, z). The word-parallel counterpart of the
/// range maps. 256 KiB at 128.
#[derive(Clone, PartialEq, Eq, Debug)]
#[repr(C)]
pub struct BitGrid<const N: usize>
where
    Grid<N>: Size,
{
    rows: [[<Grid<N> as Size>::Row; N]; N],
}

impl<const N: usize> BitGrid<N>
where
    Grid<N>: Size,
{
    /// Creates an empty grid. For a `static`, as [`World::new`](crate::World::new).
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would be moved by value
    pub const fn new() -> Self {
        BitGrid { rows: [[<Grid<N> as Size>::Row::EMPTY; N]; N] }
    }

    /// Removes every voxel.
    pub fn clear(&mut self) {
        // Not `fill`: most rows are already empty and aren't written.
        for row in self.rows.as_flattened_mut() {
            if !row.is_empty() {
                *row = <Grid<N> as Size>::Row::EMPTY;
            }
        }
    }

    /// Copies `other` into `self`.
    pub fn copy_from(&mut self, other: &Self) {
        self.rows.copy_from_slice(&other.rows);
    }

    /// Returns the row at (y, z).
    #[must_use]
    #[inline]
    pub fn row(&self, y: usize, z: usize) -> <Grid<N> as Size>::Row {
        self.rows[y][z]
    }

    /// Returns the row at (y, z) for changes.
    #[inline]
    pub fn row_mut(&mut self, y: usize, z: usize) -> &mut <Grid<N> as Size>::Row {
        &mut self.rows[y][z]
    }

    /// Returns words `first_word..first_word + WORDS` of every row.
    #[must_use]
    #[inline]
    pub(crate) const fn row_strip<const WORDS: usize>(
        &self,
        first_word: usize,
    ) -> RowStrip<'_, N, WORDS> {
        RowStrip { grid: self, first_word }
    }

    /// Returns the N rows of layer y, by z.
    #[must_use]
    #[inline]
    pub fn layer(&self, y: usize) -> &[<Grid<N> as Size>::Row; N] {
        &self.rows[y]
    }

    /// Returns the N rows of layer y, by z, for changes.
    #[inline]
    pub fn layer_mut(&mut self, y: usize) -> &mut [<Grid<N> as Size>::Row; N] {
        &mut self.rows[y]
    }

    /// Returns `true` if a voxel is set.
    #[must_use]
    #[inline]
    pub fn contains(&self, [x, y, z]: [usize; 3]) -> bool {
        self.rows[y][z].contains(x)
    }

    /// Returns the number of voxels set.
    #[must_use]
    #[inline(never)]
    pub fn count_voxels(&self) -> u64 {
        self.rows.as_flattened().iter().map(|row| u64::from(row.count_ones())).sum()
    }

    /// Sets the grid to the intersection of the three range maps.
    #[inline(never)]
    pub fn set_from_maps<const K: usize>(&mut self, maps: &RangeMaps<N, K>) {
        self.set_rows_from_maps(maps, [Range::new(0, N - 1); 2]);
    }

    /// Sets the rows whose y and z lie in these ranges to the intersection of the three range maps.
    ///
    /// A scan conversion by parity: each range of the Y and Z maps toggles its column's bit at its
    /// first voxel and just past its last; a prefix exclusive-or along the columns turns the toggles
    /// into occupancy, all columns of a line at a time.
    pub(crate) fn set_rows_from_maps<const K: usize>(
        &mut self,
        maps: &RangeMaps<N, K>,
        [of_y, of_z]: [Range; 2],
    ) {
        if of_y.is_empty() || of_z.is_empty() {
            return;
        }
        let (of_y, of_z) = (of_y.first()..of_y.last() + 1, of_z.first()..of_z.last() + 1);
        let mut toggles = [<Grid<N> as Size>::Row::EMPTY; 257];
        for y in of_y.clone() {
            let rows = self.rows[y][of_z.clone()].iter_mut();
            let of_line = maps.line(Axis::Z, y);
            visit_cross_sections(of_line, &mut toggles, of_z.start, rows, |row, places| {
                *row = places;
            });
        }
        for z in of_z.clone() {
            let rows = self.rows[of_y.clone()].iter_mut().map(|layer| &mut layer[z]);
            let of_line = maps.line(Axis::Y, z);
            visit_cross_sections(of_line, &mut toggles, of_y.start, rows, |row, places| {
                *row &= places;
            });
        }
        for y in of_y {
            let rows = self.rows[y][of_z.clone()].iter_mut();
            for (row, column) in rows.zip(&maps.line(Axis::X, y)[of_z.clone()]) {
                let mut voxels = BitSet::EMPTY;
                for range in column.intervals() {
                    voxels |= BitSet::from_range(range);
                }
                *row &= voxels;
            }
        }
    }

    /// Writes the range maps of these voxels' closure, for columns that had no gaps before: their tight hulls
    /// without the longest K - 1 empty runs in each. The grid itself is unchanged; [`BitGrid::set_from_maps`]
    /// of the maps gives the closure.
    #[inline(never)]
    pub fn write_closure<const K: usize>(&self, maps: &mut RangeMaps<N, K>) {
        if K > 1 {
            maps.clear();
        }
        self.write_closure_holding_gaps(maps);
    }

    /// Writes the closure, for columns that had the gaps of `maps`, which must hold all these voxels.
    pub(crate) fn write_closure_holding_gaps<const K: usize>(&self, maps: &mut RangeMaps<N, K>) {
        for y in 0..N {
            for (row, column) in self.rows[y].iter().zip(maps.line_mut(Axis::X, y)) {
                *column = Column::closed_over(*row, column);
            }
            Self::close_line(maps, Axis::Z, y, |z| self.rows[y][z]);
        }
        for z in 0..N {
            Self::close_line(maps, Axis::Y, z, |y| self.rows[y][z]);
        }
    }

    /// Closes a line of N columns along `axis`. `row_at(i)` holds voxel `i` of each of these columns.
    fn close_line<const K: usize>(
        maps: &mut RangeMaps<N, K>,
        axis: Axis,
        line: usize,
        row_at: impl Fn(usize) -> <Grid<N> as Size>::Row,
    ) {
        if K == 1 {
            Self::write_hull_line(maps, axis, line, row_at);
        } else {
            line_scan::close_line(maps.line_mut(axis, line), (0..N).map(row_at));
        }
    }

    /// Writes the tight hulls of these voxels: columns of one interval. The grid itself is unchanged.
    #[inline(never)]
    pub fn write_hulls<const K: usize>(&self, maps: &mut RangeMaps<N, K>) {
        for y in 0..N {
            for z in 0..N {
                maps.set_column(
                    Axis::X,
                    (y, z),
                    Column::from_range(Range::hull_of(self.rows[y][z])),
                );
            }
            Self::write_hull_line(maps, Axis::Z, y, |z| self.rows[y][z]);
        }
        for z in 0..N {
            Self::write_hull_line(maps, Axis::Y, z, |y| self.rows[y][z]);
        }
    }

    /// Writes the hulls of a line of N columns along `axis`. `row_at(i)` holds voxel `i` of each of these
    /// columns.
    fn write_hull_line<const K: usize>(
        maps: &mut RangeMaps<N, K>,
        axis: Axis,
        line: usize,
        row_at: impl Fn(usize) -> <Grid<N> as Size>::Row,
    ) {
        let mut first = [0u8; N];
        let mut seen = <Grid<N> as Size>::Row::EMPTY;
        for i in 0..N {
            let row = row_at(i);
            for x in (row & !seen).iter_ones() {
                first[x] = i as u8;
            }
            seen |= row;
        }
        for x in (Grid::<N>::FULL & !seen).iter_ones() {
            maps.set_column(axis, (line, x), Column::EMPTY);
        }
        for i in (0..N).rev() {
            for x in (row_at(i) & seen).iter_ones() {
                maps.set_column(
                    axis,
                    (line, x),
                    Column::from_range(Range::new(first[x].into(), i)),
                );
            }
            seen &= !row_at(i);
        }
    }
}

/// A strip of a few words of every row of a grid: small edits read only these.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowStrip<'a, const N: usize, const WORDS: usize>
where
    Grid<N>: Size,
{
    grid: &'a BitGrid<N>,
    first_word: usize,
}

impl<const N: usize, const WORDS: usize> RowStrip<'_, N, WORDS>
where
    Grid<N>: Size,
{
    /// Returns the strip's words of the row at (y, z).
    #[must_use]
    #[inline]
    pub(crate) fn row(&self, y: usize, z: usize) -> BitRow<WORDS> {
        self.grid.rows[y][z].word_span(self.first_word)
    }
}

/// Visits rows together with the cross section of a line's columns at each row's position. The first row is
/// at position `first`. `toggles` is scratch, empty before and after.
#[inline]
fn visit_cross_sections<'a, const N: usize, const K: usize>(
    line: &[Column<K>; N],
    toggles: &mut [<Grid<N> as Size>::Row; 257],
    first: usize,
    rows: impl ExactSizeIterator<Item = &'a mut <Grid<N> as Size>::Row>,
    mut visit: impl FnMut(&mut <Grid<N> as Size>::Row, <Grid<N> as Size>::Row),
) where
    Grid<N>: Size,
    <Grid<N> as Size>::Row: 'a,
{
    for word in 0..<Grid<N> as Size>::Row::WORDS {
        let columns = &line[64 * word..(64 * word + 64).min(N)];
        if columns.iter().all(|column| *column == Column::EMPTY) {
            continue;
        }
        for (i, column) in columns.iter().enumerate() {
            let mut toggle_ends = |range: Range| {
                let end = range.last() + 1;
                // An empty range begins at 255, behind its end: both toggles fall on the same place and
                // cancel.
                for position in [range.first().min(end), end] {
                    let toggled = toggles[position].word(word) ^ 1 << i;
                    toggles[position].set_word(word, toggled);
                }
            };
            toggle_ends(column.range(0));
            if column.has_gaps() {
                (1..K).for_each(|k| toggle_ends(column.range(k)));
            }
        }
    }
    let mut places = <Grid<N> as Size>::Row::EMPTY;
    for toggled in &mut toggles[..first] {
        places ^= mem::replace(toggled, BitSet::EMPTY);
    }
    let end = first + rows.len();
    for (row, toggled) in rows.zip(&mut toggles[first..]) {
        places ^= mem::replace(toggled, BitSet::EMPTY);
        visit(row, places);
    }
    toggles[end..=N].fill(BitSet::EMPTY);
}
