//! A bit's shape on a grid in fixed point, its offset shapes by depth, and its swept volumes.

use glam::{I64Vec3, IVec3};

use crate::edit::brush::{Brush, BrushPiece, Capsule, SweptBox, isqrt};
use crate::edit::pose::{FIXED_ONE, Pose, SUBUNITS_PER_VOXEL};

/// A bit's shape and bite on a given grid, in fixed point ([`SUBUNITS_PER_VOXEL`]).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct GridBit {
    /// The shape.
    pub shape: GridShape,
    /// Its greatest penetration into the material.
    pub bite: i32,
}

/// A shape in fixed point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum GridShape {
    /// A ball of a radius.
    Ball(i32),
    /// A box of half extents.
    Box(IVec3),
}

/// Upper bound, in fixed point, of how far rounding moves a step's pose off the path.
const ROUNDING: i32 = SUBUNITS_PER_VOXEL / 16;

impl GridBit {
    /// The shell depth of an edit: the bite in voxels, rounded up.
    #[must_use]
    pub fn bite_depth_voxels(&self) -> usize {
        (self.bite + SUBUNITS_PER_VOXEL - 1).div_euclid(SUBUNITS_PER_VOXEL).max(0) as usize
    }

    /// Radius of the largest ball inside the shape.
    #[must_use]
    pub fn inscribed_radius_subunits(&self) -> i32 {
        match self.shape {
            GridShape::Ball(radius) => radius,
            GridShape::Box(half) => half.min_element(),
        }
    }

    /// Radius of the smallest ball about its centre that holds the shape.
    #[must_use]
    pub fn circumscribed_radius_subunits(&self) -> i32 {
        match self.shape {
            GridShape::Ball(radius) => radius,
            GridShape::Box(half) => libm::ceilf(half.as_vec3().length()) as i32,
        }
    }

    /// The bit without a rim, if anything is left of it.
    #[must_use]
    pub(crate) fn shrunk_by(&self, rim_subunits: i32) -> Option<GridBit> {
        let shape = match self.shape {
            GridShape::Ball(radius) => GridShape::Ball(radius - rim_subunits),
            GridShape::Box(half) => GridShape::Box(half - IVec3::splat(rim_subunits)),
        };
        let shrunk = GridBit { shape, ..*self };
        (shrunk.inscribed_radius_subunits() > 0).then_some(shrunk)
    }

    /// Offset shape: the points deeper inside the bit than a depth. A negative depth enlarges the bit
    /// by its faces or radius. `None` if no point is that deep.
    #[must_use]
    pub(crate) fn piece_deeper_than(&self, depth_subunits: i32, pose: &Pose) -> Option<BrushPiece> {
        match self.shape {
            GridShape::Ball(radius) => {
                let left = i64::from(radius - depth_subunits);
                let a = pose.clamped_position_subunits();
                let capsule = Capsule { a, b: a, radius_squared: left * left - 1 };
                (left > 0).then_some(BrushPiece::Capsule(capsule))
            }
            GridShape::Box(half) => {
                let left = half - IVec3::splat(depth_subunits);
                if left.min_element() <= 0 {
                    return None;
                }
                let mut piece = SweptBox::new(left, pose, pose.clamped_position_subunits());
                for (_, extent) in &mut piece.planes[..3] {
                    *extent -= 1;
                }
                Some(BrushPiece::Box(piece))
            }
        }
    }

    /// The bit itself at a pose, boundary included.
    #[must_use]
    pub fn piece_at(&self, pose: &Pose) -> BrushPiece {
        match self.shape {
            GridShape::Ball(radius) => BrushPiece::sphere(pose.clamped_position_subunits(), radius),
            GridShape::Box(half) => BrushPiece::oriented_box(half, pose),
        }
    }

    /// The volume swept by the bit from one pose to another.
    #[must_use]
    pub fn swept_brush(&self, from: &Pose, to: &Pose) -> Brush {
        match self.shape {
            GridShape::Ball(radius) => Brush::capsule(
                from.clamped_position_subunits(),
                to.clamped_position_subunits(),
                radius,
            ),
            GridShape::Box(half) => Brush::swept_box(half, from, to),
        }
    }

    /// Depth of a point inside the bit, rounded up; negative outside. The axes are those of
    /// [`Pose::unit_axes_q14`], the offset is along the grid's axes, in subunits.
    pub(super) fn depth_subunits_at(
        &self,
        unit_axes_q14: &[IVec3; 3],
        offset_from_bit: I64Vec3,
    ) -> i32 {
        match self.shape {
            GridShape::Ball(radius) => radius - isqrt(offset_from_bit.dot(offset_from_bit)) as i32,
            GridShape::Box(half) => {
                let unit = i64::from(FIXED_ONE);
                let inside = |i: usize| {
                    let left = i64::from(half[i]) * unit
                        - offset_from_bit.dot(unit_axes_q14[i].as_i64vec3()).abs();
                    -(-left).div_euclid(unit)
                };
                inside(0).min(inside(1)).min(inside(2)) as i32
            }
        }
    }

    /// Swept offset shape: covers all points deeper inside the bit than a depth at any step between two
    /// poses. Conservative, up to about a voxel larger. `None` if no point is that deep.
    #[must_use]
    pub fn swept_cover_deeper_than(
        &self,
        depth_subunits: i32,
        from: &Pose,
        to: &Pose,
    ) -> Option<Brush> {
        let shape = match self.shape {
            GridShape::Ball(radius) => {
                let left = radius - depth_subunits;
                (left > 0).then_some(GridShape::Ball(left + ROUNDING))
            }
            GridShape::Box(half) => {
                let left = half - IVec3::splat(depth_subunits);
                // A piece has one rotation, that of its middle: corners are off by half the piece's turn.
                let turn = left.as_vec3().length() * from.angle_radians_to(to);
                let pieces = libm::ceilf(turn / SUBUNITS_PER_VOXEL as f32).max(1.0);
                let wider = ROUNDING + libm::ceilf(turn / pieces / 2.0) as i32;
                (left.min_element() > 0).then_some(GridShape::Box(left + wider))
            }
        };
        Some(GridBit { shape: shape?, ..*self }.swept_brush(from, to))
    }
}
