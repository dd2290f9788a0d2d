//! The check of a history of unknown origin: undo and redo must lead only to volumes that edits can produce.

use super::UndoHistory;
use crate::volume::editable::Volume;
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column, ColumnAddress, RangeMaps};
use crate::volume::size::{Grid, Size};
use crate::volume::voxel_box::VoxelBox;

/// An entry that leads to a volume that no edit can produce.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct UnsoundEntry {
    /// Its index, counted from the oldest.
    pub(crate) entry: usize,
    /// The property that the volume should have.
    pub(crate) expected: &'static str,
    /// The column that lacks that property.
    pub(crate) axis: Axis,
    pub(crate) address: ColumnAddress,
}

impl<const N: usize, const K: usize> UndoHistory<N, K>
where
    Grid<N>: Size,
{
    /// Undoes all applied entries and redoes all undone ones, starting each time from the present volume, and
    /// checks the resulting volumes: their maps must be tight and saturated and hold the mask. Restores
    /// volume and history, unless an entry is unsound.
    ///
    /// The cost of an entry is proportional to the box around the voxels that it changes: nothing outside can
    /// have become invalid.
    pub(crate) fn check_entries(
        &mut self,
        volume: &mut Volume<N, K>,
        mask: &RangeMaps<N, K>,
    ) -> Result<(), UnsoundEntry> {
        let (applied, all) = (usize::from(self.applied), self.len());
        for entry in (0..applied).rev() {
            self.check_entry(entry, volume, mask)?;
        }
        (0..applied).for_each(|entry| self.swap_columns(entry, volume, |_, _, _, _| {}));
        volume.rebuild_rows();
        for entry in applied..all {
            self.check_entry(entry, volume, mask)?;
        }
        (applied..all).rev().for_each(|entry| self.swap_columns(entry, volume, |_, _, _, _| {}));
        volume.rebuild_rows();
        Ok(())
    }

    /// Swaps an entry with the volume and checks the volume.
    fn check_entry(
        &mut self,
        entry: usize,
        volume: &mut Volume<N, K>,
        mask: &RangeMaps<N, K>,
    ) -> Result<(), UnsoundEntry> {
        let mut changed = VoxelBox::EMPTY;
        self.swap_columns(entry, volume, |axis, first, ours, theirs| {
            changed = changed.hull_with(box_of_changes::<N, K>(axis, first, ours, theirs));
        });
        volume.rebuild_rows_in(changed);
        let unsound = |(axis, address), expected| UnsoundEntry { entry, expected, axis, address };
        if let Some(column) = volume.first_loose_column_in(changed) {
            return Err(unsound(column, "tight ranges"));
        }
        if let Some(column) = volume.first_unsaturated_column_in(changed) {
            return Err(unsound(column, "a column without empty voxels where a gap has room"));
        }
        match volume.first_row_without_its_part_of(mask, changed) {
            Some(row) => Err(unsound((Axis::X, row), "all of the mask")),
            None => Ok(()),
        }
    }
}

/// Returns the box around the voxels that differ between two values of a run of columns.
pub(super) fn box_of_changes<const N: usize, const K: usize>(
    axis: Axis,
    (line, first): ColumnAddress,
    ones: &[Column<K>],
    others: &[Column<K>],
) -> VoxelBox
where
    Grid<N>: Size,
{
    let columns = (first..).zip(ones.iter().zip(others));
    columns.fold(VoxelBox::EMPTY, |changed, (place, (one, other))| {
        changed.hull_with(box_of_change::<N, K>(axis, (line, place), one, other))
    })
}

/// Returns the box around the voxels that differ between two values of a column.
fn box_of_change<const N: usize, const K: usize>(
    axis: Axis,
    address: ColumnAddress,
    one: &Column<K>,
    other: &Column<K>,
) -> VoxelBox
where
    Grid<N>: Size,
{
    let change = Range::hull_of(one.to_row::<<Grid<N> as Size>::Row>() ^ other.to_row());
    if change.is_empty() {
        return VoxelBox::EMPTY;
    }
    let mut ranges = axis.voxel_at(address, 0).map(|place| Range::new(place, place));
    ranges[axis as usize] = change;
    VoxelBox::new(ranges)
}
