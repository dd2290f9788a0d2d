//! Updates and checks of a volume inside a box, for changes that don't come from an edit.

use crate::volume::editable::Volume;
use crate::volume::line_scan::HoleScan;
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column, ColumnAddress, RangeMaps, RowAddress};
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use crate::volume::voxel_box::VoxelBox;

impl<const N: usize, const K: usize> Volume<N, K>
where
    Grid<N>: Size,
{
    /// Rebuilds the bit rows after [`Volume::maps_and_digest_leaving_bit_rows`], if only voxels inside the
    /// box changed.
    pub(crate) fn rebuild_rows_in(&mut self, changed: VoxelBox) {
        // Few voxels are rebuilt one by one, many by whole lines.
        let [x, y, z] = changed.ranges();
        if changed.count_voxels() > N * N {
            return self.rebuild_rows_of([y, z]);
        }
        let among = x.to_row::<<Grid<N> as Size>::Row>();
        for at @ (y, z) in rows_of(y, z) {
            let row = self.rows().row(y, z) & !among | self.maps().occupied_among(at, among);
            *self.rows_mut().row_mut(y, z) = row;
        }
    }

    /// Returns the first column through the box with a range that isn't tight.
    pub(crate) fn first_loose_column_in(&self, voxels: VoxelBox) -> Option<(Axis, ColumnAddress)> {
        columns_through(voxels).find(|&(axis, at)| {
            let column = self.maps().column(axis, at);
            !column.is_tight(|i| self.rows().contains(axis.voxel_at(at, i)))
        })
    }

    /// Returns the first column through the box that isn't saturated.
    pub(crate) fn first_unsaturated_column_in(
        &self,
        voxels: VoxelBox,
    ) -> Option<(Axis, ColumnAddress)> {
        if K == 1 {
            return None;
        }
        // Few columns have an empty voxel between occupied ones; all others are saturated.
        let mut line_scanned = None;
        let mut holes = <Grid<N> as Size>::Row::EMPTY;
        columns_through(voxels).find(|&(axis, at @ (line, place))| {
            if line_scanned != Some((axis, line)) {
                line_scanned = Some((axis, line));
                holes = self.columns_with_holes(axis, line);
            }
            let is_saturated = |column: Column<K>| {
                column.is_saturated(|i| self.rows().contains(axis.voxel_at(at, i)))
            };
            holes.contains(place) && !is_saturated(self.maps().column(axis, at))
        })
    }

    /// Returns the columns of a line that have an empty voxel between occupied ones.
    fn columns_with_holes(&self, axis: Axis, line: usize) -> <Grid<N> as Size>::Row {
        let mut scan = HoleScan::NONE;
        match axis {
            Axis::X => {
                let mut found = <Grid<N> as Size>::Row::EMPTY;
                for (z, row) in self.rows().layer(line).iter().enumerate() {
                    found.insert_if(!row.without_lowest_run().is_empty(), z);
                }
                return found;
            }
            Axis::Y => (0..N).for_each(|y| scan.pass(self.rows().row(y, line))),
            Axis::Z => (0..N).for_each(|z| scan.pass(self.rows().row(line, z))),
        }
        scan.found
    }

    /// Returns the first row through the box in which a voxel of the mask inside the box is empty.
    pub(crate) fn first_row_without_its_part_of(
        &self,
        mask: &RangeMaps<N, K>,
        voxels: VoxelBox,
    ) -> Option<RowAddress> {
        let [x, y, z] = voxels.ranges();
        let among = x.to_row::<<Grid<N> as Size>::Row>();
        rows_of(y, z).find(|&at| {
            let empty = among & !self.rows().row(at.0, at.1);
            !mask.occupied_among(at, empty).is_empty()
        })
    }
}

/// Iterates over the columns through a box, axis by axis and line by line.
fn columns_through(voxels: VoxelBox) -> impl Iterator<Item = (Axis, ColumnAddress)> {
    let [x, y, z] = voxels.ranges();
    let sides = [(Axis::X, y, z), (Axis::Y, z, x), (Axis::Z, y, x)];
    sides
        .into_iter()
        .flat_map(|(axis, lines, places)| rows_of(lines, places).map(move |at| (axis, at)))
}

/// Iterates over the pairs of two ranges; the second varies fastest.
fn rows_of(first: Range, second: Range) -> impl Iterator<Item = (usize, usize)> {
    (first.first()..first.last() + 1)
        .flat_map(move |i| (second.first()..second.last() + 1).map(move |k| (i, k)))
}
