//! Smoothing: a box filter and a threshold, dithered in a part of the brush.
//!
//! The counts along y about a layer's voxels are stored by z and updated from layer to layer: a row that
//! enters the filter's reach is added, and a row that leaves it is subtracted as it was before the edit.

use super::pass::{BrushWords, EditPass, word_window_of_span};
use super::{Dither, EditOperation};
use crate::codec::digest::mix_bits;
use crate::limits::SHELL_DEPTH;
use crate::volume::box_sum::{
    BoxFilter, LINE_PLANES, Planes, RowSums, SUM_PLANES, add_counts, count_at, counts_above,
    equal_counts, subtract_counts,
};
use crate::volume::range::Range;
use crate::volume::range_maps::RowAddress;
use crate::volume::row::{BitRow, BitSet};
use crate::volume::size::{Grid, Size};

/// A part of each row that is summed at once: around the brush, or around its mirror image.
#[derive(Clone, Copy)]
struct SumWindow<const W: usize> {
    /// The first bit of the window, counted from the words that the edit reads.
    first_bit: usize,
    /// The voxels that this window decides.
    voxels: BitRow<W>,
}

/// The parameters of a smoothing edit.
#[derive(Clone, Copy)]
struct Smoothing {
    filter: BoxFilter,
    dither: Option<Dither>,
}

