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

/// Unlimited depth: the edit removes or occupies its whole brush.
pub const ANY_DEPTH: usize = usize::MAX;

/// The effect of an edit on the voxels of its brush.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to box the largest on")]
pub enum EditOperation {
    /// Removes voxels at most `depth` six-neighbour steps from an empty voxel of the volume at the start of
    /// the edit; outside the grid counts as empty. A greater depth counts as [`SHELL_DEPTH`], four, except
    /// [`ANY_DEPTH`].
    ///
    /// To remove a whole brush, apply the edit again until it changes nothing: a ball of radius 30 takes
    /// eight edits.
    Carve {
        /// Number of layers that may be removed.
        depth: usize,
    },
    /// Occupies voxels at most `depth` steps from the volume or from the ground under y = 0. A greater depth
    /// counts as [`SHELL_DEPTH`], except [`ANY_DEPTH`].
    Fill {
        /// Number of layers that may be added.
        depth: usize,
    },
    /// Blur and threshold, which moves the surface by its mean curvature (Merriman, Bence and Osher 1992): a
    /// voxel becomes occupied if more than half of the cube of (2 `radius` + 1)^3 voxels about it is. The
    /// ground below y = 0 counts as occupied, everything else outside as empty.
    ///
    /// On a voxel grid the plain rule doesn't move a surface that should move by less than half a voxel,
    /// which is nearly everywhere. A dither moves it by fractions on average.
    Smooth {
        /// Radius of the blur: 1, 3 or [`MAX_SMOOTHING_RADIUS`](crate::limits::MAX_SMOOTHING_RADIUS), 7.
        /// Other values are rounded down to one of them.
        radius: usize,
        /// The region with a dithered threshold, if any.
        dither: Option<Dither>,
    },
    /// Removes voxels above a plane, and adds a layer to the floor of pits below it.
    ///
    /// A voxel that isn't above the plane becomes occupied if two conditions hold. Its neighbour beneath is
    /// occupied, along the axis nearest to the plane's normal. And along one of the other two axes there are
    /// occupied voxels on both sides, at most `reach` away. So the edit neither builds out beyond an edge nor
    /// closes a gap without a floor. The ground below y = 0 counts as occupied, everything else outside as
    /// empty.
    ///
    /// In a mirrored edit, voxels in the upper half of x are decided as their mirror images.
    Flatten {
        /// The half-space above the plane.
        above: HalfSpace,
        /// Half the maximum width of a pit; at most
        /// [`MAX_FLATTENING_REACH`](crate::limits::MAX_FLATTENING_REACH).
        reach: usize,
    },
}

/// A dither of the threshold of smoothing. In a cube of side s, a voxel becomes occupied if more than `s^3 /
/// 2 - s^2 / 2 + u` of the cube's voxels are, with u uniform from 0 to s^2 - 1. A flat face along the axes
/// doesn't move.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Dither {
    /// The region with a dithered threshold. Voxels outside it are left without grain.
    pub piece: BrushPiece,
    /// Seed of the random number u of every voxel; use a different one for each edit.
    pub seed: u64,
}

impl EditOperation {
    /// Returns how many voxels beyond the brush the operation reads.
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

    /// Returns how many layers of flips are held back while later layers are computed.
    const fn flip_lag(self) -> usize {
        if self.keeps_rows() { 0 } else { self.neighbourhood_radius() }
    }

    /// Returns `true` if the edit stores the original rows of its brush.
    const fn keeps_rows(self) -> bool {
        matches!(self, EditOperation::Smooth { .. } | EditOperation::Flatten { .. })
    }

    /// Returns `true` if the depth is unlimited.
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
    /// `true` if the brush includes its mirror image (x to N - 1 - x).
    pub mirrored: bool,
}

/// The effect of an edit, in voxels.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct EditReport {
    /// Voxels that were occupied and are empty now.
    pub removed: u32,
    /// Voxels that the operation itself occupied: inside the brush and within its depth.
    pub added: u32,
    /// Voxels that only closure occupied.
    pub closed: u32,
    /// Voxels within the brush and its depth that weren't removed because they belong to the mask.
    pub refused_by_mask: u32,
    /// Voxels within the brush that were neither carved nor filled because they are farther from the surface
    /// than the edit's depth. The next edit at the same place may reach them, so they are counted in each
    /// edit, masked or not. Smoothing has no depth.
    pub refused_by_depth: u32,
    /// Voxels that were removed and then restored by closure.
    pub refused_by_closure: u32,
    /// The smallest box around the voxels that closure restored; empty if there are none. For a mirrored edit
    /// it spans both sides.
    pub closure_box: VoxelBox,
    /// Ticks of the hand's trail that were dropped uncut because the bit fell too far behind.
    pub dropped_ticks: u32,
}

