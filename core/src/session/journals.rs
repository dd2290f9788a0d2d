//! Journals of a tick's changes: for undo, for the renderer and for a running island pass.

use crate::edit::islands::IslandSearch;
use crate::edit::undo::UndoHistory;
use crate::volume::dirty::DirtyRects;
use crate::volume::journal::Journal;
use crate::volume::range_maps::{Axis, Column, RowAddress};
use crate::volume::size::{Grid, Size};

/// Journal of an island removal: records its columns for undo and for the renderer.
#[derive(Debug)]
pub struct RemovalJournal<'a, const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The history; the removal joins its newest entry.
    pub undo: &'a mut UndoHistory<N, K>,
    /// The rectangles that cover the changed columns.
    pub dirty: &'a mut DirtyRects,
}

/// Journal of a stroke's edit: records its columns for undo and for the renderer, and the added voxels for a
/// running island pass.
#[derive(Debug)]
pub struct StrokeJournal<'a, const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The history that records the stroke.
    pub undo: &'a mut UndoHistory<N, K>,
    /// The rectangles that cover the changed columns.
    pub dirty: &'a mut DirtyRects,
    /// The search that treats added voxels as supported.
    pub islands: &'a mut IslandSearch<N>,
}

impl<const N: usize, const K: usize> Journal<N, K> for RemovalJournal<'_, N, K>
where
    Grid<N>: Size,
{
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        (old, _): (&[Column<K>; N], &[Column<K>; N]),
    ) {
        self.undo.record_into_newest_entry(axis, line, places, old);
        self.dirty.mark_columns(axis, line, places);
    }

    fn record_added(&mut self, _: RowAddress, _: <Grid<N> as Size>::Row) {}
}

impl<const N: usize, const K: usize> Journal<N, K> for StrokeJournal<'_, N, K>
where
    Grid<N>: Size,
{
    fn record_columns(
        &mut self,
        axis: Axis,
        line: usize,
        places: <Grid<N> as Size>::Row,
        (old, _): (&[Column<K>; N], &[Column<K>; N]),
    ) {
        self.undo.record_columns(axis, line, places, old);
        self.dirty.mark_columns(axis, line, places);
    }

    fn record_added(&mut self, row: RowAddress, voxels: <Grid<N> as Size>::Row) {
        self.islands.mark_added_as_reached(row, voxels);
    }
}
