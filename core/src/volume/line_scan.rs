//! Scans along all columns of a line at once: finds columns with holes, and applies the closure rule.

use crate::volume::closure::ChosenGaps;
use crate::volume::range::Range;
use crate::volume::range_maps::Column;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

/// A search along the columns of a line for columns with an empty voxel between occupied ones.
#[derive(Clone, Copy, Debug)]
pub struct HoleScan<R> {
    /// The columns in which such a hole was found so far.
    pub found: R,
    /// The columns in which an occupied voxel was found so far.
    entered: R,
    /// The previous voxel of each column.
    row: R,
}

impl<R: BitSet> HoleScan<R> {
    /// A scan before its first voxel.
    pub const NONE: Self = HoleScan { found: R::EMPTY, entered: R::EMPTY, row: R::EMPTY };

    /// Advances to the next voxel of each column.
    #[inline(always)]
    pub fn pass(&mut self, row: R) {
        self.found |= row & self.entered & !self.row;
        self.entered |= row;
        self.row = row;
    }
}

/// Replaces the columns of a line by the columns of the exact voxels `rows`, by the closure rule. Each row
/// has one voxel of every column; the rows are in order along the columns.
pub(crate) fn close_line<const N: usize, const K: usize>(
    line: &mut [Column<K>; N],
    rows: impl Iterator<Item = <Grid<N> as Size>::Row>,
) where
    Grid<N>: Size,
{
    let scanned = scan_columns::<N, K, _>(line, 0, rows);
    for (column, scanned) in line.iter_mut().zip(scanned) {
        *column = scanned.gaps.into_column(scanned.hull);
    }
}

/// Sets the columns `among` of the line `after` to the columns of their exact voxels, by the closure rule.
/// `row(i)` has voxel `i` of each column; all voxels are at the positions `span`. `before` is the line before
/// the edit.
pub(crate) fn close_columns<const N: usize, const K: usize, R: BitSet>(
    before: &[Column<K>],
    after: &mut [Column<K>],
    among: R,
    span: Range,
    row: impl Fn(usize) -> R,
) where
    Grid<N>: Size,
{
    let rows = (span.first()..span.last() + 1).map(|i| row(i) & among);
    let scanned = scan_columns::<N, K, R>(before, span.first(), rows);
    for place in among.iter_ones() {
        after[place] = scanned[place].gaps.into_column(scanned[place].hull);
    }
}

/// Scans a line along `rows`, the first of which is at the position `first`. `before` is the line before the
/// edit.
#[inline]
fn scan_columns<const N: usize, const K: usize, R: BitSet>(
    before: &[Column<K>],
    first: usize,
    rows: impl Iterator<Item = R>,
) -> [ScannedColumn<K>; N]
where
    Grid<N>: Size,
{
    let mut scanned = [ScannedColumn::NONE; N];
    let (mut below, mut end) = (R::EMPTY, first);
    for (i, row) in (first..).zip(rows) {
        end = i + 1;
        let changed = row ^ below;
        if changed.is_empty() {
            continue;
        }
        for place in changed.iter_ones() {
            if row.contains(place) {
                scanned[place].begin_run(i, &before[place]);
            } else {
                scanned[place].end_run(i - 1);
            }
        }
        below = row;
    }
    below.iter_ones().for_each(|place| scanned[place].end_run(end - 1));
    scanned
}

/// The state of a column during a scan.
#[derive(Clone, Copy)]
struct ScannedColumn<const K: usize> {
    /// The range from the first voxel to the last of the runs that have ended.
    hull: Range,
    gaps: ChosenGaps<K>,
}

impl<const K: usize> ScannedColumn<K> {
    const NONE: Self = ScannedColumn { hull: Range::EMPTY, gaps: ChosenGaps::NONE };

    /// Begins a run of voxels at `first`. `before` is the column before the edit.
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
