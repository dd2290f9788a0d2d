//! Closure after an edit: occupies every voxel that all three ranges hold.

use super::pass::{EditPass, iter_voxels};
use super::{EditOperation, EditReport, LineFlips};
use crate::edit::brush::BrushBounds;
use crate::volume::range_maps::{Axis, RowAddress};
use crate::volume::row::{BitRow, BitSet};
use crate::volume::size::{Grid, Size};
use crate::volume::voxel_box::VoxelBox;

impl<const N: usize, const K: usize, const W: usize> EditPass<'_, N, K, W>
where
    Grid<N>: Size,
{
    /// Restores removed voxels that all three ranges still hold. They lie where columns along y and z
    /// that lost voxels cross.
    pub(super) fn close_after_removal(&mut self) {
        for y in self.bounds.lo[1]..=self.bounds.hi[1] {
            let LineFlips { flipped, between, .. } = self.scratch.along_z[y];
            for z in iter_voxels(between) {
                let along_x: <Grid<N> as Size>::Row =
                    self.volume.maps().column(Axis::X, (y, z)).to_row();
                let among: BitRow<W> = along_x.word_span(self.first_word)
                    & !self.volume.rows().row(y, z).word_span(self.first_word)
                    & flipped.word_span(0)
                    & self.scratch.along_y[z].flipped.word_span(0);
                if among.is_empty() {
                    continue;
                }
                let along_y = &self.volume.maps().line(Axis::Y, z)[64 * self.first_word..];
                let along_z = &self.volume.maps().line(Axis::Z, y)[64 * self.first_word..];
                let mut holes = BitRow::<W>::EMPTY;
                for x in among.iter_ones() {
                    holes.insert_if(along_y[x].contains(y) & along_z[x].contains(z), x);
                }
                if !holes.is_empty() {
                    self.close_in_row((y, z), BitSet::from_word_span(self.first_word, holes));
                }
            }
        }
    }

    /// Occupies the voxels that all three ranges hold after columns grew.
    pub(super) fn close_after_growth(&mut self) {
        let BrushBounds { lo, hi } = self.bounds;
        for y in lo[1]..=hi[1] {
            for z in self.scratch.grown_x[y].iter_ones() {
                self.close_in_row((y, z), Grid::<N>::FULL);
            }
            let LineFlips { grown, growth, .. } = self.scratch.along_z[y];
            for z in iter_voxels(growth) {
                self.close_in_row((y, z), grown);
            }
        }
        for z in lo[2]..=hi[2] {
            let LineFlips { grown, growth, .. } = self.scratch.along_y[z];
            for y in iter_voxels(growth) {
                self.close_in_row((y, z), grown);
            }
        }
    }

    /// Occupies the `candidates` of row (y, z) that all three ranges hold, and reports them.
    #[inline]
    fn close_in_row(&mut self, (y, z): RowAddress, candidates: <Grid<N> as Size>::Row) {
        let here = self.volume.rows().row(y, z);
        let among = candidates & !here;
        if among.is_empty() {
            return;
        }
        let missing = self.volume.maps().occupied_among((y, z), among);
        if missing.is_empty() {
            return;
        }
        let back = missing & self.row_before_edit((y, z));
        let closed = missing & !back;
        self.report.move_from_removed_to_refused((y, z), back);
        self.report.closed += closed.count_ones();
        if !closed.is_empty() {
            self.journal.record_added((y, z), closed);
        }
        *self.volume.rows_mut().row_mut(y, z) = here | missing;
    }

    /// Returns row (y, z) at the start of the edit, exact for voxels that closure can occupy: in a carve all
    /// of them were occupied, in a fill none. Smoothing and flattening remove voxels only in rows between the
    /// layer's first and last flip, which were saved.
    fn row_before_edit(&self, (y, z): RowAddress) -> <Grid<N> as Size>::Row {
        let flipped = || {
            (self.bounds.lo[1]..=self.bounds.hi[1]).contains(&y)
                && self.scratch.along_z[y].between.contains(z)
        };
        match self.edit.operation {
            EditOperation::Carve { .. } => Grid::<N>::FULL,
            EditOperation::Smooth { .. } | EditOperation::Flatten { .. } if flipped() => {
                let start = self.scratch.rows_before.as_flattened()[self.saved_row_index((y, z))];
                BitSet::from_word_span(self.first_word, start.word_span::<W>(0))
            }
            _ => <Grid<N> as Size>::Row::EMPTY,
        }
    }
}

impl EditReport {
    /// Counts removed voxels of a row that closure restored.
    #[inline]
    fn move_from_removed_to_refused<R: BitSet>(&mut self, row: RowAddress, back: R) {
        self.removed -= back.count_ones();
        self.refused_by_closure += back.count_ones();
        self.closure_box = self.closure_box.hull_with(VoxelBox::around_row(row, back));
    }
}
