//! Path traversal: how far a bit moves along a path before the volume stops it.
//!
//! A path is divided into steps of a quarter voxel; each is decided by the exact shape of the bit there. A
//! stretch of several steps is first tested as one swept volume, slightly enlarged to cover rounding. If that
//! overlaps nothing, all of its steps are free.

use core::mem;

use super::depth::DepthRuler;
use super::rows::TestedVoxels;
use super::{Obstacle, WayBudget};
use crate::edit::grid_bit::{GridBit, GridShape};
use crate::edit::pose::{Pose, SUBUNITS_PER_VOXEL};
use crate::limits::{EXIT_PROBES, deep_step_cost_in_steps};
use crate::volume::size::{Grid, Size};

impl<const N: usize, const K: usize> Obstacle<'_, N, K>
where
    Grid<N>: Size,
{
    /// Moves the bit along the interpolated path from a pose with its penetration limit there. A bit that
    /// starts too deep may leave the volume at an exit farther along the path.
    pub(super) fn advance_along(
        &self,
        bit: &GridBit,
        (from, mut limit): (&Pose, PenetrationLimit),
        to: &Pose,
        left: &mut WayBudget,
    ) -> PathAdvance {
        let steps = bit.path_steps(from, to);
        let pose_at = |step: u32| from.interpolate(to, step as f32 / steps as f32);
        let mut reached = *from;
        let (mut step, mut stretch) = (0, SHORT_STRETCH);
        while step < steps && !left.is_spent() {
            let last = steps.min(step.saturating_add(left.quarter_voxels));
            let end = (step + stretch).min(last);
            if limit.is_of_bite(bit) {
                left.spend(bit.stretch_cost_in_steps(&reached, &pose_at(end)), 0);
                if self.is_path_surely_free(bit, &reached, &pose_at(end), limit) {
                    left.spend(0, end - step);
                    (step, reached, stretch) = (end, pose_at(end), LONG_STRETCH);
                    continue;
                }
            }
            if stretch == LONG_STRETCH {
                stretch = SHORT_STRETCH;
                continue;
            }
            while step < end && !left.is_spent() {
                step += 1;
                left.spend(if limit.is_of_bite(bit) { 1 } else { deep_step_cost_in_steps(N) }, 1);
                let next = pose_at(step);
                if self.is_allowed(bit, &next, limit) {
                    limit =
                        limit.remeasured_if_too_deep(bit, || self.penetration_limit(bit, &next));
                    reached = next;
                    continue;
                }
                let probes = exit_probe_steps(step, last, left.steps).inspect(|_| left.spend(1, 0));
                let Some(exit) = self.find_exit_step(bit, limit, &reached, probes, pose_at) else {
                    let first_forbidden = Some(next);
                    return PathAdvance { last_allowed: reached, first_forbidden, ran_out: false };
                };
                left.spend(0, exit - step);
                (step, reached, limit) = (exit, pose_at(exit), PenetrationLimit::of_bite(bit));
            }
        }
        PathAdvance { last_allowed: reached, first_forbidden: None, ran_out: step < steps }
    }

    /// Returns the depth allowed at the next step: the bite, or the present depth if greater.
    pub(super) fn penetration_limit(&self, bit: &GridBit, pose: &Pose) -> PenetrationLimit {
        let mut limit = PenetrationLimit::of_bite(bit);
        if self.is_allowed(bit, pose, limit) {
            return limit;
        }
        if let GridShape::Disc { .. } = bit.shape {
            // A disc that is too deep counts as buried, however deep it is.
            return PenetrationLimit { volume: i32::MAX, mask: i32::MAX };
        }
        let ruler = DepthRuler::new(bit, pose);
        self.visit_occupied_rows(&bit.piece_at(pose), |row, inside| {
            limit.volume = limit.volume.max(ruler.deepest_of_row(row, inside));
            if let Some(mask) = self.mask {
                let held = mask.occupied_among(row, inside);
                limit.mask = limit.mask.max(ruler.deepest_of_row(row, held));
            }
        });
        limit
    }

    /// Exit search for a bit that is too deep only at its sides, and whose next step would take it deeper.
    /// Returns the first of the `probe_steps` of the path at which the bit is no deeper than its bite.
    /// Returns `None` if there is none, or if the bit isn't too deep.
    ///
    /// The bit's centre must reach the exit through empty space, so the search ends at the first probe that
    /// it can't reach.
    fn find_exit_step(
        &self,
        bit: &GridBit,
        limit: PenetrationLimit,
        last_allowed: &Pose,
        probe_steps: impl Iterator<Item = u32>,
        pose_at_step: impl Fn(u32) -> Pose,
    ) -> Option<u32> {
        let bite = PenetrationLimit::of_bite(bit);
        if limit.is_of_bite(bit) {
            return None;
        }
        let centre_only = PenetrationLimit { volume: deepest_unburied(bit), ..limit };
        let mut last = *last_allowed;
        let is_reachable = |probe: &u32| {
            let from = mem::replace(&mut last, pose_at_step(*probe));
            self.is_path_surely_free(bit, &from, &last, centre_only)
        };
        let is_exit = |probe: &u32| self.is_allowed(bit, &pose_at_step(*probe), bite);
        probe_steps.take_while(is_reachable).find(is_exit)
    }

    /// Returns `true` if the straight line between two poses may lead the bit's centre through stone. Returns
    /// `false` for a bit whose bite lets its centre into stone anyway; no tool has such a bit.
    pub(super) fn may_cross_stone(&self, bit: &GridBit, from: &Pose, to: &Pose) -> bool {
        let centre_only = PenetrationLimit { volume: deepest_unburied(bit), mask: i32::MAX };
        centre_only.volume >= bit.bite && !self.is_path_surely_free(bit, from, to, centre_only)
    }

    /// Returns `true` if no voxel stops a bit of this limit between two poses of its path. Conservative: the
    /// swept volume is slightly enlarged, so `false` may be wrong, `true` never is.
    fn is_path_surely_free(
        &self,
        bit: &GridBit,
        from: &Pose,
        to: &Pose,
        limit: PenetrationLimit,
    ) -> bool {
        self.is_within_limit(limit, |test| {
            let swept = bit.swept_cover_deeper_than(test.deeper_than_subunits, from, to);
            swept.is_some_and(|brush| self.brush_overlaps(&brush, test.voxels))
        })
    }

    /// Returns `true` if the bit at this pose is no deeper than the limit.
    pub(super) fn is_allowed(&self, bit: &GridBit, pose: &Pose, limit: PenetrationLimit) -> bool {
        self.is_within_limit(limit, |test| {
            bit.piece_deeper_than(test.deeper_than_subunits, pose)
                .is_some_and(|piece| self.piece_overlaps(&piece, test.voxels))
        })
    }

    /// Returns `true` if the part of the bit deeper than the limits overlaps neither the volume nor the mask.
    /// `overlaps` carries out one of the two tests.
    fn is_within_limit(
        &self,
        limit: PenetrationLimit,
        overlaps: impl Fn(PenetrationTest<'_, N, K>) -> bool,
    ) -> bool {
        let of_volume = PenetrationTest {
            deeper_than_subunits: limit.volume,
            voxels: TestedVoxels::AllOccupied,
        };
        let of_mask = |deeper_than_subunits, mask| PenetrationTest {
            deeper_than_subunits,
            voxels: TestedVoxels::OfMask(mask),
        };
        let free_of_mask = |depth| self.mask.is_none_or(|mask| !overlaps(of_mask(depth, mask)));
        match self.is_mask_alone {
            true => free_of_mask(limit.mask.min(limit.volume)),
            false => !overlaps(of_volume) && free_of_mask(limit.mask),
        }
    }
}

/// Returns the steps at which the exit search tests the rest of a path: at most [`EXIT_PROBES`] and
/// `max_probes`, spread evenly over `after_step + 1..=last_step` and including the last. `after_step` is at
/// most `last_step`.
pub fn exit_probe_steps(
    after_step: u32,
    last_step: u32,
    max_probes: u32,
) -> impl Iterator<Item = u32> + use<> {
    let left = last_step - after_step;
    let probes = left.min(EXIT_PROBES).min(max_probes);
    (1..probes + 1).map(move |i| after_step + left * i / probes)
}

/// The result of [`Obstacle::advance_along`].
pub(super) struct PathAdvance {
    /// The last pose of the path that the volume allows.
    pub(super) last_allowed: Pose,
    /// The pose of the next step; `None` if the path or the budget ended first.
    pub(super) first_forbidden: Option<Pose>,
    /// `true` if the budget ended first.
    pub(super) ran_out: bool,
}

/// One test of a bit against its limit: does its part deeper than `deeper_than_subunits` contain one of
/// `voxels`?
struct PenetrationTest<'a, const N: usize, const K: usize> {
    deeper_than_subunits: i32,
    voxels: TestedVoxels<'a, N, K>,
}

