//! Edit operations: change bit rows layer by layer, tighten the columns through them, then close.
//!
//! An edit is the exact boolean operation on voxels, then closure: the ranges become the tight
//! hulls of the result and the volume their intersection. Source: sections 3, 3.2 and 3.5 of the
//! paper; the closure rule is stated in [`crate`].

mod close;
mod flatten;
mod pass;
mod smooth;
mod tighten;
mod touch;

use pass::EditPass;
pub(crate) use touch::{brush_mirror_touches_volume, brush_touches_volume};

use crate::edit::brush::{Brush, BrushBounds, BrushPiece, BrushPieces};
use crate::edit::half_space::HalfSpace;
use crate::limits::{MAX_FLATTENING_REACH, SHELL_DEPTH, SMOOTH_LINES};
use crate::volume::box_sum::{BoxFilter, LINE_PLANES, Planes};
use crate::volume::editable::Volume;
use crate::volume::journal::Journal;
use crate::volume::range::Range;
use crate::volume::range_maps::RangeMaps;
use crate::volume::row::{BitRow, BitSet};
use crate::volume::size::{Grid, Size};
use crate::volume::voxel_box::VoxelBox;

/// A depth that holds nothing back: the edit takes or occupies its whole brush.
pub const ANY_DEPTH: usize = usize::MAX;

/// What an edit does to the voxels of its brush.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to box the largest on")]
pub enum EditOperation {
    /// Removes those at most `depth` six-neighbour steps from an empty voxel, as the volume stood
    /// when the edit began; outside the grid counts as empty. A greater depth counts as
    /// [`SHELL_DEPTH`], four, but for [`ANY_DEPTH`].
    ///
    /// To take out a whole brush, apply the edit again until it changes nothing: a ball of radius 30
    /// takes eight edits.
    Carve {
        /// Layers of the shell that may go.
        depth: usize,
    },
    /// Occupies those at most `depth` steps from the volume or from the ground under y = 0. A greater
    /// depth counts as [`SHELL_DEPTH`], but for [`ANY_DEPTH`].
    Fill {
        /// Layers that may be laid on.
        depth: usize,
    },
    /// Blur and threshold, which moves the surface by its mean curvature (Merriman, Bence and Osher 1992): each
    /// becomes occupied where more than half of the cube of (2 `radius` + 1)^3 voxels about it is. Below y = 0
    /// counts as occupied, elsewhere outside as empty.
    ///
    /// On voxels that alone stands still where the surface should move by less than half a voxel, which is nearly
    /// everywhere. A dither moves it by fractions in the mean.
    Smooth {
        /// How far it looks: 1, 3 or [`MAX_SMOOTHING_RADIUS`](crate::limits::MAX_SMOOTHING_RADIUS), 7; between
        /// them, as far as the lower.
        radius: usize,
        /// Where the threshold is dithered, if anywhere.
        dither: Option<Dither>,
    },
    /// Removes what is above a plane, and lays a layer on the floor of pits below it.
    ///
    /// A voxel that isn't above the plane becomes occupied if the next one beneath is, along the axis that the plane's
    /// normal is nearest to, and if along one of the other two axes voxels on both sides are, neither more than
    /// `reach` away. So neither what falls off beyond an edge is built on, nor a gap without a floor closed. Below
    /// y = 0 counts as occupied, elsewhere outside as empty.
    ///
    /// Voxels in the upper half of a mirrored edit's x are decided as their mirror images.
    Flatten {
        /// What is above the plane.
        above: HalfSpace,
        /// Half as wide as pits may be; at most
        /// [`MAX_FLATTENING_REACH`](crate::limits::MAX_FLATTENING_REACH).
        reach: usize,
    },
}

/// A dither of the threshold of smoothing. In a cube of side s, a voxel that more than `s^3 / 2 - s^2 / 2 + u`
/// of its cube's voxels let be occupied is, u uniform from 0 to s^2 - 1: a flat face along the axes stays.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Dither {
    /// The voxels with a dithered threshold. Those outside leave no grain behind.
    pub piece: BrushPiece,
    /// Decides u of every voxel; another for each edit.
    pub seed: u64,
}