impl<const N: usize, const K: usize, const W: usize> EditPass<'_, N, K, W>
where
    Grid<N>: Size,
{
    /// Replaces the brush's voxels of layer `y`, which are in the flips' memory, by the flips. Layers come in
    /// ascending order.
    pub(super) fn smooth_layer(&mut self, y: usize, z_range: Range) {
        let EditOperation::Smooth { radius, dither } = self.edit.operation else { return };
        let smoothing = Smoothing { filter: BoxFilter::new(radius), dither };
        self.move_counts_to_layer(y, smoothing.filter);
        self.keep_rows_of_layer(y);
        if z_range.is_empty() {
            return;
        }
        let own: BitRow<W> =
            word_window_of_span(self.first_word, Range::new(self.bounds.lo[0], self.bounds.hi[0]));
        self.smooth_window((y, z_range), smoothing, own);
        if self.edit.mirrored {
            self.smooth_window((y, z_range), smoothing, !own);
        }
    }

    /// Decides the brush's voxels of a layer among `voxels`, with the fewest words that hold them and their
    /// sums' reach.
    fn smooth_window(
        &mut self,
        (y, z_range): (usize, Range),
        smoothing: Smoothing,
        voxels: BitRow<W>,
    ) {
        let rows = &self.scratch.pending[y % (SHELL_DEPTH + 1)];
        let rows = rows[z_range.first()..=z_range.last()].iter();
        let brush = rows.fold(BitRow::EMPTY, |brush, row| brush | row.word_span::<W>(0)) & voxels;
        let (Some(first), Some(last)) = (brush.first(), brush.last()) else { return };
        let radius = smoothing.filter.radius();
        let first_bit = first.saturating_sub(radius);
        let layer = (y, z_range);
        match (last + radius + 1 - first_bit).div_ceil(64) {
            1 => self.smooth_rows::<1>(layer, smoothing, SumWindow { first_bit, voxels }),
            2 if W > 2 => self.smooth_rows::<2>(layer, smoothing, SumWindow { first_bit, voxels }),
            _ => self.smooth_rows::<W>(layer, smoothing, SumWindow { first_bit: 0, voxels }),
        }
    }

    /// Decides them with sums of `S` words of each row from the window's first bit on.
    fn smooth_rows<const S: usize>(
        &mut self,
        (y, z_range): (usize, Range),
        smoothing: Smoothing,
        window: SumWindow<W>,
    ) {
        let radius = smoothing.filter.radius();
        let words = BrushWords { first_word: self.first_word, mirrored: self.edit.mirrored };
        let layer = smoothing.dither.as_ref().map(|dither| dither.piece.layer(y));
        let ground = (radius.saturating_sub(y)) as u32 * smoothing.filter.layer_voxels();
        let ground: Planes<BitRow<S>, SUM_PLANES> = equal_counts(ground);
        let mut row_sums = RowSums::new(smoothing.filter);
        for ahead in z_range.first()..z_range.last() + 2 * radius + 1 {
            // The row `radius` before the one that enters the filter's reach; it may lie outside the grid.
            let row = ahead.checked_sub(radius).and_then(|z| self.scratch.counts_along_y.get(z));
            let along_y = row.map_or([BitRow::EMPTY; _], |planes| {
                planes.map(|plane| plane.word_span::<W>(0).bits_from(window.first_bit))
            });
            let sums = row_sums.advance(&along_y);
            let Some(z) = ahead.checked_sub(2 * radius).filter(|&z| z >= z_range.first()) else {
                continue;
            };
            let flips = &self.scratch.pending[y % (SHELL_DEPTH + 1)][z];
            let brush = flips.word_span::<W>(0) & window.voxels;
            if brush.is_empty() {
                continue;
            }
            let mut sums = *sums;
            add_counts(&mut sums, &ground);
            let range = layer.as_ref().and_then(|layer| layer.x_range(z, N));
            let dithered = match range {
                Some(range) => words.of_range(range, N) & brush,
                None => BitRow::EMPTY,
            };
            let bits = |row: BitRow<W>| row.bits_from::<S>(window.first_bit);
            let most = smoothing.smoothed_row(&sums, bits(brush & !dithered))
                | self.dithered_row((y, z), (&sums, window), bits(dithered), smoothing);
            self.flip_in_brush((y, z), brush, BitRow::from_bits_at(most, window.first_bit));
        }
    }

    /// Replaces the brush's voxels in the flips' memory by the flips that leave only `occupied` and the mask
    /// occupied.
    fn flip_in_brush(&mut self, (y, z): RowAddress, brush: BitRow<W>, occupied: BitRow<W>) {
        let here: BitRow<W> = self.volume.rows().row(y, z).word_span(self.first_word);
        let removed = brush & here & !occupied;
        let removed = self.report.exclude_masked(self.mask, (y, z), self.first_word, removed);
        let flips = &mut self.scratch.pending[y % (SHELL_DEPTH + 1)][z];
        let rest = flips.word_span::<W>(0) & !brush;
        flips.set_word_span(0, rest | removed | occupied & !here);
    }

    /// Returns the voxels `among` that the dithered threshold of [`Dither`] makes occupied. Only the few
    /// voxels near the threshold are decided one by one.
    fn dithered_row<const S: usize>(
        &self,
        (y, z): RowAddress,
        (sums, window): (&Planes<BitRow<S>, SUM_PLANES>, SumWindow<W>),
        among: BitRow<S>,
        Smoothing { filter, dither }: Smoothing,
    ) -> BitRow<S> {
        let (false, Some(dither)) = (among.is_empty(), dither) else {
            return BitRow::EMPTY;
        };
        let layer_voxels = filter.layer_voxels();
        let least = (filter.side() - 1) / 2 * layer_voxels;
        let surely = among & counts_above(sums, least + layer_voxels - 1);
        let perhaps = among & counts_above(sums, least) & !surely;
        let mut occupied = surely;
        for bit in perhaps.iter_ones() {
            let x = 64 * self.first_word + window.first_bit + bit;
            // Both halves of a mirrored edit have the same dither.
            let x = if self.edit.mirrored { x.min(N - 1 - x) } else { x };
            let threshold = least + dither_of_voxel(dither.seed, [x, y, z], layer_voxels);
            occupied.insert_if(count_at(sums, bit) > threshold, bit);
        }
        occupied
    }

    /// Updates the counts along y to layer `y`: computes them in full for the first layer, and incrementally
    /// for later ones. The ground below y = 0 isn't counted.
    fn move_counts_to_layer(&mut self, y: usize, filter: BoxFilter) {
        let (first, radius) = (self.bounds.lo[1], filter.radius());
        let z_range =
            self.bounds.lo[2].saturating_sub(radius)..(self.bounds.hi[2] + radius + 1).min(N);
        if y == first {
            self.scratch.counts_along_y[z_range.clone()].fill(equal_counts(0));
        }
        let comes = if y == first {
            y.saturating_sub(radius)..y + radius + 1
        } else {
            y + radius..y + radius + 1
        };
        for layer in comes.start..comes.end.min(N) {
            for z in z_range.clone() {
                let row: BitRow<W> = self.volume.rows().row(layer, z).word_span(self.first_word);
                self.change_counts(z, row, add_counts);
            }
        }
        if let Some(layer) = y.checked_sub(radius + 1).filter(|_| y > first) {
            for z in z_range {
                let row = self.row_at_start((layer, z));
                self.change_counts(z, row, subtract_counts);
            }
        }
    }

    /// Adds a row to the counts along y at z, or subtracts it.
    fn change_counts(
        &mut self,
        z: usize,
        row: BitRow<W>,
        change: impl Fn(&mut Planes<BitRow<W>, LINE_PLANES>, &Planes<BitRow<W>, 1>),
    ) {
        if row.is_empty() {
            return;
        }
        let planes = &mut self.scratch.counts_along_y[z];
        let mut counts = planes.map(|plane| plane.word_span::<W>(0));
        change(&mut counts, &[row]);
        planes.iter_mut().zip(counts).for_each(|(plane, count)| plane.set_word_span(0, count));
    }

    /// Returns a row of a layer below the edited one as it was when the edit began.
    pub(super) fn row_at_start(&self, (y, z): RowAddress) -> BitRow<W> {
        let bounds = self.bounds;
        if y >= bounds.lo[1] && (bounds.lo[2]..=bounds.hi[2]).contains(&z) {
            let index = self.saved_row_index((y, z));
            return self.scratch.rows_before.as_flattened()[index].word_span(0);
        }
        self.volume.rows().row(y, z).word_span(self.first_word)
    }

    /// Saves the rows of layer `y` within the brush's bounds.
    pub(super) fn keep_rows_of_layer(&mut self, y: usize) {
        for z in self.bounds.lo[2]..=self.bounds.hi[2] {
            let index = self.saved_row_index((y, z));
            let here: BitRow<W> = self.volume.rows().row(y, z).word_span(self.first_word);
            self.scratch.rows_before.as_flattened_mut()[index].set_word_span(0, here);
        }
    }
}

impl Smoothing {
    /// Returns the voxels `among` whose cube is occupied by more than half.
    fn smoothed_row<const S: usize>(
        &self,
        sums: &Planes<BitRow<S>, SUM_PLANES>,
        among: BitRow<S>,
    ) -> BitRow<S> {
        let half = self.filter.side() * self.filter.layer_voxels() / 2;
        if among.is_empty() { among } else { among & counts_above(sums, half) }
    }
}

/// Returns a number from 0 to `end - 1` for a voxel, a hash of its index x + 256 y + 65,536 z and the seed.
fn dither_of_voxel(seed: u64, [x, y, z]: [usize; 3], end: u32) -> u32 {
    let index = x as u64 | (y as u64) << 8 | (z as u64) << 16;
    let bits = mix_bits(seed ^ mix_bits(index + 1)) >> 32;
    ((bits * u64::from(end)) >> 32) as u32
}
