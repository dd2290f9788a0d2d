//! Brushes: unions of convex pieces, rasterised row by row as voxel intervals in integer arithmetic.
//!
//! A voxel belongs to a brush if its centre is inside or on the boundary. Source: section 3 of the paper
//! (spherical and rectangular cutters), here swept along the tool's path.

mod capsule;
mod half_ball;
mod piece;
mod slab_rows;
mod swept_box;
mod swept_disc;

use glam::IVec3;
use heapless::Vec;

use crate::edit::pose::{Pose, SUBUNITS_PER_VOXEL};
use crate::limits::SWEEP_PIECES;
use crate::volume::range::Range;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

pub(crate) use capsule::Capsule;
pub use half_ball::HalfBall;
pub(crate) use piece::BrushLayer;
pub use piece::BrushPiece;
use slab_rows::SlabRows;
pub(crate) use swept_box::SweptBox;
use swept_disc::way_across_disc_subunits;
pub(crate) use swept_disc::{DiscShape, SweptDisc};

/// Axis-aligned bounding box of a brush in voxels, both ends included.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BrushBounds {
    /// First voxel along x, y, z.
    pub lo: [usize; 3],
    /// Last voxel along x, y, z.
    pub hi: [usize; 3],
}

/// The region that an edit changes: a union of convex pieces, stored in compact form. A voxel belongs to it
/// if its centre is inside or on the boundary.
///
/// Lengths and centres are in fixed point, [`SUBUNITS_PER_VOXEL`] to a voxel: `30 * SUBUNITS_PER_VOXEL` is 30
/// voxels, and the top face of the grid lies at y = `N * SUBUNITS_PER_VOXEL`. A [`Pose`] is in voxels.
///
/// Coordinates are clamped to 8,192 voxels from the grid's corner, negative radii and half extents to
/// 0. Products of two lengths then never overflow.
#[derive(Clone, Debug)]
pub struct Brush(BrushShape);

#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to box the larger on")]
enum BrushShape {
    One(BrushPiece),
    Sweep { shape: TurnedShape, from: Pose, to: Pose, sub_steps: usize },
}

/// The shape of a bit that has a rotation.
#[derive(Clone, Copy, Debug)]
enum TurnedShape {
    Box(IVec3),
    Disc(DiscShape),
}

impl TurnedShape {
    /// Returns the piece with the rotation of the pose `end`, swept from a start to that pose's position.
    fn piece(self, end: &Pose, start_subunits: IVec3) -> BrushPiece {
        match self {
            TurnedShape::Box(half) => BrushPiece::Box(SweptBox::new(half, end, start_subunits)),
            TurnedShape::Disc(disc) => BrushPiece::Disc(SweptDisc::new(disc, end, start_subunits)),
        }
    }
}

/// An interval of voxels of a brush in one row of a layer.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BrushRow {
    /// The row's z.
    pub z: usize,
    /// The voxels of the row.
    pub x_range: Range,
}

/// The computed pieces of a brush, a cache for many row queries.
#[derive(Debug)]
pub struct BrushPieces(Vec<BrushPiece, SWEEP_PIECES, u8>);

impl Brush {
    /// Creates a sphere.
    #[must_use]
    pub fn sphere(centre_subunits: IVec3, radius_subunits: i32) -> Self {
        BrushPiece::sphere(centre_subunits, radius_subunits).into()
    }

    /// Creates a sphere swept from `a` to `b`.
    #[must_use]
    pub fn capsule(a_subunits: IVec3, b_subunits: IVec3, radius_subunits: i32) -> Self {
        BrushPiece::capsule(a_subunits, b_subunits, radius_subunits).into()
    }

    /// Creates a box about a pose.
    #[must_use]
    pub fn oriented_box(half_extents_subunits: IVec3, pose: &Pose) -> Self {
        BrushPiece::oriented_box(half_extents_subunits, pose).into()
    }

