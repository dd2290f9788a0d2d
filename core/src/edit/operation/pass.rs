//! One edit in progress: flips voxels layer by layer and updates the ranges after them.

use super::{Edit, EditOperation, EditReport, EditScratch};
use crate::edit::brush::{BrushBounds, BrushRow};
use crate::limits::SHELL_DEPTH;
use crate::volume::editable::Volume;
use crate::volume::journal::Journal;
use crate::volume::neighbourhood::{dilated_row_with_ground, eroded_row};
use crate::volume::range::Range;
use crate::volume::range_maps::{Axis, Column, RangeMaps, RowAddress};
use crate::volume::row::{BitRow, BitSet};
use crate::volume::size::{Grid, Size};

/// An edit that reads and flips `W` words of each row, from word `first_word` on. Bit i of a `BitRow<W>`
/// is voxel `64 * first_word + i`.
pub(super) struct EditPass<'a, const N: usize, const K: usize, const W: usize>
where
    Grid<N>: Size,
{
    pub(super) volume: &'a mut Volume<N, K>,
    pub(super) mask: &'a RangeMaps<N, K>,
    pub(super) edit: &'a Edit<'a>,
    pub(super) scratch: &'a mut EditScratch<N>,
    pub(super) journal: &'a mut dyn Journal<N, K>,
    pub(super) bounds: BrushBounds,
    pub(super) first_word: usize,
    pub(super) report: EditReport,
}

impl<const N: usize, const K: usize, const W: usize> EditPass<'_, N, K, W>
where
    Grid<N>: Size,
{
    pub(super) fn run(mut self) -> EditReport {
        self.scratch.reset_lines(self.bounds);
        self.compute_and_flip_voxels();
        self.tighten_along_y();
        if self.edit.operation.removes_voxels() {
            self.close_after_removal();
        }
        if self.edit.operation.adds_voxels() {
            self.close_after_growth();
        }
        self.report
    }

    /// Computes and flips layer by layer. A layer is flipped once no later layer needs its original voxels.
    fn compute_and_flip_voxels(&mut self) {
        let lag = self.edit.operation.flip_lag();
        let mut pending = [Range::EMPTY; SHELL_DEPTH + 1];
        let (first, last) = (self.bounds.lo[1], self.bounds.hi[1]);
        for y in first..=last + lag {
            if y <= last {
                pending[y % pending.len()] = self.compute_layer_flips(y);
            }
            if y >= first + lag {
                self.flip_layer(y - lag, pending[(y - lag) % pending.len()]);
            }
        }
    }

    /// Computes the voxels of layer `y` to flip, before closure. Returns the z range of the rows that may
    /// hold some.
    fn compute_layer_flips(&mut self, y: usize) -> ZRange {
        let z_range = self.rasterise_brush_layer(y);
        match self.edit.operation {
            EditOperation::Carve { .. } => self.carve_layer(y, z_range),
            EditOperation::Fill { .. } => self.fill_layer(y, z_range),
            EditOperation::Smooth { .. } => self.smooth_layer(y, z_range),
            EditOperation::Flatten { .. } => self.flatten_layer(y, z_range),
        }
        z_range
    }

    /// Rasterises layer `y` of the brush into the flips' memory. A carve may skip rows in which the volume
    /// has no voxels. Returns the z range of the rows.
    #[inline(never)] // as the functions that follow: together they would spill registers
    fn rasterise_brush_layer(&mut self, y: usize) -> ZRange {
        let layer = &mut self.scratch.pending[y % (SHELL_DEPTH + 1)];
        let words = BrushWords { first_word: self.first_word, mirrored: self.edit.mirrored };
        let (mut least, mut greatest) = (N, 0);
        layer[self.bounds.lo[2]..=self.bounds.hi[2]].fill(BitSet::EMPTY);
        let visit = |BrushRow { z, x_range }| {
            let brush: BitRow<W> = layer[z].word_span(0) | words.of_range(x_range, N);
            layer[z].set_word_span(0, brush);
            (least, greatest) = (least.min(z), greatest.max(z));
        };
        // A mirrored carve also needs the rows at the mirror image, so it can't skip any.
        match self.edit.operation {
            EditOperation::Carve { .. } if !self.edit.mirrored => {
                let rows = self.volume.rows().layer(y);
                self.scratch.pieces.visit_layer_rows_held(y, rows, visit);
            }
            _ => self.scratch.pieces.visit_layer_rows(y, N, visit),
        }
        if least > greatest { Range::EMPTY } else { Range::new(least, greatest) }
    }

    #[inline(never)]
    fn carve_layer(&mut self, y: usize, z_range: ZRange) {
        let volume = self.volume.rows().row_strip::<W>(self.first_word);
        let (mask, depth) = (self.mask, self.edit.operation.neighbourhood_radius());
        let reaches_all = self.edit.operation.reaches_any_depth();
        let mut too_deep = 0;
        for z in iter_voxels(z_range) {
            let flips = &mut self.scratch.pending[y % (SHELL_DEPTH + 1)][z];
            let wanted = flips.word_span(0) & volume.row(y, z);
            if wanted.is_empty() {
                *flips = BitSet::EMPTY;
                continue;
            }
            let deep = match reaches_all {
                true => BitRow::EMPTY,
                false => eroded_row(volume, (y, z), depth, wanted),
            };
            too_deep += deep.count_ones();
            let mut removed = wanted & !deep;
            if mask.column(Axis::X, (y, z)) != Column::EMPTY {
                removed = self.report.exclude_masked(mask, (y, z), self.first_word, removed);
            }
            flips.set_word_span(0, removed);
        }
        self.report.refused_by_depth += too_deep;
    }

    #[inline(never)]
    fn fill_layer(&mut self, y: usize, z_range: ZRange) {
        let volume = self.volume.rows().row_strip::<W>(self.first_word);
        let depth = self.edit.operation.neighbourhood_radius();
        let reaches_all = self.edit.operation.reaches_any_depth();
        for z in iter_voxels(z_range) {
            let flips = &mut self.scratch.pending[y % (SHELL_DEPTH + 1)][z];
            let wanted = flips.word_span(0) & !volume.row(y, z);
            let near = match reaches_all {
                true => wanted,
                false => dilated_row_with_ground(volume, (y, z), depth, wanted),
            };
            if near != wanted {
                self.report.refused_by_depth += (wanted & !near).count_ones();
            }
            flips.set_word_span(0, near);
        }
    }

    /// Flips the voxels of layer `y` and updates its columns along x and z, which no later layer affects.
    #[inline(never)]
    fn flip_layer(&mut self, y: usize, z_range: ZRange) {
        let mut columns = *self.volume.maps().line(Axis::X, y);
        let mut moved = <Grid<N> as Size>::Row::EMPTY;
        let (mut flipped, mut between) = (BitRow::EMPTY, Range::EMPTY);
        for z in iter_voxels(z_range) {
            let flips = self.scratch.pending[y % (SHELL_DEPTH + 1)][z].word_span(0);
            if flips.is_empty() {
                continue;
            }
            let row = self.flip_row_bits((y, z), flips);
            let column = Column::closed_over(row, &columns[z]);
            moved.insert_if(column != columns[z], z);
            columns[z] = column;
            self.scratch.along_y[z].note_flips(flips, y);
            (flipped, between) = (flipped | flips, between.extended_to(z));
        }
        if !flipped.is_empty() {
            self.scratch.grown_x[y] = self.replace_columns(Axis::X, y, moved, &columns).grown;
            self.tighten_along_z(y, flipped, between);
        }
    }

    /// Flips voxels of row (y, z). Returns the new row.
    #[inline]
    fn flip_row_bits(&mut self, (y, z): RowAddress, flips: BitRow<W>) -> <Grid<N> as Size>::Row {
        let row = self.volume.rows_mut().row_mut(y, z);
        let here = row.word_span(self.first_word);
        let flipped = if K == 1 {
            row.set_word_span(self.first_word, here ^ flips);
            *row
        } else {
            // In registers: reading several words would wait for the store of one of them.
            let mut flipped = *row;
            for i in 0..<Grid<N> as Size>::Row::WORDS {
                let flips = flips.0.get(i.wrapping_sub(self.first_word)).copied().unwrap_or(0);
                flipped.set_word(i, flipped.word(i) ^ flips);
            }
            *row = flipped;
            flipped
        };
        let (removed, added) = (flips & here, flips & !here);
        if !removed.is_empty() {
            self.report.removed += removed.count_ones();
        }
        if !added.is_empty() {
            self.report.added += added.count_ones();
            self.journal.record_added((y, z), BitSet::from_word_span(self.first_word, added));
        }
        flipped
    }

    /// Returns the index of row (y, z) among the rows that a smoothing or flattening edit saves.
    pub(super) fn saved_row_index(&self, (y, z): RowAddress) -> usize {
        let BrushBounds { lo, hi } = self.bounds;
        (y - lo[1]) * (hi[2] - lo[2] + 1) + z - lo[2]
    }
}

