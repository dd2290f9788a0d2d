//! One edit under way: flip voxels layer by layer, and the ranges after them.

use super::{Edit, EditReport, EditScratch, Operation};
use crate::brush::Bounds;
use crate::limits::SHELL_DEPTH;
use crate::maps::{Axis, Column, Maps, Range};
use crate::row::{Bits, Row};
use crate::shell::{deep, majority, near};
use crate::size::{Grid, Size};
use crate::volume::{Journal, Volume};

/// An edit that reads and flips `W` words of each row, from word `first` on. Bit i of a `Row<W>` is
/// voxel `64 * first + i`.
pub(super) struct Pass<'a, const N: usize, const W: usize, J>
where
    Grid<N>: Size,
{
    pub(super) volume: &'a mut Volume<N>,
    pub(super) mask: &'a Maps<N>,
    pub(super) edit: &'a Edit<'a>,
    pub(super) scratch: &'a mut EditScratch<N>,
    pub(super) journal: &'a mut J,
    pub(super) bounds: Bounds,
    pub(super) first: usize,
    pub(super) report: EditReport,
}

impl<const N: usize, const W: usize, J: Journal<N>> Pass<'_, N, W, J>
where
    Grid<N>: Size,
{
    pub(super) fn run(mut self) -> EditReport {
        self.scratch.forget(self.bounds);
        self.flip_voxels();
        self.tighten_along_y();
        if self.edit.operation.removes() {
            self.close_holes();
        }
        if self.edit.operation.adds() {
            self.close_beams();
        }
        self.report
    }

    /// Flips layer after layer, each once no layer still to be computed reads it.
    fn flip_voxels(&mut self) {
        let lag = self.edit.operation.reach();
        let mut pending = [Range::EMPTY; SHELL_DEPTH + 1];
        let (first, last) = (self.bounds.lo[1], self.bounds.hi[1]);
        for y in first..=last + lag {
            if y <= last {
                pending[y % pending.len()] = self.compute_layer(y);
            }
            if y >= first + lag {
                self.flip_layer(y - lag, pending[(y - lag) % pending.len()]);
            }
        }
    }

    /// Finds the voxels of a layer to flip, before closure. Returns the rows, by z, that may hold
    /// some.
    fn compute_layer(&mut self, y: usize) -> Range {
        let rows = self.draw_brush(y);
        match self.edit.operation {
            Operation::Carve { .. } => self.carve_layer(y, rows),
            Operation::Fill { .. } => self.fill_layer(y, rows),
            Operation::Smooth => self.smooth_layer(y, rows),
        }
        rows
    }

    /// Writes a layer of the brush where the flips are to be. Returns its rows, by z.
    #[inline(never)] // as the parts that follow: together they want more registers than there are
    fn draw_brush(&mut self, y: usize) -> Range {
        let layer = &mut self.scratch.pending[y % (SHELL_DEPTH + 1)];
        let (first, mirrored) = (self.first, self.edit.mirrored);
        let (mut least, mut greatest) = (N, 0);
        layer[self.bounds.lo[2]..=self.bounds.hi[2]].fill(Bits::EMPTY);
        self.scratch.pieces.layer(y, N, |z, (lo, hi)| {
            let mut brush: Row<W> = layer[z].part(0) | span(first, lo, hi);
            if mirrored {
                brush |= span(first, N - 1 - hi, N - 1 - lo);
            }
            layer[z].set_part(0, brush);
            (least, greatest) = (least.min(z), greatest.max(z));
        });
        if least > greatest { Range::EMPTY } else { Range::new(least, greatest) }
    }

    #[inline(never)]
    fn carve_layer(&mut self, y: usize, rows: Range) {
        let volume = self.volume.rows().strip::<W>(self.first);
        let (mask, depth) = (self.mask, self.edit.operation.reach());
        let mut too_deep = 0;
        for z in voxels(rows) {
            let flips = &mut self.scratch.pending[y % (SHELL_DEPTH + 1)][z];
            let wanted = flips.part(0) & volume.row(y, z);
            if wanted.is_empty() {
                *flips = Bits::EMPTY;
                continue;
            }
            let deep = deep(volume, (y, z), depth, wanted);
            too_deep += deep.count();
            let mut removed = wanted & !deep;
            if mask.column(Axis::X, (y, z)) != Column::EMPTY {
                removed = self.report.spare(mask, (y, z), self.first, removed);
            }
            flips.set_part(0, removed);
        }
        self.report.refused_by_depth += too_deep;
    }

    #[inline(never)]
    fn fill_layer(&mut self, y: usize, rows: Range) {
        let volume = self.volume.rows().strip::<W>(self.first);
        let depth = self.edit.operation.reach();
        for z in voxels(rows) {
            let flips = &mut self.scratch.pending[y % (SHELL_DEPTH + 1)][z];
            let wanted = flips.part(0) & !volume.row(y, z);
            let near = near(volume, (y, z), depth, wanted);
            if near != wanted {
                self.report.refused_by_depth += (wanted & !near).count();
            }
            flips.set_part(0, near);
        }
    }

    #[inline(never)]
    fn smooth_layer(&mut self, y: usize, rows: Range) {
        let volume = self.volume.rows().strip::<W>(self.first);
        for z in voxels(rows) {
            let index = self.start_index(y, z);
            let here = volume.row(y, z);
            self.scratch.start.as_flattened_mut()[index].set_part(0, here);
            let flips = &mut self.scratch.pending[y % (SHELL_DEPTH + 1)][z];
            let brush = flips.part(0);
            let most = majority(volume, (y, z), brush);
            let removed = self.report.spare(self.mask, (y, z), self.first, brush & here & !most);
            flips.set_part(0, removed | most & !here);
        }
    }

    /// Flips a layer's voxels. No later layer matters to its columns along x and z.
    #[inline(never)]
    fn flip_layer(&mut self, y: usize, rows: Range) {
        let mut columns = *self.volume.maps().line(Axis::X, y);
        let mut moved = <Grid<N> as Size>::Row::EMPTY;
        let (mut flipped, mut between) = (Row::EMPTY, Range::EMPTY);
        for z in voxels(rows) {
            let flips = self.scratch.pending[y % (SHELL_DEPTH + 1)][z].part(0);
            if flips.is_empty() {
                continue;
            }
            let hull = Column([self.flip_row((y, z), flips)]);
            moved.insert_if(hull != columns[z], z);
            columns[z] = hull;
            self.scratch.along_y[z].flip(flips, y);
            (flipped, between) = (flipped | flips, between.up_to(z));
        }
        if !flipped.is_empty() {
            self.scratch.grown_x[y] = self.replace(Axis::X, y, moved, &columns).0;
            self.tighten_along_z(y, flipped, between);
        }
    }

    /// Returns the hull of the row.
    #[inline]
    fn flip_row(&mut self, (y, z): (usize, usize), flips: Row<W>) -> Range {
        let row = self.volume.rows_mut().row_mut(y, z);
        let here = row.part(self.first);
        row.set_part(self.first, here ^ flips);
        let hull = Range::hull(*row);
        let (removed, added) = (flips & here, flips & !here);
        if !removed.is_empty() {
            self.report.removed += removed.count();
        }
        if !added.is_empty() {
            self.report.added += added.count();
            self.journal.added((y, z), Bits::of_part(self.first, added));
        }
        hull
    }

    pub(super) fn start_index(&self, y: usize, z: usize) -> usize {
        let Bounds { lo, hi } = self.bounds;
        (y - lo[1]) * (hi[2] - lo[2] + 1) + z - lo[2]
    }
}

impl EditReport {
    /// Of the voxels to be removed from a row's words from `first` on, those the mask doesn't hold.
    fn spare<const N: usize, const W: usize>(
        &mut self,
        mask: &Maps<N>,
        row: (usize, usize),
        first: usize,
        removed: Row<W>,
    ) -> Row<W>
    where
        Grid<N>: Size,
    {
        let held = mask.row_among(row, Bits::of_part(first, removed));
        self.refused_by_mask += held.count();
        removed & !held.part(first)
    }
}

/// The voxels `lo..=hi` of a row, as far as its words from `first` on go.
#[inline]
pub(super) fn span<const W: usize>(first: usize, lo: usize, hi: usize) -> Row<W> {
    let base = 64 * first;
    if hi < base { Row::EMPTY } else { Row::span(lo.saturating_sub(base), hi - base) }
}

/// The voxels of a range.
pub(super) fn voxels(range: Range) -> impl Iterator<Item = usize> {
    range.lo()..range.hi() + 1
}
