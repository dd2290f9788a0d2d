//! Contact: penetration depth of a bit in the volume, and the farthest pose that the volume allows.
//!
//! Source: section 3.1 of the paper. Depth is the largest inner distance of an occupied voxel centre in
//! the bit's analytic shape. A bit may penetrate the volume by its bite, and the mask not at all. All
//! comparisons are made in integers; poses between two ticks are interpolated in floats.

mod path;
mod rows;

use glam::{IVec3, Vec3};

use crate::edit::brush::voxel_centre;
use crate::edit::grid_bit::GridBit;
use crate::edit::pose::Pose;
use crate::volume::bit_grid::BitGrid;
use crate::volume::range_maps::RangeMaps;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use path::STEPS_PER_VOXEL;
pub use path::{LONG_STRETCH, SHORT_STRETCH, exit_probes};

/// The contact of a bit with the volume at a pose.
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
    /// No contact.
    pub const NONE: Contact = Contact { overlap: 0, depth: 0, normal: Vec3::ZERO, on_mask: false };
}

/// The result of moving a bit toward a raw pose.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FreezeResult {
    /// The pose reached, the frozen pose.
    pub pose: Pose,
    /// Whether the volume stopped the bit. If not, the pose is the raw one, or where the step budget
    /// ran out.
    pub blocked: bool,
    /// Steps spent of the budget.
    pub steps: u32,
}

/// The voxels that a bit can collide with.
#[derive(Debug)]
pub struct Obstacle<'a, const N: usize>
where
    Grid<N>: Size,
{
    /// The volume's bit rows.
    pub rows: &'a BitGrid<N>,
    /// The part of it that can't be removed; `None` where there is no mask.
    pub mask: Option<&'a RangeMaps<N>>,
}

impl<const N: usize> Obstacle<'_, N>
where
    Grid<N>: Size,
{
    /// The contact of the bit at a pose in the grid.
    #[must_use]
    pub fn contact_at(&self, bit: &GridBit, pose: &Pose) -> Contact {
        let (position, axes) = (pose.fixed_position().as_i64vec3(), pose.fixed_axes());
        let mut contact = Contact {
            overlap: 0,
            depth: 0,
            normal: Vec3::ZERO,
            on_mask: self.is_near_mask(bit, pose),
        };
        let mut normal = IVec3::ZERO;
        self.for_each_row(&bit.piece_at(pose), |y, z, inside| {
            contact.overlap += inside.count_ones();
            normal += self.empty_directions(y, z, inside);
            for x in inside.iter_ones() {
                let p = glam::I64Vec3::new(voxel_centre(x), voxel_centre(y), voxel_centre(z))
                    - position;
                contact.depth = contact.depth.max(bit.inner_distance(&axes, p));
            }
        });
        contact.normal = normal.as_vec3().normalize_or_zero();
        contact
    }

    /// Move and slide: moves the bit along the path as far as its penetration limit allows, then slides
    /// it once along the tangent plane of the surface that stopped it. If that slide doesn't move it
    /// (the side of a bump whose top is flat), it slides perpendicular to the direction from the
    /// blocking voxels to its centre. A bit that is too deep already may only move without going
    /// deeper, or leave the volume at an exit farther along the path.
    ///
    /// `max_steps` limits the path traversal; see [`crate::limits::max_walk_steps`].
    #[must_use]
    pub fn freeze_bit(
        &self,
        bit: &GridBit,
        from: &Pose,
        raw: &Pose,
        max_steps: u32,
    ) -> FreezeResult {
        let mut steps_left = max_steps;
        let (pose, blocked) = self.move_and_slide(bit, from, raw, &mut steps_left);
        FreezeResult { pose, blocked, steps: max_steps - steps_left }
    }

    /// Up to three paths: toward the raw pose, and two slides. They share the step budget. Returns the
    /// pose reached and whether the volume stopped the bit.
    fn move_and_slide(
        &self,
        bit: &GridBit,
        from: &Pose,
        raw: &Pose,
        steps_left: &mut u32,
    ) -> (Pose, bool) {
        let (reached, stop) = self.advance_along(bit, from, raw, steps_left);
        let Some(stop) = stop else {
            return (reached, false);
        };
        let remaining = raw.position - reached.position;
        let mut normal = self.contact_at(bit, &stop).normal;
        if normal == Vec3::ZERO {
            normal = -remaining.normalize_or_zero();
        }
        let inward = remaining.dot(normal);
        let target = match inward < 0.0 {
            true => Pose { position: reached.position + remaining - normal * inward, ..*raw },
            // The remaining path leads outward, so only the rotation was stopped: keep the old one.
            false => Pose { position: raw.position, ..reached },
        };
        let (mut pose, _) = self.advance_along(bit, &reached, &target, steps_left);
        let wanted = (target.position - reached.position) * STEPS_PER_VOXEL;
        if pose.position == reached.position && wanted.length_squared() > 1.0 {
            let away = self.direction_from_blockers(bit, &reached, &stop);
            let inward = remaining.dot(away);
            let tangent = if inward < 0.0 { remaining - away * inward } else { remaining };
            let target = Pose { position: reached.position + tangent, ..reached };
            pose = self.advance_along(bit, &reached, &target, steps_left).0;
        }
        (pose, true)
    }

    /// The mean unit direction to the bit's centre from the voxels that forbid the pose `stop`, when it
    /// comes from `reached`; zero if they cancel out.
    fn direction_from_blockers(&self, bit: &GridBit, reached: &Pose, stop: &Pose) -> Vec3 {
        let limit = self.penetration_limit(bit, reached);
        let mut away = glam::I64Vec3::ZERO;
        self.for_each_depth(bit, stop, |from_centre, depth, masked| {
            if depth > limit.volume || (masked && depth > limit.mask) {
                away -= from_centre;
            }
        });
        away.as_vec3().normalize_or_zero()
    }
}
