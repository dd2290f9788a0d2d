//! The walk: how far a bit gets on its way, and where it is stopped.
//!
//! Every step is decided by the bit as it is there. But where nothing meets the bit as swept over a
//! stretch of steps, and a little wider for what poses are rounded by, they are all free at once.

use glam::{I64Vec3, IVec3};

use super::Obstacle;
use crate::brush::{Brush, centre};
use crate::limits::{DEEP_STEPS, LOOKS};
use crate::maps::Maps;
use crate::pose::{Pose, SUB};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::tools::{GridBit, GridShape};

impl<const N: usize> Obstacle<'_, N>
where
    Grid<N>: Size,
{
    /// The last allowed pose on the straight path, and the first that isn't. A bit that sits with
    /// its centre in the stone would be held by every voxel it has to pass: it comes out where the
    /// path first does. It walks on while steps are `left`.
    pub(super) fn advance(
        &self,
        bit: &GridBit,
        from: &Pose,
        to: &Pose,
        left: &mut u32,
    ) -> (Pose, Option<Pose>) {
        let turn = from.angle_to(to) * bit.outer_radius() as f32 / SUB as f32;
        let length = (to.position - from.position).length() + turn;
        let steps = (libm::ceilf(length * STEPS_PER_VOXEL) as u32).max(1);
        let at = |i: u32| from.toward(to, i as f32 / steps as f32);
        let (mut reached, mut limit) = (*from, self.limit(bit, from));
        let mut i = 0;
        while i < steps && *left > 0 {
            let mut stretches = STRETCHES.iter().map(|stretch| (i + stretch).min(steps));
            if let Some(end) = stretches.find(|&end| self.is_free(bit, &reached, &at(end), limit)) {
                *left -= 1;
                (i, reached) = (end, at(end));
                continue;
            }
            let end = (i + STRETCHES[STRETCHES.len() - 1]).min(steps);
            while i < end && *left > 0 {
                i += 1;
                *left = left.saturating_sub(limit.steps(bit));
                let next = at(i);
                if self.allows(bit, &next, limit) {
                    limit = limit.after(bit, || self.limit(bit, &next));
                    reached = next;
                    continue;
                }
                let is_out = |i: &u32| self.allows(bit, &at(*i), Limit::usual(bit));
                let ahead = limit.is_buried(bit).then(|| looks(i, steps).find(is_out));
                let Some(out) = ahead.flatten() else {
                    return (reached, Some(next));
                };
                (i, reached, limit) = (out, at(out), Limit::usual(bit));
            }
        }
        (reached, None)
    }

    /// How deep the bit may sit next: its bite, or as deep as it sits already.
    pub(super) fn limit(&self, bit: &GridBit, pose: &Pose) -> Limit {
        let mut limit = Limit::usual(bit);
        if self.allows(bit, pose, limit) {
            return limit;
        }
        self.each_depth(bit, pose, |_, depth, held| {
            limit.volume = limit.volume.max(depth);
            if held {
                limit.mask = limit.mask.max(depth);
            }
        });
        limit
    }

    /// Calls `each` for every occupied voxel in the bit: where it is from the bit's centre, how deep
    /// inside, and whether the mask holds it.
    pub(super) fn each_depth(
        &self,
        bit: &GridBit,
        pose: &Pose,
        mut each: impl FnMut(I64Vec3, i32, bool),
    ) {
        let (position, axes) = (pose.fixed_position().as_i64vec3(), pose.fixed_axes());
        self.each_row(&bit.piece(pose), |y, z, inside| {
            let held = self.mask.map(|mask| mask.row_among((y, z), inside));
            for x in inside.ones() {
                let p = I64Vec3::new(centre(x), centre(y), centre(z)) - position;
                let held = held.is_some_and(|held| held.contains(x));
                each(p, bit.inner_distance_of(&axes, p), held);
            }
        });
    }

    /// Whether a bit that isn't too deep can't be stopped between two poses of its path: nothing is
    /// there that would.
    fn is_free(&self, bit: &GridBit, from: &Pose, to: &Pose, limit: Limit) -> bool {
        limit.is_usual(bit)
            && self.is_clear(limit, |level, mask| {
                let swept = bit.swept_deeper_than(level, from, to);
                swept.is_some_and(|brush| self.touches(&brush, mask))
            })
    }

    fn allows(&self, bit: &GridBit, pose: &Pose, limit: Limit) -> bool {
        self.is_clear(limit, |level, mask| {
            bit.deeper_than(level, pose).is_some_and(|piece| self.hits(&piece, mask))
        })
    }

    /// Whether what is deeper than the limits meets neither the volume nor, if there is one, the mask.
    fn is_clear(&self, limit: Limit, meets: impl Fn(i32, Option<&Maps<N>>) -> bool) -> bool {
        !meets(limit.volume, None) && self.mask.is_none_or(|mask| !meets(limit.mask, Some(mask)))
    }
}

