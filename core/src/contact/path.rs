//! The walk: how far a bit gets on its way, and where it is stopped.
//!
//! Every step is decided by the bit as it is there. But where nothing meets the bit as swept over a
//! stretch of steps, and a little wider for what poses are rounded by, they are all free at once.

use core::mem;

use glam::{I64Vec3, IVec3};

use super::Obstacle;
use crate::brush::{Brush, centre};
use crate::limits::{LOOKS, deep_steps};
use crate::maps::Maps;
use crate::pose::{Pose, SUB};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::tools::{GridBit, GridShape};

impl<const N: usize> Obstacle<'_, N>
where
    Grid<N>: Size,
{
    /// The last allowed pose on the straight path, and the first that isn't. A bit that is too deep
    /// would be held by every voxel it has to pass: it comes out where the path does. It walks on
    /// while steps are `left`.
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
        let (mut i, mut stretch) = (0, SHORT_STRETCH);
        while i < steps && *left > 0 {
            let end = (i + stretch).min(steps);
            if limit.is_usual(bit) && self.is_free(bit, &reached, &at(end), limit) {
                *left -= 1;
                (i, reached, stretch) = (end, at(end), LONG_STRETCH);
                continue;
            }
            if stretch == LONG_STRETCH {
                stretch = SHORT_STRETCH;
                continue;
            }
            while i < end && *left > 0 {
                i += 1;
                *left = left.saturating_sub(if limit.is_usual(bit) { 1 } else { deep_steps(N) });
                let next = at(i);
                if self.allows(bit, &next, limit) {
                    limit = limit.after(bit, || self.limit(bit, &next));
                    reached = next;
                    continue;
                }
                let Some(out) = self.way_out(bit, limit, &reached, looks(i, steps), at) else {
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

    /// Where a bit that is too deep, and would get deeper with its next step, is out of the stone: at
    /// the first of these looks. One whose centre isn't in the stone is held by its sides alone, which
    /// catch at every voxel that they pass: its centre must get there through the open.
    fn way_out(
        &self,
        bit: &GridBit,
        limit: Limit,
        reached: &Pose,
        mut looks: impl Iterator<Item = u32>,
        at: impl Fn(u32) -> Pose,
    ) -> Option<u32> {
        let is_out = |look: &u32| self.allows(bit, &at(*look), Limit::usual(bit));
        if limit.is_usual(bit) {
            return None;
        }
        if limit.is_buried(bit) {
            return looks.find(is_out);
        }
        let open = Limit { volume: bit.inner_radius() - HALF_DIAGONAL, ..limit };
        let mut last = *reached;
        let is_open = |look: &u32| {
            let from = mem::replace(&mut last, at(*look));
            self.is_free(bit, &from, &last, open)
        };
        looks.take_while(is_open).find(is_out)
    }

    /// Whether nothing is there that would stop a bit with this limit between two poses of its path.
    fn is_free(&self, bit: &GridBit, from: &Pose, to: &Pose, limit: Limit) -> bool {
        self.is_clear(limit, |level, mask| {
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

/// Steps that are tried at once, and count as one: so many first,
pub const SHORT_STRETCH: u32 = 4;

/// and so many after a stretch in which nothing was met.
pub const LONG_STRETCH: u32 = 16;

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

    /// Whether the bit's centre is too deep, and as near to a voxel's centre as only points in a
    /// voxel are.
    fn is_buried(self, bit: &GridBit) -> bool {
        !self.is_usual(bit) && self.volume > bit.inner_radius() - HALF_DIAGONAL
    }
}

/// Half a voxel's diagonal in fixed point, rounded up.
const HALF_DIAGONAL: i32 = 222;