    /// Creates a box swept from one pose to another. The rotation is divided into sub-steps in which no
    /// corner moves more than one voxel. Each piece is a box with the rotation of a sub-step's boundary,
    /// translated from half a sub-step before to half a sub-step after. There are at most [`SWEEP_PIECES`],
    /// enough for half a turn of the largest bit.
    #[must_use]
    pub fn swept_box(half_extents_subunits: IVec3, from: &Pose, to: &Pose) -> Self {
        let shape = TurnedShape::Box(half_extents_subunits);
        if from.unit_axes_q14() == to.unit_axes_q14() {
            return shape.piece(to, from.clamped_position_subunits()).into();
        }
        let corner = half_extents_subunits.as_vec3().length() / SUBUNITS_PER_VOXEL as f32;
        let turns = libm::ceilf(corner * from.angle_radians_to(to)) as usize;
        Self::sweep(shape, from, to, turns)
    }

    /// Creates a disc swept from one pose to another. It is divided like a swept box, and also so that no
    /// piece moves across its plane by more than a voxel.
    #[must_use]
    pub(crate) fn swept_disc(disc: DiscShape, from: &Pose, to: &Pose) -> Self {
        let across = way_across_disc_subunits(from, to)
            .cast_unsigned()
            .div_ceil(SUBUNITS_PER_VOXEL as u32) as usize;
        let shape = TurnedShape::Disc(disc);
        if across <= 1 && from.unit_axes_q14()[0] == to.unit_axes_q14()[0] {
            return shape.piece(to, from.clamped_position_subunits()).into();
        }
        let rim = isqrt(disc.radius_squared) as f32 / SUBUNITS_PER_VOXEL as f32;
        let turns = libm::ceilf(rim * from.angle_radians_to(to)) as usize;
        Self::sweep(shape, from, to, turns.max(across))
    }

    fn sweep(shape: TurnedShape, from: &Pose, to: &Pose, sub_steps: usize) -> Self {
        let sub_steps = sub_steps.clamp(1, SWEEP_PIECES - 1);
        Brush(BrushShape::Sweep { shape, from: *from, to: *to, sub_steps })
    }

    /// Returns its convex pieces, computed lazily; at most [`SWEEP_PIECES`].
    pub fn pieces(&self) -> impl ExactSizeIterator<Item = BrushPiece> + '_ {
        let last = match self.0 {
            BrushShape::One(_) => 0,
            BrushShape::Sweep { sub_steps, .. } => sub_steps,
        };
        (0..last + 1).map(|i| match &self.0 {
            BrushShape::One(piece) => *piece,
            BrushShape::Sweep { shape, from, to, sub_steps } => {
                let part = |halves: usize| halves as f32 / (2 * sub_steps) as f32;
                let at = |halves: usize| from.interpolate(to, part(halves));
                let start = at((2 * i).max(1) - 1);
                let start = if i == 0 { from } else { &start };
                let end = Pose { position: at(2 * i + 1).position, ..at(2 * i) };
                shape.piece(&end, start.clamped_position_subunits())
            }
        })
    }

    /// Returns the bounding box of its voxels in a grid `grid_side` voxels wide, or `None` if the brush lies
    /// outside.
    #[must_use]
    pub fn bounds(&self, grid_side: usize) -> Option<BrushBounds> {
        self.pieces().filter_map(|piece| piece.bounds(grid_side)).reduce(BrushBounds::union)
    }

    /// Returns the voxels of row (y, z). [`BrushPieces`] are faster for many rows of a sweep.
    #[must_use]
    #[inline]
    pub fn row_bits<const N: usize>(&self, y: usize, z: usize) -> <Grid<N> as Size>::Row
    where
        Grid<N>: Size,
    {
        self.pieces()
            .filter_map(|piece| piece.x_range(y, z, N))
            .fold(<Grid<N> as Size>::Row::EMPTY, |row, x_range| row | x_range.to_row())
    }
}

impl From<BrushPiece> for Brush {
    fn from(piece: BrushPiece) -> Self {
        Brush(BrushShape::One(piece))
    }
}

impl BrushBounds {
    fn union(self, other: Self) -> Self {
        BrushBounds {
            lo: core::array::from_fn(|i| self.lo[i].min(other.lo[i])),
            hi: core::array::from_fn(|i| self.hi[i].max(other.hi[i])),
        }
    }
}

