//! Contact: how deep a bit sits in the volume, and the farthest pose that it may take.
//!
//! Source: section 3.1 of the paper. Depth is the largest inner distance, in the bit's analytic
//! shape, of any occupied voxel centre; a bit may sit as deep as its bite, and not at all in the
//! mask. All comparisons are in integers; poses between two ticks are interpolated in floats.

mod path;
mod rows;

use glam::{IVec3, Vec3};

use crate::brush::{Brush, Capsule, Piece, SweptBox, centre, isqrt};
use crate::maps::Maps;
use crate::plane::Plane;
use crate::pose::{Pose, UNIT};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::tools::{GridBit, GridShape};
use path::STEPS_PER_VOXEL;
pub use path::{LONG_STRETCH, SHORT_STRETCH, looks};

/// What a bit touches at a pose.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Contact {
    /// Occupied voxels whose centre is inside the bit.
    pub overlap: u32,
    /// Largest inner distance of any of them, in fixed point, rounded up; 0 without overlap.
    pub depth: i32,
    /// Sum over the overlapped surface voxels of the directions to their empty six-neighbours,
    /// normalised; zero when there are none or they cancel out.
    pub normal: Vec3,
    /// Whether a mask voxel lies in the bit or within a voxel of it.
    pub on_mask: bool,
}

impl Contact {
    /// Nothing touched.
    pub const NONE: Contact = Contact { overlap: 0, depth: 0, normal: Vec3::ZERO, on_mask: false };
}

/// Where a bit ends up on its way to a raw pose.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Frozen {
    /// The pose it takes.
    pub pose: Pose,
    /// Whether the volume held it back. If not, it took the raw pose, or as much of a longer way as it
    /// had steps for.
    pub blocked: bool,
    /// How many of these it took.
    pub steps: u32,
}

/// What a bit can run into.
#[derive(Debug)]
pub struct Obstacle<'a, const N: usize>
where
    Grid<N>: Size,
{
    /// The volume.
    pub rows: &'a Plane<N>,
    /// The part of it that can't be removed; `None` where there is no mask.
    pub mask: Option<&'a Maps<N>>,
}

impl GridBit {
    /// The points deeper inside the bit than `level` (fixed point), or, for a negative level, those
    /// closer than that to it along its faces or radius. `None` if there are none.
    #[must_use]
    pub fn deeper_than(&self, level: i32, pose: &Pose) -> Option<Piece> {
        match self.shape {
            GridShape::Ball(radius) => {
                let left = i64::from(radius - level);
                let a = pose.fixed_position();
                let capsule = Capsule { a, b: a, radius_squared: left * left - 1 };
                (left > 0).then_some(Piece::Capsule(capsule))
            }
            GridShape::Box(half) => {
                let left = half - IVec3::splat(level);
                if left.min_element() <= 0 {
                    return None;
                }
                let mut piece = SweptBox::new(left, pose, pose.fixed_position());
                for (_, extent) in &mut piece.planes[..3] {
                    *extent -= 1;
                }
                Some(Piece::Box(piece))
            }
        }
    }

    /// The bit itself at a pose, boundary included.
    #[must_use]
    pub fn piece(&self, pose: &Pose) -> Piece {
        match self.shape {
            GridShape::Ball(radius) => Piece::sphere(pose.fixed_position(), radius),
            GridShape::Box(half) => Piece::oriented_box(half, pose),
        }
    }

    /// The bit on its way from one pose to another.
    #[must_use]
    pub fn swept_brush(&self, from: &Pose, to: &Pose) -> Brush {
        match self.shape {
            GridShape::Ball(radius) => {
                Brush::capsule(from.fixed_position(), to.fixed_position(), radius)
            }
            GridShape::Box(half) => Brush::swept_box(half, from, to),
        }
    }

    /// How far inside the bit a point is, in fixed point, rounded up; negative outside.
    #[must_use]
    pub fn inner_distance(&self, pose: &Pose, point: [i64; 3]) -> i32 {
        let p = glam::I64Vec3::from_array(point) - pose.fixed_position().as_i64vec3();
        self.inner_distance_of(&pose.fixed_axes(), p)
    }

