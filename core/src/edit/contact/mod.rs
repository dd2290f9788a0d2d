//! Contact: penetration depth of a bit in the volume, and the farthest pose that the volume allows.
//!
//! Source: section 3.1 of the paper. Depth is the largest inner distance of an occupied voxel centre in
//! the bit's analytic shape. A bit may penetrate the volume by its bite, and the mask not at all. All
//! comparisons are made in integers; poses between two ticks are interpolated in floats.
//!
//! No path leads a bit's centre through stone. A *buried* bit, whose centre is in stone after an undo or
//! another hand's fill, has no path out: it stands still until its hand's pose is free, and then jumps there.

mod depth;
mod path;
mod rows;

use glam::{I64Vec3, IVec3, Vec3};

use crate::edit::grid_bit::{GridBit, GridShape};
use crate::edit::pose::Pose;
use crate::limits::{MAX_SLIDES, deep_step_cost_in_steps, slide_cost_in_steps};
use crate::volume::bit_grid::BitGrid;
use crate::volume::range_maps::RangeMaps;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};
use depth::DepthRuler;
pub use path::{BURIED_WITHIN, LONG_STRETCH, SHORT_STRETCH, exit_probe_steps};
use path::{PathAdvance, PenetrationLimit, STEPS_PER_VOXEL};
use rows::TestedVoxels;

/// The contact of a bit with the volume at a pose.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Contact {
    /// Occupied voxels whose centre is inside the bit.
    pub overlap: u32,
    /// Largest inner distance of these voxels, in fixed point, rounded up; 0 without overlap.
    pub depth: i32,
    /// Sum over the overlapped surface voxels of the directions to their empty six-neighbours, normalised;
    /// zero if there are none or they cancel out.
    pub normal: Vec3,
    /// `true` if a mask voxel lies in the bit or within half a voxel of it.
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
    /// `true` if the volume stopped the bit. Otherwise the pose is the wanted one, or where the budget ran
    /// out.
    pub blocked: bool,
    /// `true` if the budget ran out before the path ended, sliding or not.
    pub ran_out: bool,
    /// `true` if the bit was buried and jumped to the wanted pose without a path: don't sweep between the
    /// poses.
    pub jumped: bool,
    /// Steps spent of the budget.
    pub steps: u32,
}

/// The budget of a bit's movement.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct WayBudget {
    /// Steps. A stretch that is tried at once costs one step; see [`crate::limits::max_bit_steps_per_tick`].
    pub steps: u32,
    /// Length of the path in quarter voxels, free or not.
    pub quarter_voxels: u32,
}

impl WayBudget {
    /// Creates a budget of a number of steps and unlimited length.
    #[must_use]
    pub const fn of_steps(steps: u32) -> Self {
        WayBudget { steps, quarter_voxels: u32::MAX }
    }

    /// Returns `true` if the budget is used up.
    const fn is_spent(self) -> bool {
        self.steps == 0 || self.quarter_voxels == 0
    }
}

/// Slope by which a bit's further slides rise above the plane of contact, out of the stone, times the number
/// of slides. Needed because the plane is the mean over several blocking voxels.
const LIFT: f32 = 0.125;

/// The result of [`Obstacle::move_and_slide`].
struct SlideResult {
    pose: Pose,
    /// `true` if the volume stopped the bit.
    blocked: bool,
    /// `true` if the budget ran out.
    ran_out: bool,
}

/// The voxels that a bit can collide with.
#[derive(Debug)]
pub struct Obstacle<'a, const N: usize, const K: usize = 1>
where
    Grid<N>: Size,
{
    /// The volume's bit rows.
    pub rows: &'a BitGrid<N>,
    /// The part of the volume that can't be removed; `None` if there is no mask.
    pub mask: Option<&'a RangeMaps<N, K>>,
    /// `true` if bits collide only with the mask, as a running nozzle does.
    pub is_mask_alone: bool,
}