impl EditOperation {
    /// How many voxels beyond the brush the operation reads.
    const fn neighbourhood_radius(self) -> usize {
        match self {
            _ if self.reaches_any_depth() => 0,
            EditOperation::Carve { depth } | EditOperation::Fill { depth }
                if depth > SHELL_DEPTH =>
            {
                SHELL_DEPTH
            }
            EditOperation::Carve { depth } | EditOperation::Fill { depth } => depth,
            EditOperation::Smooth { radius, .. } => BoxFilter::new(radius).radius(),
            EditOperation::Flatten { reach, .. } if reach > MAX_FLATTENING_REACH => {
                MAX_FLATTENING_REACH
            }
            EditOperation::Flatten { reach, .. } => reach,
        }
    }

    /// How many layers of flips are held back while others are computed.
    const fn flip_lag(self) -> usize {
        if self.keeps_rows() { 0 } else { self.neighbourhood_radius() }
    }

    /// Whether the edit remembers the rows of its brush as they were.
    const fn keeps_rows(self) -> bool {
        matches!(self, EditOperation::Smooth { .. } | EditOperation::Flatten { .. })
    }

    /// Whether no voxel of the brush lies too deep.
    const fn reaches_any_depth(self) -> bool {
        matches!(
            self,
            EditOperation::Carve { depth: ANY_DEPTH } | EditOperation::Fill { depth: ANY_DEPTH }
        )
    }

    const fn removes_voxels(self) -> bool {
        !matches!(self, EditOperation::Fill { .. })
    }

    const fn adds_voxels(self) -> bool {
        !matches!(self, EditOperation::Carve { .. })
    }
}

/// One edit.
#[derive(Clone, Copy, Debug)]
pub struct Edit<'a> {
    /// The voxels to change.
    pub brush: &'a Brush,
    /// The operation on them.
    pub operation: EditOperation,
    /// Whether the brush's voxel mirror (x to N - 1 - x) belongs to the brush.
    pub mirrored: bool,
}

/// The effect of an edit, in voxels.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct EditReport {
    /// Occupied before, empty after.
    pub removed: u32,
    /// Empty before, occupied by the operation itself: inside the brush and its depth.
    pub added: u32,
    /// Empty before, occupied by closure alone.
    pub closed: u32,
    /// Within the brush and its depth, and not removed because the mask holds them.
    pub refused_by_mask: u32,
    /// Within the brush, but neither carved nor filled because they lie more steps from the surface than
    /// the edit's depth. The next edit at the same place may reach them: this counts them once an edit,
    /// masked or not. Smoothing has no depth.
    pub refused_by_depth: u32,
    /// Removed, as the depth allowed, and brought back by closure.
    pub refused_by_closure: u32,
    /// The smallest box around what closure brought back, empty where that is nothing. That of a
    /// mirrored edit spans both sides.
    pub closure_box: VoxelBox,
    /// Ticks of the hand's way that were left uncut, since the bit fell too far behind it.
    pub dropped_ticks: u32,
}

impl EditReport {
    /// Whether the volume changed.
    #[must_use]
    pub const fn changed_volume(&self) -> bool {
        self.removed + self.added + self.closed != 0
    }

    /// Whether closure brought back more than is gone: the volume can't take the shape that was cut.
    #[must_use]
    pub const fn is_mostly_refused_by_closure(&self) -> bool {
        self.refused_by_closure > self.removed
    }

    /// The counts of two edits together, and the box around both of theirs.
    #[must_use]
    pub const fn sum_with(self, other: Self) -> Self {
        EditReport {
            removed: self.removed + other.removed,
            added: self.added + other.added,
            closed: self.closed + other.closed,
            refused_by_mask: self.refused_by_mask + other.refused_by_mask,
            refused_by_depth: self.refused_by_depth + other.refused_by_depth,
            refused_by_closure: self.refused_by_closure + other.refused_by_closure,
            closure_box: self.closure_box.hull_with(other.closure_box),
            dropped_ticks: self.dropped_ticks + other.dropped_ticks,
        }
    }
}