impl BrushPieces {
    /// Creates an empty list of pieces. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the pieces about by value
    pub const fn new() -> Self {
        BrushPieces(Vec::new())
    }

    /// Computes the pieces of a brush. Returns its bounds in a grid `grid_side` voxels wide.
    pub fn set_brush(&mut self, brush: &Brush, grid_side: usize) -> Option<BrushBounds> {
        self.0.clear();
        for piece in brush.pieces() {
            // Cannot fail: no brush has more pieces.
            let _ = self.0.push(piece);
        }
        self.0.iter().filter_map(|piece| piece.bounds(grid_side)).reduce(BrushBounds::union)
    }

    /// Visits the intervals of voxels that make up layer `y` of a grid `grid_side` voxels wide, piece
    /// by piece.
    #[inline]
    pub fn visit_layer_rows(&self, y: usize, grid_side: usize, mut visit: impl FnMut(BrushRow)) {
        for piece in &self.0 {
            piece.layer(y).visit_rows(grid_side, |z, x_range| visit(BrushRow { z, x_range }));
        }
    }

    /// [`BrushPieces::visit_layer_rows`], but may skip intervals without a voxel of `layer`, the grid's rows
    /// of layer `y`. It skips an interval where looking at the row is cheaper than computing the interval.
    #[inline]
    pub(crate) fn visit_layer_rows_held<R: BitSet>(
        &self,
        y: usize,
        layer: &[R],
        mut visit: impl FnMut(BrushRow),
    ) {
        for piece in &self.0 {
            piece.layer(y).visit_rows_held(layer, |z, x_range| visit(BrushRow { z, x_range }));
        }
    }
}

/// The limit to which coordinates and lengths are clamped: 8,192 voxels in fixed point.
const FAR: i32 = 8192 * SUBUNITS_PER_VOXEL;

fn clamp_to_far(point_subunits: IVec3) -> IVec3 {
    point_subunits.clamp(IVec3::splat(-FAR), IVec3::splat(FAR))
}

/// Returns the fixed-point coordinate of the centre of voxel `i`.
#[must_use]
#[inline]
pub(crate) const fn voxel_centre_subunits(i: usize) -> i64 {
    i as i64 * SUBUNITS_PER_VOXEL as i64 + SUBUNITS_PER_VOXEL as i64 / 2
}

/// A closed interval along an axis, `lo..=hi`, in fixed point.
#[derive(Clone, Copy)]
struct SubunitInterval {
    lo: i64,
    hi: i64,
}

impl SubunitInterval {
    /// Creates the interval `centre - reach..=centre + reach`.
    #[inline]
    fn around(centre: i32, reach: i64) -> Self {
        SubunitInterval { lo: -reach, hi: reach }.shifted_by(centre)
    }

    #[inline]
    fn shifted_by(self, offset: i32) -> Self {
        let offset = i64::from(offset);
        SubunitInterval { lo: offset + self.lo, hi: offset + self.hi }
    }
}

/// Returns the voxels of a grid `grid_side` voxels wide whose centres lie in an interval.
#[inline]
fn voxels_with_centre_in(
    SubunitInterval { lo, hi }: SubunitInterval,
    grid_side: usize,
) -> Option<Range> {
    let sub = i64::from(SUBUNITS_PER_VOXEL);
    let first = (lo - sub / 2 + sub - 1).div_euclid(sub).max(0);
    let last = (hi - sub / 2).div_euclid(sub).min(grid_side as i64 - 1);
    // The order is known to be right, so the check in `Range::new` is skipped.
    (first <= last).then(|| Range::EMPTY.with_last(last as usize).with_first(first as usize))
}

/// Returns the integer part of a square root; 0 for negative numbers.
#[must_use]
#[inline]
pub fn isqrt(v: i64) -> i64 {
    // Below 2^52 a correctly rounded root never reaches the next integer.
    match v.max(0) {
        v if v < 1 << 52 => libm::sqrt(v as f64) as i64,
        v => v.isqrt(),
    }
}