impl GridBit {
    /// Returns the steps of a path between two poses: quarter voxels, the sum of the translation and of the
    /// arc of the bit's farthest point. A disc steps by whole voxels along its own plane. At least 1.
    #[must_use]
    pub fn path_steps(&self, from: &Pose, to: &Pose) -> u32 {
        let arc = from.angle_radians_to(to) * self.circumscribed_radius_subunits() as f32
            / SUBUNITS_PER_VOXEL as f32;
        let length = self.stepped_length_voxels(from, to) + arc;
        (libm::ceilf(length * STEPS_PER_VOXEL) as u32).max(1)
    }
}

impl WayBudget {
    pub(super) fn spend(&mut self, steps: u32, quarter_voxels: u32) {
        self.steps = self.steps.saturating_sub(steps);
        self.quarter_voxels = self.quarter_voxels.saturating_sub(quarter_voxels);
    }
}

/// Steps in a voxel's length of path.
pub(super) const STEPS_PER_VOXEL: f32 = 4.0;

/// Steps in the first stretch, which is tested at once at the cost of one step.
pub const SHORT_STRETCH: u32 = 4;

/// Steps in a stretch after a free one.
pub const LONG_STRETCH: u32 = 16;

/// Penetration limit: the maximum depth of voxels in a bit, in fixed point ([`SUBUNITS_PER_VOXEL`] to a
/// voxel).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct PenetrationLimit {
    /// For any voxel.
    pub(super) volume: i32,
    /// For the mask's voxels.
    pub(super) mask: i32,
}

