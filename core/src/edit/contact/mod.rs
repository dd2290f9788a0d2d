//! Contact: penetration depth of a bit in the volume, and the farthest pose that the volume allows.
//!
//! Source: section 3.1 of the paper. Depth is the largest inner distance of an occupied voxel centre in
//! the bit's analytic shape. A bit may penetrate the volume by its bite, and the mask not at all. All
//! comparisons are made in integers; poses between two ticks are interpolated in floats.

mod path;
mod rows;

use glam::{IVec3, Vec3};

use crate::edit::brush::voxel_centre_subunits;
use crate::edit::grid_bit::GridBit;
use crate::edit::pose::Pose;
use crate::volume::bit_grid::BitGrid;
use crate::volume::range_maps::RangeMaps;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
pub use path::{LONG_STRETCH, SHORT_STRETCH, exit_probe_steps};
use path::{PathAdvance, PenetratingVoxel, STEPS_PER_VOXEL};

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

/// The result of moving a bit toward a wanted pose.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct FreezeResult {
    /// The pose reached, the frozen pose.
    pub pose: Pose,
    /// Whether the volume stopped the bit. If not, the pose is the wanted one, or where the step budget
    /// ran out.
    pub blocked: bool,
    /// Steps spent of the budget.
    pub steps: u32,
}

/// Where [`Obstacle::move_and_slide`] took a bit.
struct SlideResult {
    pose: Pose,
    /// Whether the volume stopped the bit.
    blocked: bool,
}

/// The voxels that a bit can collide with.
#[derive(Debug)]
pub struct Obstacle<'a, const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The volume's bit rows.
    pub rows: &'a BitGrid<N>,
    /// The part of it that can't be removed; `None` where there is no mask.
    pub mask: Option<&'a RangeMaps<N, K>>,
}

impl<const N: usize, const K: usize> Obstacle<'_, N, K>
where
    Grid<N>: Size,
{
    /// The contact of the bit at a pose in the grid.
    #[must_use]
    pub fn contact_at(&self, bit: &GridBit, pose: &Pose) -> Contact {
        let (position, axes) = (pose.position_subunits().as_i64vec3(), pose.unit_axes_q14());
        let mut contact = Contact {
            overlap: 0,
            depth: 0,
            normal: Vec3::ZERO,
            on_mask: self.is_near_mask(bit, pose),
        };
        let mut normal = IVec3::ZERO;
        self.visit_occupied_rows(&bit.piece_at(pose), |(y, z), inside| {
            contact.overlap += inside.count_ones();
            normal += self.sum_directions_to_empty((y, z), inside);
            for x in inside.iter_ones() {
                let p = glam::I64Vec3::new(
                    voxel_centre_subunits(x),
                    voxel_centre_subunits(y),
                    voxel_centre_subunits(z),
                ) - position;
                contact.depth = contact.depth.max(bit.depth_subunits_at(&axes, p));
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
    /// `max_steps` limits the path traversal; see [`crate::limits::max_bit_steps_per_tick`].
    #[must_use]
    pub fn freeze_bit(
        &self,
        bit: &GridBit,
        from: &Pose,
        wanted: &Pose,
        max_steps: u32,
    ) -> FreezeResult {
        if max_steps == 0 {
            return FreezeResult { pose: *from, blocked: false, steps: 0 };
        }
        let mut steps_left = max_steps;
        let SlideResult { pose, blocked } = self.move_and_slide(bit, from, wanted, &mut steps_left);
        FreezeResult { pose, blocked, steps: max_steps - steps_left }
    }

    /// Up to three paths: toward the wanted pose, and two slides. They share the step budget.
    fn move_and_slide(
        &self,
        bit: &GridBit,
        from: &Pose,
        wanted: &Pose,
        steps_left: &mut u32,
    ) -> SlideResult {
        let PathAdvance { last_allowed: reached, first_forbidden } =
            self.advance_along(bit, from, wanted, steps_left);
        let Some(forbidden) = first_forbidden else {
            return SlideResult { pose: reached, blocked: false };
        };
        let remaining = wanted.position - reached.position;
        let mut normal = self.contact_at(bit, &forbidden).normal;
        if normal == Vec3::ZERO {
            normal = -remaining.normalize_or_zero();
        }
        let inward = remaining.dot(normal);
        let target = match inward < 0.0 {
            true => Pose { position: reached.position + remaining - normal * inward, ..*wanted },
            // The remaining path leads outward, so only the rotation was stopped: keep the old one.
            false => Pose { position: wanted.position, ..reached },
        };
        let mut pose = self.advance_along(bit, &reached, &target, steps_left).last_allowed;
        let slide_steps = (target.position - reached.position) * STEPS_PER_VOXEL;
        if pose.position == reached.position && slide_steps.length_squared() > 1.0 {
            let away = self.unit_direction_from_blockers(bit, &reached, &forbidden);
            let inward = remaining.dot(away);
            let tangent = if inward < 0.0 { remaining - away * inward } else { remaining };
            let target = Pose { position: reached.position + tangent, ..reached };
            pose = self.advance_along(bit, &reached, &target, steps_left).last_allowed;
        }
        SlideResult { pose, blocked: true }
    }

    /// The mean unit direction to the bit's centre from the voxels that forbid the pose `forbidden`, when
    /// it comes from `last_allowed`; zero if they cancel out.
    fn unit_direction_from_blockers(
        &self,
        bit: &GridBit,
        last_allowed: &Pose,
        forbidden: &Pose,
    ) -> Vec3 {
        let limit = self.penetration_limit(bit, last_allowed);
        let mut away = glam::I64Vec3::ZERO;
        self.visit_penetrating_voxels(bit, forbidden, |voxel| {
            let PenetratingVoxel { offset_from_bit, depth_subunits: depth, is_masked } = voxel;
            if depth > limit.volume || (is_masked && depth > limit.mask) {
                away -= offset_from_bit;
            }
        });
        away.as_vec3().normalize_or_zero()
    }
}