impl EditReport {
    /// Returns the voxels of `removed` that the mask doesn't protect, and counts the others as refused. Bit 0
    /// is the first of word `first_word`.
    pub(super) fn exclude_masked<const N: usize, const K: usize, const W: usize>(
        &mut self,
        mask: &RangeMaps<N, K>,
        row: RowAddress,
        first_word: usize,
        removed: BitRow<W>,
    ) -> BitRow<W>
    where
        Grid<N>: Size,
    {
        let held = mask.occupied_among(row, BitSet::from_word_span(first_word, removed));
        self.refused_by_mask += held.count_ones();
        removed & !held.word_span(first_word)
    }
}

/// The words of a row that an edit reads, and a flag for including the brush's mirror image.
#[derive(Clone, Copy)]
pub(super) struct BrushWords {
    pub(super) first_word: usize,
    pub(super) mirrored: bool,
}

impl BrushWords {
    /// Returns the voxels of a brush's range in a row of a grid `grid_side` voxels wide, with their mirror
    /// images if mirrored.
    #[inline]
    pub(super) fn of_range<const W: usize>(self, x_range: Range, grid_side: usize) -> BitRow<W> {
        let mut brush = word_window_of_span(self.first_word, x_range);
        if self.mirrored {
            let last = grid_side - 1;
            let mirror = Range::new(last - x_range.last(), last - x_range.first());
            brush |= word_window_of_span(self.first_word, mirror);
        }
        brush
    }
}

/// Returns the voxels of a range, clipped to a row's words from `first_word` on.
#[inline]
pub(super) fn word_window_of_span<const W: usize>(first_word: usize, voxels: Range) -> BitRow<W> {
    let (base, lo, hi) = (64 * first_word, voxels.first(), voxels.last());
    if hi < base { BitRow::EMPTY } else { BitRow::span(lo.saturating_sub(base), hi - base) }
}

/// The range of z of a layer's rows.
type ZRange = Range;

/// Returns the voxel indices of a range, in ascending order.
pub(super) fn iter_voxels(range: Range) -> impl Iterator<Item = usize> {
    range.first()..range.last() + 1
}
