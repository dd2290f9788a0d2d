//! A bit's shape on a grid in fixed point, its offset shapes by depth, and its swept volumes.

use glam::{I64Vec3, IVec3, Vec3};

use crate::edit::brush::{Brush, BrushPiece, Capsule, DiscShape, SweptBox, SweptDisc, isqrt};
use crate::edit::pose::{FIXED_ONE, Pose, SUBUNITS_PER_VOXEL};
use crate::limits::SWEEP_PIECES;

/// A bit's shape and bite on a given grid, in fixed point ([`SUBUNITS_PER_VOXEL`]).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct GridBit {
    /// The shape.
    pub shape: GridShape,
    /// Maximum penetration into the material.
    pub bite: i32,
}

/// A shape in fixed point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum GridShape {
    /// A ball with this radius.
    Ball(i32),
    /// A box with these half extents.
    Box(IVec3),
    /// A disc, whose normal is the bit's x axis.
    Disc {
        /// Its radius.
        radius: i32,
        /// Half its thickness.
        half_thickness: i32,
    },
}

/// Upper bound, in fixed point, of how far rounding moves a step's pose off the path.
const ROUNDING: i32 = SUBUNITS_PER_VOXEL / 16;

impl GridBit {
    /// Returns the length of a path in voxels for counting steps. Along its own plane a disc's steps are four
    /// times as long as other bits' steps and as its steps across the plane. Part of a path never counts as
    /// more than the same fraction of the whole.
    #[must_use]
    pub(crate) fn stepped_length_voxels(&self, from: &Pose, to: &Pose) -> f32 {
        let length = (to.position - from.position).length();
        match self.shape {
            GridShape::Ball(_) | GridShape::Box(_) => length,
            GridShape::Disc { .. } => {
                let across = (to.position - from.position).dot(from.rotation * Vec3::X).abs();
                let turned = across + length * (0.25 + from.angle_radians_to(to));
                if turned < length { turned } else { length }
            }
        }
    }

    /// Returns the cost, in steps, of testing at once if the path between two poses is free: one step for
    /// each piece of the swept volume, as each has about as many rows as the whole.
    #[must_use]
    pub fn stretch_cost_in_steps(&self, from: &Pose, to: &Pose) -> u32 {
        self.swept_brush(from, to).pieces().len() as u32
    }

    /// Returns the shell depth of an edit: the bite in voxels, rounded up.
    #[must_use]
    pub fn bite_depth_voxels(&self) -> usize {
        (self.bite + SUBUNITS_PER_VOXEL - 1).div_euclid(SUBUNITS_PER_VOXEL).max(0) as usize
    }

    /// Returns the radius of the largest ball inside the shape; 0 for a disc, where depth isn't a distance.
    #[must_use]
    pub fn inscribed_radius_subunits(&self) -> i32 {
        match self.shape {
            GridShape::Ball(radius) => radius,
            GridShape::Box(half) => half.min_element(),
            GridShape::Disc { .. } => 0,
        }
    }

    /// Returns the radius of the smallest ball about its centre that contains the shape.
    #[must_use]
    pub fn circumscribed_radius_subunits(&self) -> i32 {
        match self.shape {
            GridShape::Ball(radius) => radius,
            GridShape::Box(half) => libm::ceilf(half.as_vec3().length()) as i32,
            // The disc's brush is the part of a ball between two planes.
            GridShape::Disc { radius, .. } => radius,
        }
    }

    /// Returns the bit without a rim, or `None` if nothing is left of it.
    #[must_use]
    pub(crate) fn shrunk_by(&self, rim_subunits: i32) -> Option<GridBit> {
        let shape = match self.shape {
            GridShape::Ball(radius) => GridShape::Ball(radius - rim_subunits),
            GridShape::Box(half) => GridShape::Box(half - IVec3::splat(rim_subunits)),
            GridShape::Disc { radius, half_thickness } => GridShape::Disc {
                radius: radius - rim_subunits,
                half_thickness: half_thickness - rim_subunits,
            },
        };
        let shrunk = GridBit { shape, ..*self };
        (shrunk.inscribed_radius_subunits() > 0).then_some(shrunk)
    }

