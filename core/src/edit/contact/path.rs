//! Path traversal: how far a bit moves along a path before the volume stops it.
//!
//! A path is cut into steps of a quarter voxel; each is decided by the exact shape of the bit there. A
//! stretch of several steps is first tested as one swept volume, slightly enlarged to cover rounding.
//! If that touches nothing, all of its steps are free.

use core::mem;

use glam::I64Vec3;

use super::Obstacle;
use crate::edit::brush::voxel_centre;
use crate::edit::grid_bit::GridBit;
use crate::edit::pose::{Pose, SUBUNITS_PER_VOXEL};
use crate::limits::{EXIT_PROBES, deep_step_cost};
use crate::volume::range_maps::RangeMaps;
use crate::volume::row::BitSet;
use crate::volume::size::{Grid, Size};

impl<const N: usize> Obstacle<'_, N>
where
    Grid<N>: Size,
{
    /// Moves the bit along the interpolated path. Returns the last allowed pose and the first
    /// forbidden one, `None` where the end of the path or of the step budget comes first. A bit that
    /// starts too deep may leave the volume at an exit farther along the path.
    ///
    /// `steps_left` is the remaining budget in steps; a free stretch costs one.
    pub(super) fn advance_along(
        &self,
        bit: &GridBit,
        from: &Pose,
        to: &Pose,
        steps_left: &mut u32,
    ) -> (Pose, Option<Pose>) {
        let arc = from.angle_to(to) * bit.outer_radius() as f32 / SUBUNITS_PER_VOXEL as f32;
        let length = (to.position - from.position).length() + arc;
        let steps = (libm::ceilf(length * STEPS_PER_VOXEL) as u32).max(1);
        let pose_at = |step: u32| from.interpolate(to, step as f32 / steps as f32);
        let (mut reached, mut limit) = (*from, self.penetration_limit(bit, from));
        let (mut step, mut stretch) = (0, SHORT_STRETCH);
        while step < steps && *steps_left > 0 {
            let end = (step + stretch).min(steps);
            if limit.is_of_bite(bit)
                && self.is_path_surely_free(bit, &reached, &pose_at(end), limit)
            {
                *steps_left -= 1;
                (step, reached, stretch) = (end, pose_at(end), LONG_STRETCH);
                continue;
            }
            if stretch == LONG_STRETCH {
                stretch = SHORT_STRETCH;
                continue;
            }
            while step < end && *steps_left > 0 {
                step += 1;
                let cost = if limit.is_of_bite(bit) { 1 } else { deep_step_cost(N) };
                *steps_left = steps_left.saturating_sub(cost);
                let next = pose_at(step);
                if self.is_allowed(bit, &next, limit) {
                    limit = limit.after_step(bit, || self.penetration_limit(bit, &next));
                    reached = next;
                    continue;
                }
                let probes = exit_probes(step, steps);
                let Some(exit) = self.find_exit(bit, limit, &reached, probes, pose_at) else {
                    return (reached, Some(next));
                };
                (step, reached, limit) = (exit, pose_at(exit), PenetrationLimit::of_bite(bit));
            }
        }
        (reached, None)
    }

    /// The depth allowed at the next step: the bite, or the present depth where that is greater.
    pub(super) fn penetration_limit(&self, bit: &GridBit, pose: &Pose) -> PenetrationLimit {
        let mut limit = PenetrationLimit::of_bite(bit);
        if self.is_allowed(bit, pose, limit) {
            return limit;
        }
        self.for_each_depth(bit, pose, |_, depth, masked| {
            limit.volume = limit.volume.max(depth);
            if masked {
                limit.mask = limit.mask.max(depth);
            }
        });
        limit
    }

    /// Calls `each` for every occupied voxel centre in the bit with its offset from the bit's centre
    /// and its depth in the bit, both in fixed point, and whether the mask protects it.
    pub(super) fn for_each_depth(
        &self,
        bit: &GridBit,
        pose: &Pose,
        mut each: impl FnMut(I64Vec3, i32, bool),
    ) {
        let (position, axes) = (pose.fixed_position().as_i64vec3(), pose.fixed_axes());
        self.for_each_row(&bit.piece_at(pose), |y, z, inside| {
            let held = self.mask.map(|mask| mask.occupied_among((y, z), inside));
            for x in inside.iter_ones() {
                let p = I64Vec3::new(voxel_centre(x), voxel_centre(y), voxel_centre(z)) - position;
                let held = held.is_some_and(|held| held.contains(x));
                each(p, bit.inner_distance(&axes, p), held);
            }
        });
    }

    /// Exit search for a bit that is too deep and whose next step would take it deeper: the first of
    /// the `probes` (steps of the path) at which the bit sits no deeper than its bite. `None` where
    /// there is none, or where the bit isn't too deep.
    ///
    /// A bit whose centre lies outside the material is stopped by its sides alone. Its centre must
    /// reach the exit through empty space, so the search ends at the first probe that it can't reach.
    fn find_exit(
        &self,
        bit: &GridBit,
        limit: PenetrationLimit,
        reached: &Pose,
        mut probes: impl Iterator<Item = u32>,
        pose_at: impl Fn(u32) -> Pose,
    ) -> Option<u32> {
        let bite = PenetrationLimit::of_bite(bit);
        let is_exit = |probe: &u32| self.is_allowed(bit, &pose_at(*probe), bite);
        if limit.is_of_bite(bit) {
            return None;
        }
        if limit.is_buried(bit) {
            return probes.find(is_exit);
        }
        let centre_only = PenetrationLimit { volume: bit.inner_radius() - HALF_DIAGONAL, ..limit };
        let mut last = *reached;
        let is_reachable = |probe: &u32| {
            let from = mem::replace(&mut last, pose_at(*probe));
            self.is_path_surely_free(bit, &from, &last, centre_only)
        };
        probes.take_while(is_reachable).find(is_exit)
    }

    /// Whether no voxel stops a bit of this limit between two poses of its path. Conservative: the
    /// swept volume is slightly enlarged, so `false` may be wrong, `true` never is.
    fn is_path_surely_free(
        &self,
        bit: &GridBit,
        from: &Pose,
        to: &Pose,
        limit: PenetrationLimit,
    ) -> bool {
        self.is_clear(limit, |level, mask| {
            let swept = bit.swept_brush_deeper_than(level, from, to);
            swept.is_some_and(|brush| self.brush_hits(&brush, mask))
        })
    }

    /// Whether the bit, at this pose, sits no deeper than the limit.
    fn is_allowed(&self, bit: &GridBit, pose: &Pose, limit: PenetrationLimit) -> bool {
        self.is_clear(limit, |level, mask| {
            bit.piece_deeper_than(level, pose).is_some_and(|piece| self.piece_hits(&piece, mask))
        })
    }

    /// Whether the part of the bit deeper than the limits meets neither the volume nor the mask.
    /// `meets` takes a depth in fixed point, and the mask for the second test.
    fn is_clear(
        &self,
        limit: PenetrationLimit,
        meets: impl Fn(i32, Option<&RangeMaps<N>>) -> bool,
    ) -> bool {
        !meets(limit.volume, None) && self.mask.is_none_or(|mask| !meets(limit.mask, Some(mask)))
    }
}

