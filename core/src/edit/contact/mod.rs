//! Contact: penetration depth of a bit in the volume, and the farthest pose that the volume allows.
//!
//! Source: section 3.1 of the paper. Depth is the largest inner distance of an occupied voxel centre in
//! the bit's analytic shape. A bit may penetrate the volume by its bite, and the mask not at all. All
//! comparisons are made in integers; poses between two ticks are interpolated in floats.
//!
//! No way leads a bit's centre through stone. A bit that was *buried*, its centre in stone, as an undo or
//! another hand's filling may leave it, has no way out: it stands until the pose that its hand asks for is
//! free, and then is there.

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
    /// Largest inner distance of any of them, in fixed point, rounded up; 0 without overlap.
    pub depth: i32,
    /// Sum over the overlapped surface voxels of the directions to their empty six-neighbours,
    /// normalised; zero when there are none or they cancel out.
    pub normal: Vec3,
    /// Whether a mask voxel lies in the bit or within half a voxel of it.
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
    /// Whether the volume stopped the bit. If not, the pose is the wanted one, or where the budget ran out.
    pub blocked: bool,
    /// Whether the budget ran out before the way ended, sliding or not.
    pub ran_out: bool,
    /// Whether the bit was buried and is at the wanted pose without a way: nothing may be swept.
    pub jumped: bool,
    /// Steps spent of the budget.
    pub steps: u32,
}

/// How far a bit may go.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct WayBudget {
    /// Steps, of which a stretch that is tried at once costs one; see [`crate::limits::max_bit_steps_per_tick`].
    pub steps: u32,
    /// Length of the way in quarter voxels, free or not.
    pub quarter_voxels: u32,
}

impl WayBudget {
    /// So many steps, of any length.
    #[must_use]
    pub const fn of_steps(steps: u32) -> Self {
        WayBudget { steps, quarter_voxels: u32::MAX }
    }

    /// Whether nothing is left.
    const fn is_spent(self) -> bool {
        self.steps == 0 || self.quarter_voxels == 0
    }
}

/// How much steeper than the plane that stopped it a bit's next slide leads out of the stone, the first and each that
/// follows: of several voxels that stopped it, the plane is the mean.
const LIFT: f32 = 0.125;

/// Where [`Obstacle::move_and_slide`] took a bit.
struct SlideResult {
    pose: Pose,
    /// Whether the volume stopped the bit.
    blocked: bool,
    /// Whether the budget ran out.
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
    /// The part of it that can't be removed; `None` where there is no mask.
    pub mask: Option<&'a RangeMaps<N, K>>,
    /// Whether the mask is all that bits collide with, as it is for a nozzle that runs.
    pub is_mask_alone: bool,
}

impl<const N: usize, const K: usize> Obstacle<'_, N, K>
where
    Grid<N>: Size,
{
    /// The contact of the bit at a pose in the grid. A disc that is too deep overlaps, and is as deep as its middle;
    /// to count and to find a normal would take more of a tick than all else.
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

    /// The depth of a disc's middle, where a voxel lies deeper in it than its bite. `None` for other bits.
    fn depth_of_too_deep_disc(&self, bit: &GridBit, pose: &Pose) -> Option<i32> {
        let most = bit.disc_middle_depth_subunits()?;
        let core = bit.piece_deeper_than(bit.bite, pose)?;
        self.piece_overlaps(&core, TestedVoxels::AllOccupied).then_some(most)
    }

    /// [`Contact::normal`] alone.
    fn normal_at(&self, bit: &GridBit, pose: &Pose) -> Vec3 {
        let mut normal = IVec3::ZERO;
        self.visit_occupied_rows(&bit.piece_at(pose), |row, inside| {
            normal += self.sum_directions_to_empty(row, inside);
        });
        normal.as_vec3().normalize_or_zero()
    }

    /// Move and slide: moves the bit along the path as far as its penetration limit allows, then slides
    /// it once along the tangent plane of the surface that stopped it. If that slide doesn't move it
    /// (the side of a bump whose top is flat), it slides perpendicular to the direction from the
    /// blocking voxels to its centre. A bit that is too deep already may only move without going
    /// deeper, or leave the volume at an exit farther along the path; a buried one stands, or jumps.
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

    /// The same without sliding: the bit stands where the volume stops it, before the stone that its next bite
    /// takes.
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

    /// Whether the bit is too deep and a voxel's centre so near its own that this may lie in that voxel.
    #[must_use]
    pub fn buries(&self, bit: &GridBit, pose: &Pose) -> bool {
        self.penetration_limit(bit, pose).may_bury_centre(bit)
    }

    /// The freeze of a bit without a way: at the wanted pose if its bite allows that, else where it was.
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

    /// Moves, and slides where the bit is stopped.
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
        // What is swept is the straight way from where the bit was, which a way round a corner isn't.
        match self.may_cross_stone(bit, from, &slide.last_allowed) {
            true => SlideResult { pose: reached, blocked: true, ran_out: false },
            false => {
                SlideResult { pose: slide.last_allowed, blocked: true, ran_out: slide.ran_out }
            }
        }
    }

    /// Collide and slide: the bit goes on along the tangent plane of the surface that stopped it, and, where it is
    /// stopped again, along all the planes so far, up to [`MAX_SLIDES`] times. One plane alone would lead it from one
    /// stair of a voxel to the next and back, and leave it standing in the dimple between them. How deep its hand is
    /// doesn't count: the bit would else not climb a stair that is steeper than the way to its hand.
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

    /// Moves a bit that was stopped along the tangent plane of all that it overlaps, of this unit normal or none.
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

    /// The mean unit direction to the bit's centre from the voxels that forbid the pose `forbidden` to a bit of this
    /// limit; zero if they cancel out.
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

/// What planes of these unit normals leave of a way that may lead through none of them: its projection on the cone of
/// directions that all of them allow, by rounds of projections on one after the other.
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
