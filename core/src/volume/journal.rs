//! The observer interface of an edit, called before each column changes.

use crate::volume::range_maps::{Axis, Column, ColumnAddress, RowAddress};
use crate::volume::size::{Grid, Size};

/// An observer of each change of an edit, called before the change.
pub trait Journal<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// Records that the columns at `places` of a line are about to be replaced. Takes the old and the new
    /// line.
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old_and_new: (&[Column<K>; N], &[Column<K>; N]),
    );
    /// Records that `voxels` of row (y, z) are about to become occupied that were empty when the edit began.
    fn record_added(&mut self, row: RowAddress, voxels: <Grid<N> as Size>::Row);
}

/// Records nothing.
impl<const N: usize, const K: usize> Journal<N, K> for ()
where
    Grid<N>: Size,
{
    fn record_columns(
        &mut self,
        _: Axis,
        _: usize,
        _: <Grid<N> as Size>::Row,
        _: (&[Column<K>; N], &[Column<K>; N]),
    ) {
    }
    fn record_added(&mut self, _: RowAddress, _: <Grid<N> as Size>::Row) {}
}

/// An observer of the columns that an undo or a redo swaps, called before the swap.
pub trait SwapJournal<const K: usize = 1> {
    /// Records that a run of columns from `first` on is about to become `new`. Some of them may not differ.
    fn record_swap(
        &mut self,
        axis: Axis,
        first: ColumnAddress,
        old: &[Column<K>],
        new: &[Column<K>],
    );
    /// Called after the last column was recorded.
    fn end_swaps(&mut self);
}
