//! Edits: change bit rows layer by layer, re-tighten the columns through them, then close.
//!
//! An edit is the exact boolean operation on voxels, then closure: the ranges become the tight
//! hulls of the result and the volume their intersection. Source: sections 3, 3.2 and 3.5 of the
//! paper; the closure rule is stated in [`crate`].

use crate::brush::{Bounds, Brush, Pieces};
use crate::limits::{SHELL_DEPTH, SMOOTH_LINES};
use crate::maps::{Axis, Column, Maps, Range};
use crate::plane::Plane;
use crate::row::Bits;
use crate::shell::{deep, majority, near};
use crate::size::{Grid, Size};
use crate::volume::{Journal, Volume};

/// What an edit does to the voxels of its brush.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Operation {
    /// Removes those at most `depth` six-neighbour steps from an empty voxel, as the volume stood
    /// when the edit began; outside the grid counts as empty. `depth` up to [`SHELL_DEPTH`].
    Carve {
        /// Layers of the shell that may go.
        depth: usize,
    },
    /// Occupies those at most `depth` steps from the volume or from the ground under y = 0.
    Fill {
        /// Layers that may be laid on.
        depth: usize,
    },
    /// Each becomes what most of its 3 x 3 x 3 neighbourhood is. Below y = 0 counts as occupied,
    /// elsewhere outside as empty.
    Smooth,
}

/// One edit.
#[derive(Clone, Copy, Debug)]
pub struct Edit<'a> {
    /// The voxels it is about.
    pub brush: &'a Brush,
    /// What it does to them.
    pub operation: Operation,
    /// Whether the brush's voxel mirror (x to N - 1 - x) belongs to the brush.
    pub mirrored: bool,
}

/// What an edit did, in voxels.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct EditReport {
    /// Occupied before, empty after.
    pub removed: u32,
    /// Empty before, occupied by the operation itself: inside the brush and its depth.
    pub added: u32,
    /// Empty before, occupied by closure alone.
    pub closed: u32,
    /// Not removed because the mask holds them.
    pub refused_by_mask: u32,
    /// Neither removed nor added because they lie beyond the shell's depth.
    pub refused_by_depth: u32,
    /// Removed and brought back by closure.
    pub refused_by_closure: u32,
}

impl EditReport {
    /// Whether the volume is another than before.
    #[must_use]
    pub const fn changed(&self) -> bool {
        self.removed + self.added + self.closed != 0
    }
}

/// A smoothing edit touches more rows than [`SMOOTH_LINES`] lines of N; nothing was changed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BrushTooLarge;

/// Rows held back while an edit reads the volume as it stood at the start, and what it touched.
#[derive(Debug)]
pub struct EditScratch<const N: usize>
where
    Grid<N>: Size,
{
    pieces: Pieces,
    /// Voxels to flip, of the last layers computed, by y modulo the length.
    pending: [[<Grid<N> as Size>::Row; N]; SHELL_DEPTH + 1],
    /// The rows of a smoothing edit's brush as they were.
    start: [[<Grid<N> as Size>::Row; N]; SMOOTH_LINES],
    /// Columns along y, by z.
    along_y: [Line<<Grid<N> as Size>::Row>; N],
    /// Columns along z, by y.
    along_z: [Line<<Grid<N> as Size>::Row>; N],
    /// Columns along x that grew, by y.
    grown_x: [<Grid<N> as Size>::Row; N],
}

/// What an edit touched of a line of N columns, bit x being a column.
#[derive(Clone, Copy, Debug)]
struct Line<R> {
    /// Columns that voxels were flipped in.
    flipped: R,
    /// Along the columns, from the first flipped voxel to the last.
    between: Range,
    /// Columns that grew.
    grown: R,
    /// By what stretch, at most.
    growth: Range,
}

impl<R: Bits> Line<R> {
    const UNTOUCHED: Self =
        Line { flipped: R::EMPTY, between: Range::EMPTY, grown: R::EMPTY, growth: Range::EMPTY };

    #[inline]
    fn flip(&mut self, columns: R, place: usize) {
        self.flipped |= columns;
        self.between = self.between.hull_with(Range::new(place, place));
    }
}

impl<const N: usize> EditScratch<N>
where
    Grid<N>: Size,
{
    /// For static initialisers only. What it holds between edits means nothing.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the rows about by value
    pub const fn new() -> Self {
        let line = [<Grid<N> as Size>::Row::EMPTY; N];
        EditScratch {
            pieces: Pieces::new(),
            pending: [line; SHELL_DEPTH + 1],
            start: [line; SMOOTH_LINES],
            along_y: [Line::UNTOUCHED; N],
            along_z: [Line::UNTOUCHED; N],
            grown_x: line,
        }
    }

    fn forget(&mut self, Bounds { lo, hi }: Bounds) {
        self.along_y[lo[2]..=hi[2]].fill(Line::UNTOUCHED);
        self.along_z[lo[1]..=hi[1]].fill(Line::UNTOUCHED);
        self.grown_x[lo[1]..=hi[1]].fill(<Grid<N> as Size>::Row::EMPTY);
    }
}

/// Applies an edit. `mask` is closed and part of the volume; its voxels are never removed.
///
/// # Errors
/// [`BrushTooLarge`] for a smoothing brush of more rows than there is room to remember.
pub fn apply<const N: usize, J: Journal<N>>(
    volume: &mut Volume<N>,
    mask: &Maps<N>,
    edit: &Edit<'_>,
    scratch: &mut EditScratch<N>,
    journal: &mut J,
) -> Result<EditReport, BrushTooLarge>
where
    Grid<N>: Size,
{
    let Some(bounds) = scratch.pieces.set(edit.brush, N) else {
        return Ok(EditReport::default());
    };
    let rows = (bounds.hi[1] - bounds.lo[1] + 1) * (bounds.hi[2] - bounds.lo[2] + 1);
    if edit.operation == Operation::Smooth && rows > SMOOTH_LINES * N {
        return Err(BrushTooLarge);
    }
    scratch.forget(bounds);
    let report = EditReport::default();
    let mut pass = Pass { volume, mask, edit, scratch, journal, bounds, report, grew: false };
    pass.flip_voxels();
    pass.tighten_columns();
    if !matches!(edit.operation, Operation::Fill { .. }) {
        pass.close_holes();
    }
    if pass.grew {
        pass.close_beams();
    }
    Ok(pass.report)
}

struct Pass<'a, const N: usize, J>
where
    Grid<N>: Size,
{
    volume: &'a mut Volume<N>,
    mask: &'a Maps<N>,
    edit: &'a Edit<'a>,
    scratch: &'a mut EditScratch<N>,
    journal: &'a mut J,
    bounds: Bounds,
    report: EditReport,
    /// Whether any column grew.
    grew: bool,
}

impl<const N: usize, J: Journal<N>> Pass<'_, N, J>
where
    Grid<N>: Size,
{
    /// Flips layer after layer, each once no layer still to be computed reads it.
    fn flip_voxels(&mut self) {
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

    fn tighten_columns(&mut self) {
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
    fn close_holes(&mut self) {
        for y in self.bounds.lo[1]..=self.bounds.hi[1] {
            let Line { flipped, between, .. } = self.scratch.along_z[y];
            for z in voxels(between) {
                self.close_row(y, z, flipped & self.scratch.along_y[z].flipped);
            }
        }
    }

    /// Occupies what columns that grew brought into all three ranges.
    fn close_beams(&mut self) {
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