impl PenetrationLimit {
    /// Returns the limit of a bit that isn't too deep: its bite, and nothing in the mask.
    pub(super) const fn of_bite(bit: &GridBit) -> PenetrationLimit {
        PenetrationLimit { volume: bit.bite, mask: 0 }
    }

    fn is_of_bite(self, bit: &GridBit) -> bool {
        self == PenetrationLimit::of_bite(bit)
    }

    /// Returns the limit after a step. A bit that is too deep is measured again at each step.
    fn remeasured_if_too_deep(
        self,
        bit: &GridBit,
        measure: impl FnOnce() -> PenetrationLimit,
    ) -> PenetrationLimit {
        if self.is_of_bite(bit) { self } else { measure() }
    }

    /// Returns `true` if the bit's centre may lie in an occupied voxel.
    pub(super) fn may_bury_centre(self, bit: &GridBit) -> bool {
        self.volume > deepest_unburied(bit).max(bit.bite)
    }
}

/// Returns the greatest depth of a voxel at which the bit's centre is surely in the open, at a step and
/// halfway to the next.
fn deepest_unburied(bit: &GridBit) -> i32 {
    bit.inscribed_radius_subunits() - BURIED_WITHIN
}

/// Distance between a voxel's centre and the bit's centre, in fixed point, within which the bit's centre may
/// lie in the voxel, now or half a step later: half a voxel's diagonal and half a step at right angles to it
/// (224), plus a margin for rounding.
pub const BURIED_WITHIN: i32 = 226;