impl<const N: usize, const K: usize> Obstacle<'_, N, K>
where
    Grid<N>: Size,
{
    /// Returns the contact of the bit at a pose in the grid. A disc that is too deep is reported with an
    /// overlap of 1 and the depth of its middle: counting and finding a normal would exceed the rest of a
    /// tick's work.
    #[must_use]
    pub fn contact_at(&self, bit: &GridBit, pose: &Pose) -> Contact {
        let ruler = DepthRuler::new(bit, pose);
        let (mut overlap, mut depth, mut normal) = (0, 0, IVec3::ZERO);
        if let Some(depth) = self.depth_of_too_deep_disc(bit, pose) {
            let on_mask = self.is_within_half_voxel_of_mask(bit, pose);
            return Contact { overlap: 1, depth, normal: Vec3::ZERO, on_mask };
        }
        self.visit_occupied_rows(&bit.piece_at(pose), |row, inside| {
            overlap += inside.count_ones();
            depth = depth.max(ruler.deepest_of_row(row, inside));
            normal += self.sum_directions_to_empty(row, inside);
        });
        let normal = normal.as_vec3().normalize_or_zero();
        Contact { overlap, depth, normal, on_mask: self.is_within_half_voxel_of_mask(bit, pose) }
    }

    /// Returns the depth of a disc's middle if a voxel lies deeper in the disc than its bite, else `None`.
    /// `None` for other bits.
    fn depth_of_too_deep_disc(&self, bit: &GridBit, pose: &Pose) -> Option<i32> {
        let most = bit.disc_middle_depth_subunits()?;
        let core = bit.piece_deeper_than(bit.bite, pose)?;
        self.piece_overlaps(&core, TestedVoxels::AllOccupied).then_some(most)
    }

    /// Returns only [`Contact::normal`].
    fn normal_at(&self, bit: &GridBit, pose: &Pose) -> Vec3 {
        let mut normal = IVec3::ZERO;
        self.visit_occupied_rows(&bit.piece_at(pose), |row, inside| {
            normal += self.sum_directions_to_empty(row, inside);
        });
        normal.as_vec3().normalize_or_zero()
    }

    /// Move and slide: moves the bit along the path as far as its penetration limit allows, then slides it
    /// along the tangent plane of the surface that stopped it, and further along the planes of the voxels
    /// that stop its slides. A bit that is already too deep may only move without going deeper, or leave the
    /// volume at an exit farther along the path. A buried bit stands still or jumps.
    #[must_use]
    pub fn freeze_bit(
        &self,
        bit: &GridBit,
        from: &Pose,
        wanted: &Pose,
        budget: WayBudget,
    ) -> FreezeResult {
        self.move_bit(bit, (from, wanted), budget, |reached, forbidden, left| {
            Some(self.slide_along(bit, reached, forbidden, wanted, left))
        })
    }

    /// Moves the bit without sliding: it stops where the volume stops it, before the stone that its next bite
    /// removes.
    #[must_use]
    pub fn freeze_bit_straight(
        &self,
        bit: &GridBit,
        from: &Pose,
        wanted: &Pose,
        budget: WayBudget,
    ) -> FreezeResult {
        self.move_bit(bit, (from, wanted), budget, |_, _, _| None)
    }

    /// Moves the bit. `slide` gets the last allowed pose, the forbidden one after it and the budget left.
    fn move_bit(
        &self,
        bit: &GridBit,
        (from, wanted): (&Pose, &Pose),
        budget: WayBudget,
        slide: impl FnOnce(&Pose, &Pose, &mut WayBudget) -> Option<PathAdvance>,
    ) -> FreezeResult {
        if budget.is_spent() {
            let stands = FreezeResult {
                pose: *from,
                blocked: false,
                ran_out: true,
                jumped: false,
                steps: 0,
            };
            return stands;
        }
        let limit = self.penetration_limit(bit, from);
        if limit.may_bury_centre(bit) {
            return self.jump_if_bite_allows(bit, from, wanted, budget);
        }
        let mut left = budget;
        let SlideResult { pose, blocked, ran_out } =
            self.move_and_slide(bit, (from, limit), wanted, &mut left, slide);
        let steps = budget.steps - left.steps;
        FreezeResult { pose, blocked, ran_out, jumped: false, steps }
    }

    /// Returns `true` if the bit is too deep and a voxel's centre is so near the bit's centre that the latter
    /// may lie in that voxel.
    #[must_use]
    pub fn buries(&self, bit: &GridBit, pose: &Pose) -> bool {
        self.penetration_limit(bit, pose).may_bury_centre(bit)
    }

    /// Freezes a bit without a path: at the wanted pose if its bite allows that, else at its previous pose.
    #[must_use]
    pub fn jump_if_bite_allows(
        &self,
        bit: &GridBit,
        from: &Pose,
        wanted: &Pose,
        budget: WayBudget,
    ) -> FreezeResult {
        let bite = PenetrationLimit::of_bite(bit);
        let jumped = !budget.is_spent() && self.is_allowed(bit, wanted, bite);
        let pose = if jumped { *wanted } else { *from };
        let steps = deep_step_cost_in_steps(N).min(budget.steps);
        FreezeResult { pose, blocked: !jumped, ran_out: false, jumped, steps }
    }

    /// Moves the bit, and slides it if it is stopped.
    fn move_and_slide(
        &self,
        bit: &GridBit,
        (from, limit): (&Pose, PenetrationLimit),
        wanted: &Pose,
        left: &mut WayBudget,
        slide: impl FnOnce(&Pose, &Pose, &mut WayBudget) -> Option<PathAdvance>,
    ) -> SlideResult {
        let walk = self.advance_along(bit, (from, limit), wanted, left);
        let PathAdvance { last_allowed: reached, ran_out, .. } = walk;
        let Some(forbidden) = walk.first_forbidden else {
            return SlideResult { pose: reached, blocked: false, ran_out };
        };
        let Some(slide) = slide(&reached, &forbidden, left) else {
            return SlideResult { pose: reached, blocked: true, ran_out: false };
        };
        // The sweep is the straight line from the bit's previous pose; a slide around a corner may not follow
        // it.
        match self.may_cross_stone(bit, from, &slide.last_allowed) {
            true => SlideResult { pose: reached, blocked: true, ran_out: false },
            false => {
                SlideResult { pose: slide.last_allowed, blocked: true, ran_out: slide.ran_out }
            }
        }
    }

    /// Collide and slide: the bit slides along the tangent plane of the surface that stopped it, and, if it
    /// is stopped again, along all planes so far, up to [`MAX_SLIDES`] times. With one plane only, it would
    /// move back and forth between the stairs of two voxels and get stuck in the dimple between them. The
    /// hand's depth is ignored: otherwise the bit couldn't climb a stair that is steeper than the direction
    /// to its hand.
    fn slide_along(
        &self,
        bit: &GridBit,
        reached: &Pose,
        forbidden: &Pose,
        wanted: &Pose,
        left: &mut WayBudget,
    ) -> PathAdvance {
        let cost = slide_cost_in_steps(N, matches!(bit.shape, GridShape::Disc { .. }));
        left.spend(cost, 0);
        let (normal, limit) =
            (self.normal_at(bit, forbidden), self.penetration_limit(bit, reached));
        let mut planes = [Vec3::ZERO; MAX_SLIDES + 1];
        planes[0] = self.unit_direction_from_blockers(bit, limit, forbidden);
        let mut slide = self.slide_along_surface(bit, (reached, limit), normal, wanted, left);
        for count in 1..=MAX_SLIDES {
            let Some(forbidden) = slide.first_forbidden.filter(|_| !left.is_spent()) else { break };
            let at = slide.last_allowed;
            let limit = self.penetration_limit(bit, &at);
            planes[count] = self.unit_direction_from_blockers(bit, limit, &forbidden);
            let remaining = wanted.position - at.position;
            let tangent = clip_to_planes(remaining, &[normal]);
            let along = clip_to_planes(tangent, &planes[..=count]);
            let way = along + planes[count] * (along.length() * (LIFT * count as f32));
            if (way * STEPS_PER_VOXEL).length_squared() <= 1.0 {
                break;
            }
            left.spend(cost, 0);
            let target = Pose { position: at.position + way, ..at };
            slide = self.advance_along(bit, (&at, limit), &target, left);
        }
        slide
    }

    /// Moves a stopped bit along the tangent plane of all voxels that it overlaps. `normal` is that plane's
    /// unit normal, or zero.
    fn slide_along_surface(
        &self,
        bit: &GridBit,
        (reached, limit): (&Pose, PenetrationLimit),
        mut normal: Vec3,
        wanted: &Pose,
        left: &mut WayBudget,
    ) -> PathAdvance {
        let remaining = wanted.position - reached.position;
        if normal == Vec3::ZERO {
            normal = -remaining.normalize_or_zero();
        }
        let inward = remaining.dot(normal);
        let target = match inward < 0.0 {
            true => Pose { position: reached.position + remaining - normal * inward, ..*wanted },
            // The remaining path leads outward, so only the rotation was stopped: keep the old one.
            false => Pose { position: wanted.position, ..*reached },
        };
        self.advance_along(bit, (reached, limit), &target, left)
    }

    /// Returns the mean unit direction to the bit's centre from the voxels that forbid the pose `forbidden`
    /// at this limit; zero if they cancel out.
    fn unit_direction_from_blockers(
        &self,
        bit: &GridBit,
        limit: PenetrationLimit,
        forbidden: &Pose,
    ) -> Vec3 {
        let ruler = DepthRuler::new(bit, forbidden);
        let mut away = I64Vec3::ZERO;
        if let Some(piece) = bit.piece_deeper_than(limit.volume, forbidden) {
            self.visit_occupied_rows(&piece, |row, inside| {
                away -= inside.iter_ones().map(|x| ruler.offset_of((x, row))).sum::<I64Vec3>();
            });
        }
        if let (Some(mask), Some(piece)) = (self.mask, bit.piece_deeper_than(limit.mask, forbidden))
        {
            self.visit_occupied_rows(&piece, |row, inside| {
                let held = mask.occupied_among(row, inside);
                let offsets = held.iter_ones().map(|x| ruler.offset_of((x, row)));
                let is_new = |p: &I64Vec3| ruler.depth_at(*p) <= limit.volume;
                away -= offsets.filter(is_new).sum::<I64Vec3>();
            });
        }
        away.as_vec3().normalize_or_zero()
    }
}

/// Projects a movement on the cone of directions that enter none of the planes of these unit normals, by
/// rounds of projections on one plane after the other.
fn clip_to_planes(mut way: Vec3, normals: &[Vec3]) -> Vec3 {
    const ROUNDS: usize = 4;
    for normal in normals.iter().cycle().take(ROUNDS * normals.len()) {
        let inward = way.dot(*normal);
        if inward < 0.0 {
            way -= *normal * inward;
        }
    }
    way
}
