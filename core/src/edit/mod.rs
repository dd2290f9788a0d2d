//! Edits: change bit rows layer by layer, re-tighten the columns through them, then close.
//!
//! An edit is the exact boolean operation on voxels, then closure: the ranges become the tight
//! hulls of the result and the volume their intersection. Source: sections 3, 3.2 and 3.5 of the
//! paper; the closure rule is stated in [`crate`].

mod pass;

use pass::Pass;

use crate::brush::{Bounds, Brush, Pieces};
use crate::limits::{SHELL_DEPTH, SMOOTH_LINES};
use crate::maps::{Maps, Range};
use crate::row::Bits;
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