/// An edit that smooths or flattens touches more rows than [`SMOOTH_LINES`] lines of N; nothing was changed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BrushTooLarge;

/// Working memory of an edit: rows whose flips are delayed while later layers read the volume as it was,
/// and the columns touched. Of each row only the words that the edit reads are stored.
#[derive(Debug)]
pub struct EditScratch<const N: usize>
where
    Grid<N>: Size,
{
    pieces: BrushPieces,
    /// Voxels to flip, of the last layers computed, by y modulo the length.
    pending: [[<Grid<N> as Size>::Row; N]; SHELL_DEPTH + 1],
    /// The rows of the brush as they were, of an edit that smooths or flattens.
    rows_before: [[<Grid<N> as Size>::Row; N]; SMOOTH_LINES],
    /// Columns along y, by z.
    along_y: [LineFlips<<Grid<N> as Size>::Row>; N],
    /// Columns along z, by y.
    along_z: [LineFlips<<Grid<N> as Size>::Row>; N],
    /// Columns along x that grew, by y.
    grown_x: [<Grid<N> as Size>::Row; N],
    /// What smoothing counts along y about the voxels of a layer, by z.
    counts_along_y: [Planes<<Grid<N> as Size>::Row, LINE_PLANES>; N],
}

/// The columns of a line of N that an edit touched; bit x is a column.
#[derive(Clone, Copy, Debug)]
struct LineFlips<R> {
    /// Columns that voxels were flipped in.
    flipped: R,
    /// Along the columns, from the first flipped voxel to the last.
    between: Range,
    /// Columns that grew.
    grown: R,
    /// An interval that covers their growth.
    growth: Range,
}

impl<R: BitSet> LineFlips<R> {
    const UNTOUCHED: Self = LineFlips {
        flipped: R::EMPTY,
        between: Range::EMPTY,
        grown: R::EMPTY,
        growth: Range::EMPTY,
    };

    /// Notes flips at a position along the columns. Positions must come in ascending order.
    #[inline]
    fn note_flips<const W: usize>(&mut self, columns: BitRow<W>, position: usize) {
        self.flipped.set_word_span(0, self.flipped.word_span(0) | columns);
        self.between = self.between.extended_to(position);
    }
}

impl<const N: usize> EditScratch<N>
where
    Grid<N>: Size,
{
    /// For a `static`, as [`World::new`](crate::World::new). The content between edits is meaningless.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the rows about by value
    pub const fn new() -> Self {
        let line = [<Grid<N> as Size>::Row::EMPTY; N];
        EditScratch {
            pieces: BrushPieces::new(),
            pending: [line; SHELL_DEPTH + 1],
            rows_before: [line; SMOOTH_LINES],
            along_y: [LineFlips::UNTOUCHED; N],
            along_z: [LineFlips::UNTOUCHED; N],
            grown_x: line,
            counts_along_y: [[<Grid<N> as Size>::Row::EMPTY; LINE_PLANES]; N],
        }
    }

    /// Marks the lines within the bounds as untouched. Delayed rows are written before they are read.
    fn reset_lines(&mut self, BrushBounds { lo, hi }: BrushBounds) {
        self.along_y[lo[2]..=hi[2]].fill(LineFlips::UNTOUCHED);
        self.along_z[lo[1]..=hi[1]].fill(LineFlips::UNTOUCHED);
        self.grown_x[lo[1]..=hi[1]].fill(<Grid<N> as Size>::Row::EMPTY);
    }
}

