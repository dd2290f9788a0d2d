//! Edits: change bit rows layer by layer, re-tighten the columns through them, then close.
//!
//! An edit is the exact boolean operation on voxels, then closure: the ranges become the tight
//! hulls of the result and the volume their intersection. Source: sections 3, 3.2 and 3.5 of the
//! paper; the closure rule is stated in [`crate`].

mod close;
mod pass;
mod tighten;

use pass::Pass;

use crate::brush::{Bounds, Brush, Pieces};
use crate::limits::{SHELL_DEPTH, SMOOTH_LINES};
use crate::maps::{Maps, Range};
use crate::row::{Bits, Row};
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

impl Operation {
    /// How many voxels beyond the brush it looks.
    const fn reach(self) -> usize {
        match self {
            Operation::Carve { depth } | Operation::Fill { depth } if depth > SHELL_DEPTH => {
                SHELL_DEPTH
            }
            Operation::Carve { depth } | Operation::Fill { depth } => depth,
            Operation::Smooth => 1,
        }
    }

    const fn removes(self) -> bool {
        !matches!(self, Operation::Fill { .. })
    }

    const fn adds(self) -> bool {
        !matches!(self, Operation::Carve { .. })
    }
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

/// Rows held back while an edit reads the volume as it stood at the start, and what it touched. Of
/// a row, only the words that the edit is about, from its first word on.
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

    /// Voxels were flipped; places only go up.
    #[inline]
    fn flip<const W: usize>(&mut self, columns: Row<W>, place: usize) {
        self.flipped.set_part(0, self.flipped.part(0) | columns);
        self.between = self.between.up_to(place);
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

    /// Nothing was touched yet. Rows held back are written before they are read.
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
    let (first, words) = words_read::<N>(edit, bounds);
    let report = EditReport::default();
    Ok(match words {
        1 => Pass::<N, 1, J> { volume, mask, edit, scratch, journal, bounds, first, report }.run(),
        2 => Pass::<N, 2, J> { volume, mask, edit, scratch, journal, bounds, first, report }.run(),
        _ => {
            Pass::<N, 4, J> { volume, mask, edit, scratch, journal, bounds, first: 0, report }.run()
        }
    })
}

/// The words of a row that an edit reads: the first, and how many.
fn words_read<const N: usize>(edit: &Edit<'_>, Bounds { lo, hi }: Bounds) -> (usize, usize) {
    let (mut lo, mut hi) = (lo[0], hi[0]);
    if edit.mirrored {
        (lo, hi) = (lo.min(N - 1 - hi), hi.max(N - 1 - lo));
    }
    let reach = edit.operation.reach();
    let (first, last) = (lo.saturating_sub(reach) / 64, (hi + reach).min(N - 1) / 64);
    (first, last - first + 1)
}