    /// Offset shape: returns the points deeper inside the bit than a depth. A negative depth enlarges the bit
    /// by its faces or radius. `None` if no point is that deep. For a disc see [`GridBit::disc_deeper_than`].
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
            GridShape::Disc { .. } => {
                let disc = self.disc_deeper_than(depth_subunits)?;
                let strictly_inside =
                    DiscShape { radius_squared: disc.radius_squared - 1, extent: disc.extent - 1 };
                let at = pose.clamped_position_subunits();
                Some(BrushPiece::Disc(SweptDisc::new(strictly_inside, pose, at)))
            }
        }
    }

    /// Offset shape of a disc, boundary included. A disc is thin, so depth is measured in its plane. Across
    /// the plane, depth grows so fast from either face that five eighths of the thickness remain at the depth
    /// of the bite. So a wall stops a blade that is pushed sideways against it, and a hand can turn the blade
    /// in its slot. For a blade two voxels thick the rest is more than one voxel, so no layer of voxels can
    /// slip past.
    ///
    /// Returns `None` if no point is that deep, and for other shapes.
    fn disc_deeper_than(&self, depth_subunits: i32) -> Option<DiscShape> {
        let GridShape::Disc { radius, half_thickness } = self.shape else { return None };
        let (depth, bite) = (i64::from(depth_subunits), i64::from(self.bite.max(1)));
        if depth <= 0 {
            return Some(DiscShape::new(radius - depth_subunits, half_thickness - depth_subunits));
        }
        let left = i64::from(radius) - depth;
        let whole = 2 * i64::from(half_thickness) * i64::from(FIXED_ONE) * (8 * bite - 3 * depth);
        let disc =
            DiscShape { radius_squared: left * left, extent: -(-whole).div_euclid(8 * bite) };
        (left > 0 && disc.extent > 0).then_some(disc)
    }

    /// Returns the bit itself at a pose, boundary included.
    #[must_use]
    pub fn piece_at(&self, pose: &Pose) -> BrushPiece {
        match self.shape {
            GridShape::Ball(radius) => BrushPiece::sphere(pose.clamped_position_subunits(), radius),
            GridShape::Box(half) => BrushPiece::oriented_box(half, pose),
            GridShape::Disc { radius, half_thickness } => BrushPiece::Disc(SweptDisc::new(
                DiscShape::new(radius, half_thickness),
                pose,
                pose.clamped_position_subunits(),
            )),
        }
    }

    /// Returns the volume swept by the bit from one pose to another.
    #[must_use]
    pub fn swept_brush(&self, from: &Pose, to: &Pose) -> Brush {
        match self.shape {
            GridShape::Ball(radius) => Brush::capsule(
                from.clamped_position_subunits(),
                to.clamped_position_subunits(),
                radius,
            ),
            GridShape::Box(half) => Brush::swept_box(half, from, to),
            GridShape::Disc { radius, half_thickness } => {
                Brush::swept_disc(DiscShape::new(radius, half_thickness), from, to)
            }
        }
    }

    /// Returns the depth of a disc's middle; `None` for other shapes.
    pub(super) fn disc_middle_depth_subunits(&self) -> Option<i32> {
        let GridShape::Disc { radius, .. } = self.shape else { return None };
        Some(radius.min((8 * self.bite.max(1) + 2) / 3))
    }

    /// Returns the depth of a point inside the bit, rounded up; negative outside. The axes are those of
    /// [`Pose::unit_axes_q14`]; the offset is along the grid's axes, in subunits.
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
            GridShape::Disc { radius, half_thickness } => {
                let in_plane = radius - isqrt(offset_from_bit.dot(offset_from_bit)) as i32;
                let whole = i64::from(half_thickness.max(1)) * i64::from(FIXED_ONE);
                let left = whole - offset_from_bit.dot(unit_axes_q14[0].as_i64vec3()).abs();
                let across = -(-left * 8 * i64::from(self.bite.max(1))).div_euclid(3 * whole);
                in_plane.min(across as i32)
            }
        }
    }

    /// Swept offset shape: covers all points deeper inside the bit than a depth at any step between two
    /// poses. Conservative, up to about a voxel larger. Returns `None` if no point is that deep.
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
                // A piece has a single rotation, that of its middle: corners are off by half the piece's
                // turn.
                let turn = left.as_vec3().length() * from.angle_radians_to(to);
                let pieces = libm::ceilf(turn / SUBUNITS_PER_VOXEL as f32).max(1.0);
                let wider = ROUNDING + libm::ceilf(turn / pieces / 2.0) as i32;
                (left.min_element() > 0).then_some(GridShape::Box(left + wider))
            }
            GridShape::Disc { .. } => self.disc_deeper_than(depth_subunits).map(|disc| {
                let radius = isqrt(disc.radius_squared) as i32 + 1;
                let half_thickness = disc.extent.div_euclid(2 * i64::from(FIXED_ONE)) as i32 + 1;
                // A piece has a single rotation, that of its middle, which moves its rim off the plane.
                let turn = radius as f32 * from.angle_radians_to(to);
                let pieces = libm::ceilf(turn / SUBUNITS_PER_VOXEL as f32)
                    .clamp(1.0, (SWEEP_PIECES - 1) as f32);
                let turn = libm::ceilf(turn / pieces / 2.0) as i32;
                GridShape::Disc {
                    radius: radius + ROUNDING,
                    half_thickness: half_thickness + ROUNDING + turn,
                }
            }),
        };
        Some(GridBit { shape: shape?, ..*self }.swept_brush(from, to))
    }
}