/// The steps at which the exit search tests the rest of a path: at most [`EXIT_PROBES`], spread evenly
/// over `step + 1..=steps`, the last step among them. `step` is at most `steps`.
pub fn exit_probes(step: u32, steps: u32) -> impl Iterator<Item = u32> {
    let left = steps - step;
    let probes = left.min(EXIT_PROBES);
    (1..probes + 1).map(move |i| step + left * i / probes)
}

/// Steps in a voxel's length of path.
pub(super) const STEPS_PER_VOXEL: f32 = 4.0;

/// Steps in the first stretch, which is tested at once and costs as much as one step.
pub const SHORT_STRETCH: u32 = 4;

/// Steps in a stretch that follows a free one.
pub const LONG_STRETCH: u32 = 16;

/// Penetration limit: how deep voxels may lie in a bit, in fixed point ([`SUBUNITS_PER_VOXEL`] to a voxel).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct PenetrationLimit {
    /// For any voxel.
    pub(super) volume: i32,
    /// For the mask's voxels.
    pub(super) mask: i32,
}

impl PenetrationLimit {
    /// The limit of a bit that isn't too deep: its bite, and nothing in the mask.
    const fn of_bite(bit: &GridBit) -> PenetrationLimit {
        PenetrationLimit { volume: bit.bite, mask: 0 }
    }

    fn is_of_bite(self, bit: &GridBit) -> bool {
        self == PenetrationLimit::of_bite(bit)
    }

    /// The limit after a step. A bit that is too deep is measured again at each step.
    fn after_step(
        self,
        bit: &GridBit,
        measure: impl FnOnce() -> PenetrationLimit,
    ) -> PenetrationLimit {
        if self.is_of_bite(bit) { self } else { measure() }
    }

    /// Whether the bit's centre may lie in an occupied voxel: some voxel's centre is within half a
    /// diagonal of it.
    fn is_buried(self, bit: &GridBit) -> bool {
        !self.is_of_bite(bit) && self.volume > bit.inner_radius() - HALF_DIAGONAL
    }
}

/// Half a voxel's diagonal in fixed point, rounded up.
const HALF_DIAGONAL: i32 = 222;
