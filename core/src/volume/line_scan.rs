//! Scans along whole lines of columns, all of them at once: which have holes, and what closure makes of them.

use crate::volume::closure::ChosenGaps;
use crate::volume::range::Range;
use crate::volume::range_maps::Column;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// A search along the columns of a line for those with an empty voxel between occupied ones.
#[derive(Clone, Copy, Debug)]
pub struct HoleScan<R> {
    /// The columns that have one, so far.
    pub found: R,
    /// The columns that have an occupied voxel.
    entered: R,
    /// The voxels before.
    row: R,
}

impl<R: BitSet> HoleScan<R> {
    /// No voxel so far.
    pub const NONE: Self = HoleScan { found: R::EMPTY, entered: R::EMPTY, row: R::EMPTY };

    /// Passes on to the next voxel of each column.
    #[inline(always)]
    pub fn pass(&mut self, row: R) {
        self.found |= row & self.entered & !self.row;
        self.entered |= row;
        self.row = row;
    }
}

/// Replaces the columns of a line by those of the exact voxels `rows`, by the closure rule: each row has one
/// voxel of every column, the rows are in order along the columns.
pub(crate) fn close_line<const N: usize, const K: usize>(
    line: &mut [Column<K>; N],
    rows: impl Iterator<Item = <Grid<N> as Size>::Row>,
) where
    Grid<N>: Size,
{
    let mut scanned = [ScannedColumn::<K>::NONE; N];
    let mut below = <Grid<N> as Size>::Row::EMPTY;
    for (i, row) in rows.enumerate() {
        let changed = row ^ below;
        if changed.is_empty() {
            continue;
        }
        for place in changed.iter_ones() {
            if row.contains(place) {
                scanned[place].begin_run(i, &line[place]);
            } else {
                scanned[place].end_run(i - 1);
            }
        }
        below = row;
    }
    below.iter_ones().for_each(|place| scanned[place].end_run(N - 1));
    for (column, scanned) in line.iter_mut().zip(scanned) {
        *column = scanned.gaps.into_column(scanned.hull);
    }
}

/// What a scan met of a column so far.
#[derive(Clone, Copy)]
struct ScannedColumn<const K: usize> {
    /// From the first voxel to the last of the runs that have ended.
    hull: Range,
    gaps: ChosenGaps<K>,
}

impl<const K: usize> ScannedColumn<K> {
    const NONE: Self = ScannedColumn { hull: Range::EMPTY, gaps: ChosenGaps::NONE };

    /// A run of voxels begins at `first`, in a column that was `before`.
    #[inline]
    fn begin_run(&mut self, first: usize, before: &Column<K>) {
        if self.hull.is_empty() {
            self.hull = Range::new(first, first);
        } else if K > 1 {
            let gap = Range::new(self.hull.last() + 1, first - 1);
            self.gaps.insert(gap, before.has_gap_overlapping(gap));
        }
    }

    #[inline]
    fn end_run(&mut self, last: usize) {
        self.hull = self.hull.with_last(last);
    }
}