impl GridBit {
    /// No fewer than the points that are deeper inside the bit than `level` (fixed point) at any step
    /// of its path from one pose to another. `None` if there are none.
    #[must_use]
    pub fn swept_deeper_than(&self, level: i32, from: &Pose, to: &Pose) -> Option<Brush> {
        let shape = match self.shape {
            GridShape::Ball(radius) => {
                let left = radius - level;
                (left > 0).then_some(GridShape::Ball(left + ROUNDING))
            }
            GridShape::Box(half) => {
                let left = half - IVec3::splat(level);
                // A piece of a sweep is turned as at its middle: corners are off by half its turn.
                let turn = left.as_vec3().length() * from.angle_to(to);
                let pieces = libm::ceilf(turn / SUB as f32).max(1.0);
                let wider = ROUNDING + libm::ceilf(turn / pieces / 2.0) as i32;
                (left.min_element() > 0).then_some(GridShape::Box(left + wider))
            }
        };
        Some(GridBit { shape: shape?, ..*self }.swept_brush(from, to))
    }
}

/// The steps after `i`, of so many, at which a bit in the stone looks for the way out: spread evenly
/// over the rest of the way, its end among them.
pub fn looks(i: u32, steps: u32) -> impl Iterator<Item = u32> {
    let looks = (steps - i).min(LOOKS);
    (1..looks + 1).map(move |look| i + (steps - i) * look / looks)
}

/// Steps of a quarter voxel.
pub(super) const STEPS_PER_VOXEL: f32 = 4.0;

/// Steps that are tried at once, and count as one.
pub const STRETCHES: [u32; 2] = [16, 4];

/// How far a step's pose may lie beside the path between two others, in fixed point, and more.
const ROUNDING: i32 = SUB / 16;

/// How deep a bit may sit, in fixed point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct Limit {
    pub(super) volume: i32,
    pub(super) mask: i32,
}

impl Limit {
    /// That of a bit which isn't too deep.
    const fn usual(bit: &GridBit) -> Limit {
        Limit { volume: bit.bite, mask: 0 }
    }

    fn is_usual(self, bit: &GridBit) -> bool {
        self == Limit::usual(bit)
    }

    /// The limit after a step: once a bit is too deep, every step measures anew.
    fn after(self, bit: &GridBit, measure: impl FnOnce() -> Limit) -> Limit {
        if self.is_usual(bit) { self } else { measure() }
    }

    /// The steps that the next one counts as: those of a bit that is too deep are dear.
    fn steps(self, bit: &GridBit) -> u32 {
        if self.is_usual(bit) { 1 } else { DEEP_STEPS }
    }

    /// Whether the bit's centre is too deep, and as near to a voxel's centre as only points in a
    /// voxel are.
    fn is_buried(self, bit: &GridBit) -> bool {
        !self.is_usual(bit) && self.volume > bit.inner_radius() - HALF_DIAGONAL
    }
}

/// Half a voxel's diagonal in fixed point, rounded up.
const HALF_DIAGONAL: i32 = 222;
