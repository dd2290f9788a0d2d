//! The observer interface of an edit: it sees each column before it changes.

use crate::volume::range_maps::{Axis, Column, ColumnAddress, RowAddress};
use crate::volume::size::{Grid, Size};

/// An observer of each change that an edit makes, before it is made.
pub trait Journal<const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The columns at `places` of a line are about to be replaced: the line as it is, and as it becomes.
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        old_and_new: (&[Column<K>; N], &[Column<K>; N]),
    );
    /// `voxels` of row (y, z) are about to be occupied that were empty when the edit began.
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

/// An observer of the columns that an undo or a redo swaps, before they are.
pub trait SwapJournal<const K: usize = 1> {
    /// A run of columns from `first` on is about to become `new`; some may not differ.
    fn record_swap(
        &mut self,
        axis: Axis,
        first: ColumnAddress,
        old: &[Column<K>],
        new: &[Column<K>],
    );
    /// All were recorded.
    fn end_swaps(&mut self);
}