/// Applies an edit to a volume.
///
/// `mask` holds the voxels that no edit removes, the hidden figure of the constrained mode; it is a part
/// of the volume, and `RangeMaps::new()` where there is none. `journal` is told of every change: `&mut ()`
/// for nobody, a [`DirtyRects`](crate::volume::DirtyRects) for the rectangles that a renderer uploads.
///
/// ```
/// use std::sync::Mutex;
/// use paros_core::glam::IVec3;
/// use paros_core::edit::{EditOperation, EditScratch, SUBUNITS_PER_VOXEL as VOXEL};
/// use paros_core::{Brush, Edit, RangeMaps, Volume, apply_edit};
///
/// static VOLUME: Mutex<Volume<64>> = Mutex::new(Volume::new());
/// static SCRATCH: Mutex<EditScratch<64>> = Mutex::new(EditScratch::new());
/// let (mut volume, mut scratch) = (VOLUME.lock().unwrap(), SCRATCH.lock().unwrap());
/// let (mut block, no_mask) = (RangeMaps::new(), RangeMaps::new());
/// block.fill_block();
/// volume.set_maps(&block);
///
/// // A hollow of 12 voxels radius in the middle of the top.
/// let brush = Brush::sphere(IVec3::new(32, 64, 32) * VOXEL, 12 * VOXEL);
/// let edit = Edit { brush: &brush, operation: EditOperation::Carve { depth: 4 }, mirrored: false };
/// // An edit goes four voxels deep at most: repeat it until nothing changes.
/// while apply_edit(&mut volume, &no_mask, &edit, &mut scratch, &mut ()).unwrap().changed_volume() {}
/// assert!(!volume.maps().contains([32, 53, 32]) && volume.maps().contains([32, 51, 32]));
/// ```
///
/// To print it: [`Exporter::advance_export`](crate::Exporter::advance_export) with `volume.rows()` and
/// `&no_mask`, as on the first page.
///
/// # Errors
/// [`BrushTooLarge`] for a brush that smooths or flattens, of more rows than there is room to remember.
pub fn apply_edit<const N: usize, const K: usize>(
    volume: &mut Volume<N, K>,
    mask: &RangeMaps<N, K>,
    edit: &Edit<'_>,
    scratch: &mut EditScratch<N>,
    journal: &mut dyn Journal<N, K>,
) -> Result<EditReport, BrushTooLarge>
where
    Grid<N>: Size,
{
    let Some(bounds) = scratch.pieces.set_brush(edit.brush, N) else {
        return Ok(EditReport::default());
    };
    let rows = (bounds.hi[1] - bounds.lo[1] + 1) * (bounds.hi[2] - bounds.lo[2] + 1);
    if edit.operation.keeps_rows() && rows > SMOOTH_LINES * N {
        return Err(BrushTooLarge);
    }
    let WordWindow { first_word, word_count } = find_word_window::<N>(edit, bounds);
    let report = EditReport::default();
    macro_rules! run_pass {
        ($words:literal, $first_word:expr) => {
            EditPass::<N, K, $words> {
                volume,
                mask,
                edit,
                scratch,
                journal,
                bounds,
                first_word: $first_word,
                report,
            }
            .run()
        };
    }
    // A grid's rows have a word for each 64 voxels: no pass is compiled that reads more.
    Ok(match word_count {
        2 if const { N > 64 } => run_pass!(2, first_word),
        3.. if const { N > 128 } => run_pass!(4, 0),
        _ => run_pass!(1, first_word),
    })
}

/// Some words of every row.
struct WordWindow {
    first_word: usize,
    word_count: usize,
}

/// The words of a row that an edit reads.
fn find_word_window<const N: usize>(
    edit: &Edit<'_>,
    BrushBounds { lo, hi }: BrushBounds,
) -> WordWindow {
    let (mut lo, mut hi) = (lo[0], hi[0]);
    if edit.mirrored {
        (lo, hi) = (lo.min(N - 1 - hi), hi.max(N - 1 - lo));
    }
    let reach = edit.operation.neighbourhood_radius();
    let (first, last) = (lo.saturating_sub(reach) / 64, (hi + reach).min(N - 1) / 64);
    WordWindow { first_word: first, word_count: last - first + 1 }
}
