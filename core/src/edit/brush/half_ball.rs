//! Half a ball: the part of a ball above a plane.

use super::{BrushPiece, Capsule};
use crate::edit::half_space::HalfSpace;
use crate::volume::range::Range;
use glam::IVec3;

/// The points of a ball that are above a plane.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct HalfBall {
    /// The ball, as a capsule of length 0.
    pub ball: Capsule,
    /// The half-space above the plane.
    pub above: HalfSpace,
}

impl HalfBall {
    /// Creates half the ball about a point, on the side of that point to which a normal in fixed point
    /// points.
    #[must_use]
    pub fn about(centre_subunits: IVec3, radius_subunits: i32, normal_q14: IVec3) -> BrushPiece {
        let offset = normal_q14.as_i64vec3().dot(centre_subunits.as_i64vec3());
        let above = HalfSpace { normal: normal_q14, offset };
        match BrushPiece::sphere(centre_subunits, radius_subunits) {
            BrushPiece::Capsule(ball) => BrushPiece::HalfBall(HalfBall { ball, above }),
            other => other,
        }
    }

    /// Returns the voxels of a row, given the fixed-point y and z of its centres.
    #[inline]
    pub(super) fn x_range(&self, y: i64, z: i64, grid_side: usize) -> Option<Range> {
        let of_ball = self.ball.sphere_x_range(y, z, grid_side)?;
        let of_plane = self.above.x_range(y, z, grid_side)?;
        let first = of_ball.first().max(of_plane.first());
        let last = of_ball.last().min(of_plane.last());
        (first <= last).then(|| Range::new(first, last))
    }
}
