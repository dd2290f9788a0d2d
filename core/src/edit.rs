//! Edits: change bit rows layer by layer, re-tighten the columns through them, then close.
//!
//! An edit is the exact boolean operation on voxels, then closure: the ranges become the tight
//! hulls of the result and the volume their intersection. Source: sections 3, 3.2 and 3.5 of the
//! paper; the closure rule is stated in [`crate`].

use crate::brush::{Bounds, Brush};
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
    /// Inside the brush; empty before, occupied after.
    pub added: u32,
    /// Occupied by closure alone; empty before.
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

/// Rows held back while an edit reads the volume as it stood at the start.
#[derive(Debug)]
pub struct EditScratch<const N: usize>
where
    Grid<N>: Size,
{
    /// Voxels to flip, of the last layers computed, by y modulo the length.
    pending: [[<Grid<N> as Size>::Row; N]; SHELL_DEPTH + 1],
    /// The rows of a smoothing edit's bounds as they were.
    start: [[<Grid<N> as Size>::Row; N]; SMOOTH_LINES],
    /// Columns along y that voxels were flipped in: bit x of row z.
    along_y: [<Grid<N> as Size>::Row; N],
    /// Columns along z that voxels were flipped in: bit x of row y.
    along_z: [<Grid<N> as Size>::Row; N],
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
            pending: [line; SHELL_DEPTH + 1],
            start: [line; SMOOTH_LINES],
            along_y: line,
            along_z: line,
        }
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
    let Some(bounds) = edit.brush.bounds(N) else {
        return Ok(EditReport::default());
    };
    let rows = (bounds.hi[1] - bounds.lo[1] + 1) * (bounds.hi[2] - bounds.lo[2] + 1);
    if edit.operation == Operation::Smooth && rows > SMOOTH_LINES * N {
        return Err(BrushTooLarge);
    }
    scratch.along_y[bounds.lo[2]..=bounds.hi[2]].fill(<Grid<N> as Size>::Row::EMPTY);
    scratch.along_z[bounds.lo[1]..=bounds.hi[1]].fill(<Grid<N> as Size>::Row::EMPTY);
    let report = EditReport::default();
    let mut pass =
        Pass { volume, mask, edit, scratch, journal, bounds, report, grew: [Range::EMPTY; 3] };
    pass.flip_voxels();
    pass.tighten_columns();
    pass.close();
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
    /// For each axis, the hull of the stretches by which columns grew.
    grew: [Range; 3],
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
        let (first, last) = (self.bounds.lo[1], self.bounds.hi[1]);
        for y in first..=last + lag {
            if y <= last {
                for z in self.bounds.lo[2]..=self.bounds.hi[2] {
                    self.scratch.pending[y % (SHELL_DEPTH + 1)][z] = self.flips(y, z);
                }
            }
            if y >= first + lag {
                self.flip_layer(y - lag);
            }
        }
    }

    /// The voxels of row (y, z) that the edit flips, before closure.
    fn flips(&mut self, y: usize, z: usize) -> <Grid<N> as Size>::Row {
        let mut brush = self.edit.brush.row::<N>(y, z);
        if self.edit.mirrored {
            brush |= brush.mirrored(N);
        }
        if brush.is_empty() && self.edit.operation != Operation::Smooth {
            return brush;
        }
        let rows = self.volume.rows();
        let here = rows.row(y, z);
        match self.edit.operation {
            Operation::Carve { depth } => {
                let wanted = brush & here;
                let deep = deep(rows, (y, z), depth.min(SHELL_DEPTH), wanted);
                self.report.refused_by_depth += deep.count();
                self.spare_mask(y, z, wanted & !deep)
            }
            Operation::Fill { depth } => {
                let wanted = brush & !here;
                let near = near(rows, (y, z), depth.min(SHELL_DEPTH), wanted);
                self.report.refused_by_depth += (wanted & !near).count();
                near
            }
            Operation::Smooth => {
                let index = self.start_index(y, z);
                self.scratch.start.as_flattened_mut()[index] = here;
                let most = majority(rows, (y, z));
                let filled = brush & most & !here;
                self.spare_mask(y, z, brush & here & !most) | filled
            }
        }
    }

    /// Of the voxels to be removed, those the mask doesn't hold.
    fn spare_mask(
        &mut self,
        y: usize,
        z: usize,
        removed: <Grid<N> as Size>::Row,
    ) -> <Grid<N> as Size>::Row {
        let held = self.mask.row_among((y, z), removed);
        self.report.refused_by_mask += held.count();
        removed & !held
    }

    fn flip_layer(&mut self, y: usize) {
        for z in self.bounds.lo[2]..=self.bounds.hi[2] {
            let flips = self.scratch.pending[y % (SHELL_DEPTH + 1)][z];
            if flips.is_empty() {
                continue;
            }
            let here = self.volume.rows().row(y, z);
            let (removed, added) = (flips & here, flips & !here);
            self.report.removed += removed.count();
            self.report.added += added.count();
            if !added.is_empty() {
                self.journal.added((y, z), added);
            }
            *self.volume.rows_mut().row_mut(y, z) = here ^ flips;
            self.scratch.along_y[z] |= flips;
            self.scratch.along_z[y] |= flips;
            self.replace(Axis::X, (y, z), Range::hull(here ^ flips));
        }
    }

    fn tighten_columns(&mut self) {
        for z in self.bounds.lo[2]..=self.bounds.hi[2] {
            let between = (self.bounds.lo[1], self.bounds.hi[1]);
            self.tighten_line(Axis::Y, z, self.scratch.along_y[z], between);
        }
        for y in self.bounds.lo[1]..=self.bounds.hi[1] {
            let between = (self.bounds.lo[2], self.bounds.hi[2]);
            self.tighten_line(Axis::Z, y, self.scratch.along_z[y], between);
        }
    }

    /// Re-tightens the columns `flipped` of a line, whose voxels changed only at `from..=to`. An
    /// end outside that stretch stands; the others are looked for, N columns at a time.
    fn tighten_line(
        &mut self,
        axis: Axis,
        line: usize,
        flipped: <Grid<N> as Size>::Row,
        (from, to): (usize, usize),
    ) {
        if flipped.is_empty() {
            return;
        }
        let (mut lo, mut hi) = ([0u8; N], [0u8; N]);
        let (mut seek_lo, mut seek_hi) = (flipped, flipped);
        for x in flipped.ones() {
            let old = self.volume.maps().column(axis, (line, x)).hull();
            if old.lo() < from {
                lo[x] = old.lo() as u8;
                seek_lo.toggle(x);
            }
            if old.hi() > to {
                hi[x] = old.hi() as u8;
                seek_hi.toggle(x);
            }
        }
        seek(self.volume.rows(), axis, line, seek_hi, (0..=to).rev(), &mut hi);
        let empty = seek(self.volume.rows(), axis, line, seek_lo, from..N, &mut lo);
        for x in flipped.ones() {
            let range = match empty.contains(x) {
                true => Range::EMPTY,
                false => Range::new(lo[x].into(), hi[x].into()),
            };
            self.replace(axis, (line, x), range);
        }
    }

    /// Replaces a column and remembers by which stretch it grew.
    fn replace(&mut self, axis: Axis, at: (usize, usize), range: Range) {
        let old = self.volume.maps().column(axis, at).hull();
        if range == old {
            return;
        }
        let grew = &mut self.grew[axis as usize];
        if !range.is_empty() {
            if range.lo() < old.lo() {
                *grew = grew.hull_with(Range::new(range.lo(), range.hi().min(old.lo())));
            }
            if range.hi() > old.hi() {
                *grew = grew.hull_with(Range::new(range.lo().max(old.hi()), range.hi()));
            }
        }
        self.volume.set_column(axis, at, Column([range]), self.journal);
    }

    /// Occupies what all three ranges hold. What an edit leaves in the intersection lies within
    /// its bounds, or in a column that grew.
    fn close(&mut self) {
        let Bounds { lo, hi } = self.bounds;
        let mut window = <Grid<N> as Size>::Row::span(lo[0], hi[0]);
        if self.edit.mirrored {
            window |= window.mirrored(N);
        }
        if !self.grew[0].is_empty() {
            window = Grid::<N>::FULL;
        }
        for y in lo[1]..=hi[1] {
            for z in lo[2]..=hi[2] {
                self.close_row(y, z, window);
            }
        }
        for y in beyond(self.grew[1], lo[1], hi[1]) {
            for z in lo[2]..=hi[2] {
                self.close_row(y, z, self.scratch.along_y[z]);
            }
        }
        for y in lo[1]..=hi[1] {
            for z in beyond(self.grew[2], lo[2], hi[2]) {
                self.close_row(y, z, self.scratch.along_z[y]);
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
    /// nothing, so all that comes back was there; a fill removes nothing, so none was.
    fn at_start(&self, y: usize, z: usize) -> <Grid<N> as Size>::Row {
        let Bounds { lo, hi } = self.bounds;
        match self.edit.operation {
            Operation::Carve { .. } => Grid::<N>::FULL,
            Operation::Smooth
                if (lo[1]..=hi[1]).contains(&y) && (lo[2]..=hi[2]).contains(&z) =>
            {
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
        for x in found.ones() {
            found_at[x] = i as u8;
        }
        sought &= !found;
    }
    sought
}

/// The voxels of a range that are not in `lo..=hi`.
fn beyond(range: Range, lo: usize, hi: usize) -> impl Iterator<Item = usize> {
    (range.lo()..=range.hi()).filter(move |i| !(lo..=hi).contains(i))
}