    fn inner_distance_of(&self, axes: &[IVec3; 3], p: glam::I64Vec3) -> i32 {
        match self.shape {
            GridShape::Ball(radius) => radius - isqrt(p.dot(p)) as i32,
            GridShape::Box(half) => {
                let unit = i64::from(UNIT);
                let inside = |i: usize| {
                    let left = i64::from(half[i]) * unit - p.dot(axes[i].as_i64vec3()).abs();
                    -(-left).div_euclid(unit)
                };
                inside(0).min(inside(1)).min(inside(2)) as i32
            }
        }
    }
}

impl<const N: usize> Obstacle<'_, N>
where
    Grid<N>: Size,
{
    /// What the bit touches at a pose.
    #[must_use]
    pub fn contact(&self, bit: &GridBit, pose: &Pose) -> Contact {
        let (position, axes) = (pose.fixed_position().as_i64vec3(), pose.fixed_axes());
        let mut contact = Contact {
            overlap: 0,
            depth: 0,
            normal: Vec3::ZERO,
            on_mask: self.near_mask(bit, pose),
        };
        let mut normal = IVec3::ZERO;
        self.each_row(&bit.piece(pose), |y, z, inside| {
            contact.overlap += inside.count();
            normal += self.empty_directions(y, z, inside);
            for x in inside.ones() {
                let p = glam::I64Vec3::new(centre(x), centre(y), centre(z)) - position;
                contact.depth = contact.depth.max(bit.inner_distance_of(&axes, p));
            }
        });
        contact.normal = normal.as_vec3().normalize_or_zero();
        contact
    }

    /// The last pose on the path at which the bit sits no deeper than it may, then one slide along
    /// the tangent of what stopped it: of the surface there, or, where that leads nowhere though it
    /// should (the side of a bump whose top is flat), of the stopping voxels as seen from the bit's
    /// centre. From a pose that is too deep already, the bit may only move so that its depth doesn't
    /// grow, or come out of the stone further on its way. It walks so many steps at the most; see
    /// [`walk_steps`](crate::limits::walk_steps).
    #[must_use]
    pub fn freeze(&self, bit: &GridBit, from: &Pose, raw: &Pose, most: u32) -> Frozen {
        let mut left = most;
        let (pose, blocked) = self.walk(bit, from, raw, &mut left);
        Frozen { pose, blocked, steps: most - left }
    }

    /// Up to three ways of [`Obstacle::freeze`], of so many steps together.
    fn walk(&self, bit: &GridBit, from: &Pose, raw: &Pose, steps: &mut u32) -> (Pose, bool) {
        let (reached, stop) = self.advance(bit, from, raw, steps);
        let Some(stop) = stop else {
            return (reached, false);
        };
        let left = raw.position - reached.position;
        let mut normal = self.contact(bit, &stop).normal;
        if normal == Vec3::ZERO {
            normal = -left.normalize_or_zero();
        }
        let inward = left.dot(normal);
        let target = match inward < 0.0 {
            true => Pose { position: reached.position + left - normal * inward, ..*raw },
            // Only turning can have run into something: the bit moves on as it is turned.
            false => Pose { position: raw.position, ..reached },
        };
        let (mut pose, _) = self.advance(bit, &reached, &target, steps);
        let wanted = (target.position - reached.position) * STEPS_PER_VOXEL;
        if pose.position == reached.position && wanted.length_squared() > 1.0 {
            let away = self.away_from_stop(bit, &reached, &stop);
            let inward = left.dot(away);
            let tangent = if inward < 0.0 { left - away * inward } else { left };
            let target = Pose { position: reached.position + tangent, ..reached };
            pose = self.advance(bit, &reached, &target, steps).0;
        }
        (pose, true)
    }

    /// The direction to the bit's centre from the voxels that forbid the pose `stop` after
    /// `reached`.
    fn away_from_stop(&self, bit: &GridBit, reached: &Pose, stop: &Pose) -> Vec3 {
        let limit = self.limit(bit, reached);
        let mut away = glam::I64Vec3::ZERO;
        self.each_depth(bit, stop, |from_centre, depth, held| {
            if depth > limit.volume || (held && depth > limit.mask) {
                away -= from_centre;
            }
        });
        away.as_vec3().normalize_or_zero()
    }
}
