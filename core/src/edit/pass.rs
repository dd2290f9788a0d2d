//! One edit under way: flip, tighten, close.

use super::{Edit, EditReport, EditScratch, Line, Operation};
use crate::brush::Bounds;
use crate::limits::SHELL_DEPTH;
use crate::maps::{Axis, Column, Maps, Range};
use crate::plane::Plane;
use crate::row::Bits;
use crate::shell::{deep, majority, near};
use crate::size::{Grid, Size};
use crate::volume::{Journal, Volume};

pub(super) struct Pass<'a, const N: usize, J>
where
    Grid<N>: Size,
{
    pub(super) volume: &'a mut Volume<N>,
    pub(super) mask: &'a Maps<N>,
    pub(super) edit: &'a Edit<'a>,
    pub(super) scratch: &'a mut EditScratch<N>,
    pub(super) journal: &'a mut J,
    pub(super) bounds: Bounds,
    pub(super) report: EditReport,
    /// Whether any column grew.
    pub(super) grew: bool,
}

impl<const N: usize, J: Journal<N>> Pass<'_, N, J>
where
    Grid<N>: Size,
{
    /// Flips layer after layer, each once no layer still to be computed reads it.
    pub(super) fn flip_voxels(&mut self) {
        let lag = match self.edit.operation {
            Operation::Carve { depth } | Operation::Fill { depth } => depth.min(SHELL_DEPTH),
            Operation::Smooth => 1,
        };
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

    /// Finds the voxels of a layer to flip. Returns the rows, by z, that may hold some.
    fn compute_layer(&mut self, y: usize) -> Range {
        let slot = y % self.scratch.pending.len();
        // The rows of a piece and its bounds are rounded each in its own way.
        let rows = self.scratch.pieces.enter(y, N);
        let rows = Range::new(rows.lo().max(self.bounds.lo[2]), rows.hi().min(self.bounds.hi[2]));
        for z in voxels(rows) {
            let mut brush = self.scratch.pieces.row::<N>(z);
            if self.edit.mirrored {
                brush |= brush.mirrored(N);
            }
            self.scratch.pending[slot][z] = self.flips((y, z), brush);
        }
        rows
    }

    /// The voxels of a row that the edit flips, before closure.
    fn flips(
        &mut self,
        (y, z): (usize, usize),
        brush: <Grid<N> as Size>::Row,
    ) -> <Grid<N> as Size>::Row {
        let rows = self.volume.rows();
        let here = rows.row(y, z);
        match self.edit.operation {
            Operation::Carve { depth } => {
                let wanted = brush & here;
                if wanted.is_empty() {
                    return wanted;
                }
                let deep = deep(rows, (y, z), depth.min(SHELL_DEPTH), wanted);
                if !deep.is_empty() {
                    self.report.refused_by_depth += deep.count();
                }
                self.spare_mask((y, z), wanted & !deep)
            }
            Operation::Fill { depth } => {
                let wanted = brush & !here;
                if wanted.is_empty() {
                    return wanted;
                }
                let near = near(rows, (y, z), depth.min(SHELL_DEPTH), wanted);
                if near != wanted {
                    self.report.refused_by_depth += (wanted & !near).count();
                }
                near
            }
            Operation::Smooth => {
                let index = self.start_index(y, z);
                self.scratch.start.as_flattened_mut()[index] = here;
                if brush.is_empty() {
                    return brush;
                }
                let most = majority(rows, (y, z));
                let filled = brush & most & !here;
                self.spare_mask((y, z), brush & here & !most) | filled
            }
        }
    }

    /// Of the voxels to be removed, those the mask doesn't hold.
    fn spare_mask(
        &mut self,
        row: (usize, usize),
        removed: <Grid<N> as Size>::Row,
    ) -> <Grid<N> as Size>::Row {
        if self.mask.column(Axis::X, row) == Column::EMPTY {
            return removed;
        }
        let held = self.mask.row_among(row, removed);
        self.report.refused_by_mask += held.count();
        removed & !held
    }

    fn flip_layer(&mut self, y: usize, rows: Range) {
        for z in voxels(rows) {
            let flips = self.scratch.pending[y % self.scratch.pending.len()][z];
            if flips.is_empty() {
                continue;
            }
            let here = self.volume.rows().row(y, z);
            let (removed, added) = (flips & here, flips & !here);
            if !removed.is_empty() {
                self.report.removed += removed.count();
            }
            if !added.is_empty() {
                self.report.added += added.count();
                self.journal.added((y, z), added);
            }
            *self.volume.rows_mut().row_mut(y, z) = here ^ flips;
            self.scratch.along_y[z].flip(flips, y);
            self.scratch.along_z[y].flip(flips, z);
            if self.replace(Axis::X, (y, z), Range::hull(here ^ flips)).is_some() {
                self.scratch.grown_x[y].insert(z);
            }
        }
    }

    pub(super) fn tighten_columns(&mut self) {
        for z in self.bounds.lo[2]..=self.bounds.hi[2] {
            let mut line = self.scratch.along_y[z];
            self.tighten_line(Axis::Y, z, &mut line);
            self.scratch.along_y[z] = line;
        }
        for y in self.bounds.lo[1]..=self.bounds.hi[1] {
            let mut line = self.scratch.along_z[y];
            self.tighten_line(Axis::Z, y, &mut line);
            self.scratch.along_z[y] = line;
        }
    }

    /// Re-tightens the columns of a line that voxels were flipped in. An end outside the stretch
    /// of the flips stands; the others are looked for, N columns at a time.
    fn tighten_line(
        &mut self,
        axis: Axis,
        line: usize,
        touched: &mut Line<<Grid<N> as Size>::Row>,
    ) {
        let Line { flipped, between, .. } = *touched;
        if flipped.is_empty() {
            return;
        }
        let (mut lo, mut hi) = ([0u8; N], [0u8; N]);
        let (mut seek_lo, mut seek_hi) = (flipped, flipped);
        let mut within = between;
        for x in flipped.ones() {
            let old = self.volume.maps().column(axis, (line, x)).hull();
            within = within.hull_with(old);
            if old.lo() < between.lo() {
                lo[x] = old.lo() as u8;
                seek_lo.toggle(x);
            }
            if old.hi() > between.hi() {
                hi[x] = old.hi() as u8;
                seek_hi.toggle(x);
            }
        }
        let rows = self.volume.rows();
        seek(rows, axis, line, seek_hi, (within.lo()..=between.hi()).rev(), &mut hi);
        let empty = seek(rows, axis, line, seek_lo, between.lo()..=within.hi(), &mut lo);
        for x in flipped.ones() {
            let range = match empty.contains(x) {
                true => Range::EMPTY,
                false => Range::new(lo[x].into(), hi[x].into()),
            };
            if let Some(growth) = self.replace(axis, (line, x), range) {
                touched.grown.insert(x);
                touched.growth = touched.growth.hull_with(growth);
            }
        }
    }

    /// Replaces a column. Returns by what stretch it grew, at most.
    #[inline]
    fn replace(&mut self, axis: Axis, at: (usize, usize), range: Range) -> Option<Range> {
        let old = self.volume.maps().column(axis, at).hull();
        if range == old {
            return None;
        }
        self.volume.set_column(axis, at, Column([range]), self.journal);
        if range.is_empty() || old.lo() <= range.lo() && range.hi() <= old.hi() {
            return None;
        }
        self.grew = true;
        let lo = if range.lo() < old.lo() { range.lo() } else { old.hi() };
        let hi = if range.hi() > old.hi() { range.hi() } else { old.lo() };
        Some(if old.is_empty() { range } else { Range::new(lo, hi) })
    }

    /// Brings back what was removed but all three ranges hold. It lies where columns along y and z
    /// that lost voxels cross.
    pub(super) fn close_holes(&mut self) {
        for y in self.bounds.lo[1]..=self.bounds.hi[1] {
            let Line { flipped, between, .. } = self.scratch.along_z[y];
            for z in voxels(between) {
                self.close_row(y, z, flipped & self.scratch.along_y[z].flipped);
            }
        }
    }

    /// Occupies what columns that grew brought into all three ranges.
    pub(super) fn close_beams(&mut self) {
        let Bounds { lo, hi } = self.bounds;
        for y in lo[1]..=hi[1] {
            for z in self.scratch.grown_x[y].ones() {
                self.close_row(y, z, Grid::<N>::FULL);
            }
            let Line { grown, growth, .. } = self.scratch.along_z[y];
            for z in voxels(growth) {
                self.close_row(y, z, grown);
            }
        }
        for z in lo[2]..=hi[2] {
            let Line { grown, growth, .. } = self.scratch.along_y[z];
            for y in voxels(growth) {
                self.close_row(y, z, grown);
            }
        }
    }

    #[inline]
    fn close_row(&mut self, y: usize, z: usize, window: <Grid<N> as Size>::Row) {
        let here = self.volume.rows().row(y, z);
        let among = window & !here;
        if among.is_empty() {
            return;
        }
        let missing = self.volume.maps().row_among((y, z), among);
        if missing.is_empty() {
            return;
        }
        let back = missing & self.at_start(y, z);
        let closed = missing & !back;
        self.report.removed -= back.count();
        self.report.refused_by_closure += back.count();
        self.report.closed += closed.count();
        if !closed.is_empty() {
            self.journal.added((y, z), closed);
        }
        *self.volume.rows_mut().row_mut(y, z) = here | missing;
    }

    /// Row (y, z) when the edit began, as far as closure can bring voxels back to it: a carve adds
    /// nothing, so all that comes back was there; a fill removes nothing, so none was; smoothing
    /// removed some only between the row's first flip and last.
    fn at_start(&self, y: usize, z: usize) -> <Grid<N> as Size>::Row {
        let flipped = || {
            (self.bounds.lo[1]..=self.bounds.hi[1]).contains(&y)
                && self.scratch.along_z[y].between.contains(z)
        };
        match self.edit.operation {
            Operation::Carve { .. } => Grid::<N>::FULL,
            Operation::Smooth if flipped() => {
                self.scratch.start.as_flattened()[self.start_index(y, z)]
            }
            _ => <Grid<N> as Size>::Row::EMPTY,
        }
    }

    fn start_index(&self, y: usize, z: usize) -> usize {
        let Bounds { lo, hi } = self.bounds;
        (y - lo[1]) * (hi[2] - lo[2] + 1) + z - lo[2]
    }
}

/// Walks rows of a line in the order given and notes where each sought column is first occupied.
/// Returns the columns that nowhere are.
fn seek<const N: usize>(
    rows: &Plane<N>,
    axis: Axis,
    line: usize,
    mut sought: <Grid<N> as Size>::Row,
    order: impl Iterator<Item = usize>,
    found_at: &mut [u8; N],
) -> <Grid<N> as Size>::Row
where
    Grid<N>: Size,
{
    for i in order {
        if sought.is_empty() {
            break;
        }
        let row = if axis == Axis::Y { rows.row(i, line) } else { rows.row(line, i) };
        let found = sought & row;
        if !found.is_empty() {
            for x in found.ones() {
                found_at[x] = i as u8;
            }
            sought &= !found;
        }
    }
    sought
}

/// The voxels of a range.
fn voxels(range: Range) -> impl Iterator<Item = usize> {
    range.lo()..range.hi() + 1
}
