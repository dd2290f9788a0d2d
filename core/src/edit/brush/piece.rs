//! The convex pieces of a brush.

use glam::{I64Vec3, IVec3};

use super::swept_box::BoxLayer;
use super::{
    BrushBounds, Capsule, FAR, HalfBall, SubunitInterval, SweptBox, SweptDisc, clamp_to_far, isqrt,
    voxel_centre_subunits, voxels_with_centre_in,
};
use crate::edit::pose::Pose;
use crate::volume::range::Range;
use crate::volume::row::BitSet;

/// A convex part of a brush.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to box the larger on")]
pub enum BrushPiece {
    /// A swept sphere.
    Capsule(Capsule),
    /// A swept oriented box.
    Box(SweptBox),
    /// A swept disc.
    Disc(SweptDisc),
    /// Half a ball.
    HalfBall(HalfBall),
}

/// The slice of a piece at one y.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BrushLayer<'a>(LayerShape<'a>);

#[derive(Clone, Copy, Debug)]
enum LayerShape<'a> {
    Sphere(&'a Capsule, i64),
    Capsule(&'a Capsule, i64),
    Box(BoxLayer<'a>),
    Disc(&'a SweptDisc, i64),
    HalfBall(&'a HalfBall, i64),
}

impl BrushPiece {
    /// Creates a sphere.
    #[must_use]
    pub fn sphere(centre_subunits: IVec3, radius_subunits: i32) -> Self {
        Self::capsule(centre_subunits, centre_subunits, radius_subunits)
    }

    /// Creates a box about a pose.
    #[must_use]
    pub fn oriented_box(half_extents_subunits: IVec3, pose: &Pose) -> Self {
        BrushPiece::Box(SweptBox::new(
            half_extents_subunits,
            pose,
            pose.clamped_position_subunits(),
        ))
    }

    pub(super) fn capsule(a_subunits: IVec3, b_subunits: IVec3, radius_subunits: i32) -> Self {
        let radius = i64::from(radius_subunits.clamp(0, FAR));
        BrushPiece::Capsule(Capsule {
            a: clamp_to_far(a_subunits),
            b: clamp_to_far(b_subunits),
            radius_squared: radius * radius,
        })
    }

    /// Returns the bounding box of its voxels in a grid `grid_side` voxels wide, or `None` if the piece lies
    /// outside.
    #[must_use]
    pub fn bounds(&self, grid_side: usize) -> Option<BrushBounds> {
        let (lo, hi) = match self {
            BrushPiece::Capsule(c) | BrushPiece::HalfBall(HalfBall { ball: c, .. }) => {
                let r = I64Vec3::splat(isqrt(c.radius_squared));
                (c.a.min(c.b).as_i64vec3() - r, c.a.max(c.b).as_i64vec3() + r)
            }
            BrushPiece::Box(b) => {
                let middle = b.middle.div_euclid(IVec3::splat(2));
                ((middle - b.reach).as_i64vec3(), (middle + b.reach + IVec3::ONE).as_i64vec3())
            }
            BrushPiece::Disc(d) => return d.bounds(grid_side),
        };
        let mut bounds = BrushBounds { lo: [0; 3], hi: [0; 3] };
        for i in 0..3 {
            let inside = SubunitInterval { lo: lo[i], hi: hi[i] };
            let voxels = voxels_with_centre_in(inside, grid_side)?;
            (bounds.lo[i], bounds.hi[i]) = (voxels.first(), voxels.last());
        }
        Some(bounds)
    }

    /// Returns the bounding ball of a swept sphere, whose rows are faster to compute; `None` for other
    /// pieces.
    #[must_use]
    pub(crate) fn bounding_ball_of_capsule(&self) -> Option<BrushPiece> {
        match self {
            BrushPiece::Capsule(c) if c.a != c.b => {
                let path = (c.b - c.a).as_i64vec3();
                // Both roots and the middle are rounded down.
                let radius = isqrt(c.radius_squared) + isqrt(path.dot(path)) / 2 + 4;
                let middle = ((c.a.as_i64vec3() + c.b.as_i64vec3()) / 2).as_ivec3();
                let radius_squared = radius * radius;
                Some(BrushPiece::Capsule(Capsule { a: middle, b: middle, radius_squared }))
            }
            _ => None,
        }
    }

    /// Returns its slice at layer `y`, which shares work between the rows of the layer.
    #[must_use]
    #[inline]
    pub(crate) fn layer(&self, y: usize) -> BrushLayer<'_> {
        BrushLayer(match self {
            BrushPiece::Capsule(c) if c.a == c.b => LayerShape::Sphere(c, voxel_centre_subunits(y)),
            BrushPiece::Capsule(c) => LayerShape::Capsule(c, voxel_centre_subunits(y)),
            BrushPiece::Box(b) => LayerShape::Box(b.layer(voxel_centre_subunits(y))),
            BrushPiece::Disc(d) => LayerShape::Disc(d, voxel_centre_subunits(y)),
            BrushPiece::HalfBall(h) => LayerShape::HalfBall(h, voxel_centre_subunits(y)),
        })
    }

    /// Returns the interval of voxels of row (y, z) of a grid `grid_side` voxels wide whose centres are
    /// inside.
    #[must_use]
    #[inline]
    pub fn x_range(&self, y: usize, z: usize, grid_side: usize) -> Option<Range> {
        self.layer(y).x_range(z, grid_side)
    }
}

impl BrushLayer<'_> {
    /// Returns the z range of the rows of a grid `grid_side` voxels wide that may hold voxels of the slice.
    /// For round or tilted pieces it is smaller than the piece's bounds.
    #[must_use]
    #[inline]
    pub(crate) fn z_range(&self, grid_side: usize) -> Option<Range> {
        match &self.0 {
            LayerShape::Sphere(c, y) => c.sphere_z_range(*y, grid_side),
            LayerShape::Capsule(c, y) => c.z_range(*y, grid_side),
            LayerShape::Box(layer) => layer.z_range(grid_side),
            LayerShape::Disc(d, y) => d.z_range(*y, grid_side),
            LayerShape::HalfBall(h, y) => h.ball.sphere_z_range(*y, grid_side),
        }
    }

    /// Returns the interval of voxels of the row at `z` of a grid `grid_side` voxels wide whose centres are
    /// inside.
    #[must_use]
    #[inline]
    pub(crate) fn x_range(&self, z: usize, grid_side: usize) -> Option<Range> {
        match &self.0 {
            LayerShape::Sphere(c, y) => c.sphere_x_range(*y, voxel_centre_subunits(z), grid_side),
            LayerShape::Capsule(c, y) => c.x_range(*y, voxel_centre_subunits(z), grid_side),
            LayerShape::Box(layer) => {
                layer.x_range_among(voxel_centre_subunits(z), Range::new(0, grid_side - 1))
            }
            LayerShape::Disc(d, y) => d.x_range(*y, voxel_centre_subunits(z), grid_side),
            LayerShape::HalfBall(h, y) => h.x_range(*y, voxel_centre_subunits(z), grid_side),
        }
    }

    /// [`BrushLayer::x_range`], possibly clipped to the hull of the voxels `among`, if that is faster.
    #[must_use]
    #[inline]
    pub(crate) fn x_range_among<R: BitSet>(
        &self,
        z: usize,
        among: &R,
        grid_side: usize,
    ) -> Option<Range> {
        match &self.0 {
            LayerShape::Box(layer) => {
                let among = Range::new(among.first()?, among.last()?);
                layer.x_range_among(voxel_centre_subunits(z), among)
            }
            _ => self.x_range(z, grid_side),
        }
    }

    /// Visits each row of a grid `grid_side` voxels wide that holds voxels of the slice, with its z and the
    /// voxels.
    #[inline]
    pub(crate) fn visit_rows(&self, grid_side: usize, mut visit: impl FnMut(usize, Range)) {
        if let LayerShape::Disc(d, y) = &self.0 {
            return d.visit_rows(*y, grid_side, visit);
        }
        let Some(z_range) = self.z_range(grid_side) else {
            return;
        };
        for z in z_range.first()..z_range.last() + 1 {
            if let Some(x_range) = self.x_range(z, grid_side) {
                visit(z, x_range);
            }
        }
    }

    /// [`BrushLayer::visit_rows`], but may skip rows without a voxel of `layer`, the grid's rows at this y.
    /// It skips a row where looking at the row is cheaper than computing the interval.
    #[inline]
    pub(crate) fn visit_rows_held<R: BitSet>(
        &self,
        layer: &[R],
        mut visit: impl FnMut(usize, Range),
    ) {
        match &self.0 {
            LayerShape::Disc(d, y) if d.has_slab_rows() => d.visit_rows_held(*y, layer, visit),
            _ => self.visit_rows(layer.len(), &mut visit),
        }
    }
}