impl EditReport {
    /// Returns `true` if the volume changed.
    #[must_use]
    pub const fn changed_volume(&self) -> bool {
        self.removed + self.added + self.closed != 0
    }

    /// Returns `true` if closure restored more voxels than were removed: the volume can't represent the shape
    /// that was cut.
    #[must_use]
    pub const fn is_mostly_refused_by_closure(&self) -> bool {
        self.refused_by_closure > self.removed
    }

    /// Returns the sum of the counts of two edits, and the hull of their boxes.
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

/// A smoothing or flattening edit touches more rows than [`SMOOTH_LINES`] lines of N. Nothing was changed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BrushTooLarge;

/// Working memory of an edit: rows with delayed flips, so that later layers read the original volume, and the
/// touched columns. Of each row only the words that the edit reads are stored.
#[derive(Debug)]
pub struct EditScratch<const N: usize>
where
    Grid<N>: Size,
{
    pieces: BrushPieces,
    /// Voxels to flip in the last layers computed, by y modulo the length.
    pending: [[<Grid<N> as Size>::Row; N]; SHELL_DEPTH + 1],
    /// The original rows of the brush, for an edit that smooths or flattens.
    rows_before: [[<Grid<N> as Size>::Row; N]; SMOOTH_LINES],
    /// Columns along y, by z.
    along_y: [LineFlips<<Grid<N> as Size>::Row>; N],
    /// Columns along z, by y.
    along_z: [LineFlips<<Grid<N> as Size>::Row>; N],
    /// Columns along x that grew, by y.
    grown_x: [<Grid<N> as Size>::Row; N],
    /// Smoothing: the counts along y about the voxels of a layer, by z.
    counts_along_y: [Planes<<Grid<N> as Size>::Row, LINE_PLANES>; N],
}

/// The columns of a line of N that an edit touched; bit x is a column.
#[derive(Clone, Copy, Debug)]
struct LineFlips<R> {
    /// Columns in which voxels were flipped.
    flipped: R,
    /// The range along the columns from the first flipped voxel to the last.
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
    /// Creates a scratch for a `static`, as [`World::new`](crate::World::new). Its content between edits is
    /// undefined.
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

    /// Marks the lines within the bounds as untouched. Delayed rows needn't be cleared, as they are written
    /// before they are read.
    fn reset_lines(&mut self, BrushBounds { lo, hi }: BrushBounds) {
        self.along_y[lo[2]..=hi[2]].fill(LineFlips::UNTOUCHED);
        self.along_z[lo[1]..=hi[1]].fill(LineFlips::UNTOUCHED);
        self.grown_x[lo[1]..=hi[1]].fill(<Grid<N> as Size>::Row::EMPTY);
    }
}

/// Applies an edit to a volume.
///
/// `mask` holds the voxels that no edit removes, the hidden figure of the constrained mode. It must be part
/// of the volume; pass `RangeMaps::new()` for no mask. `journal` receives every change: pass `&mut ()` to
/// ignore them, or a [`DirtyRects`](crate::volume::DirtyRects) for the rectangles that a renderer uploads.
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
/// To print the volume, call [`Exporter::advance_export`](crate::Exporter::advance_export) with
/// `volume.rows()` and `&no_mask`, as in the example at the crate's root.
///
/// # Errors
/// [`BrushTooLarge`] if a smoothing or flattening brush covers more rows than can be stored.
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
    // A row has a word for each 64 voxels, so wider passes aren't compiled for small grids.
    Ok(match word_count {
        2 if const { N > 64 } => run_pass!(2, first_word),
        3.. if const { N > 128 } => run_pass!(4, 0),
        _ => run_pass!(1, first_word),
    })
}

/// A window of words, the same in every row.
struct WordWindow {
    first_word: usize,
    word_count: usize,
}

/// Returns the words of a row that an edit reads.
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
