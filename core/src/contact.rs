//! Contact: how deep a bit sits in the volume, and the farthest pose that it may take.
//!
//! Source: section 3.1 of the paper. Depth is the largest inner distance, in the bit's analytic
//! shape, of any occupied voxel centre; a bit may sit as deep as its bite, and not at all in the
//! mask. All comparisons are in integers; poses between two ticks are interpolated in floats.

use glam::{IVec3, Vec3};

use crate::brush::{Brush, Capsule, Piece, SweptBox, centre, isqrt};
use crate::maps::Maps;
use crate::plane::Plane;
use crate::pose::{Pose, SUB, UNIT};
use crate::row::Bits;
use crate::size::{Grid, Size};
use crate::tools::{GridBit, GridShape};

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
    /// Whether it was held back.
    pub blocked: bool,
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
    pub fn brush(&self, pose: &Pose) -> Brush {
        match self.shape {
            GridShape::Ball(radius) => Brush::sphere(pose.fixed_position(), radius),
            GridShape::Box(half) => Brush::oriented_box(half, pose),
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
        self.each_row(&bit.brush(pose), |y, z, inside| {
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
    /// grow.
    #[must_use]
    pub fn freeze(&self, bit: &GridBit, from: &Pose, raw: &Pose) -> Frozen {
        let (reached, stop) = self.advance(bit, from, raw);
        let Some(stop) = stop else {
            return Frozen { pose: reached, blocked: false };
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
        let (mut pose, _) = self.advance(bit, &reached, &target);
        let wanted = (target.position - reached.position) * STEPS_PER_VOXEL;
        if pose.position == reached.position && wanted.length_squared() > 1.0 {
            let away = self.away_from_stop(bit, &reached, &stop);
            let inward = left.dot(away);
            let tangent = if inward < 0.0 { left - away * inward } else { left };
            let target = Pose { position: reached.position + tangent, ..reached };
            pose = self.advance(bit, &reached, &target).0;
        }
        Frozen { pose, blocked: true }
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

    /// The last allowed pose on the straight path, and the first that isn't. A bit that sits with
    /// its centre in the stone would be held by every voxel it has to pass: it comes out where the
    /// path first does.
    fn advance(&self, bit: &GridBit, from: &Pose, to: &Pose) -> (Pose, Option<Pose>) {
        let outer = bit.outer_radius();
        let turn = from.angle_to(to) * outer as f32 / SUB as f32;
        let length = (to.position - from.position).length() + turn;
        let steps = (libm::ceilf(length * STEPS_PER_VOXEL) as u32).max(1);
        let mut limit = self.limit(bit, from);
        let mut reached = *from;
        let mut i = 0;
        while i < steps {
            let ahead = (i + STRIDE).min(steps);
            let at = |i: u32| from.toward(to, i as f32 / steps as f32);
            let far = at(ahead);
            let (a, b) = (reached.fixed_position(), far.fixed_position());
            if !self.touches(&Brush::capsule(a, b, outer + SUB)) {
                (i, reached) = (ahead, far);
                limit = Limit::usual(bit);
                continue;
            }
            while i < ahead {
                i += 1;
                let next = at(i);
                if self.allows(bit, &next, limit) {
                    limit = limit.after(bit, || self.limit(bit, &next));
                    reached = next;
                    continue;
                }
                let free = |i: &u32| self.allows(bit, &at(*i), Limit::usual(bit));
                let Some(out) = limit.is_buried(bit).then(|| (i + 1..=steps).find(free)).flatten()
                else {
                    return (reached, Some(next));
                };
                (i, reached, limit) = (out, at(out), Limit::usual(bit));
            }
        }
        (reached, None)
    }

    /// How deep the bit may sit next: its bite, or as deep as it sits already.
    fn limit(&self, bit: &GridBit, pose: &Pose) -> Limit {
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
    fn each_depth(
        &self,
        bit: &GridBit,
        pose: &Pose,
        mut each: impl FnMut(glam::I64Vec3, i32, bool),
    ) {
        let (position, axes) = (pose.fixed_position().as_i64vec3(), pose.fixed_axes());
        self.each_row(&bit.brush(pose), |y, z, inside| {
            let held = self.mask.map(|mask| mask.row_among((y, z), inside));
            for x in inside.ones() {
                let p = glam::I64Vec3::new(centre(x), centre(y), centre(z)) - position;
                let held = held.is_some_and(|held| held.contains(x));
                each(p, bit.inner_distance_of(&axes, p), held);
            }
        });
    }

    fn allows(&self, bit: &GridBit, pose: &Pose, limit: Limit) -> bool {
        let clear = |level, hit: &dyn Fn(&Piece) -> bool| {
            bit.deeper_than(level, pose).is_none_or(|piece| !hit(&piece))
        };
        clear(limit.volume, &|piece| self.hits(piece, |_, inside| inside))
            && self.mask.is_none_or(|mask| {
                clear(limit.mask, &|piece| {
                    self.hits(piece, |row, inside| mask.row_among(row, inside))
                })
            })
    }

    fn near_mask(&self, bit: &GridBit, pose: &Pose) -> bool {
        let (Some(mask), Some(piece)) = (self.mask, bit.deeper_than(-SUB, pose)) else {
            return false;
        };
        self.hits(&piece, |row, inside| mask.row_among(row, inside))
    }

    fn touches(&self, brush: &Brush) -> bool {
        brush.pieces().any(|piece| self.hits(&piece, |_, inside| inside))
    }

    /// Whether a piece holds a voxel that is occupied and in what `among` leaves of its row.
    fn hits(
        &self,
        piece: &Piece,
        among: impl Fn((usize, usize), <Grid<N> as Size>::Row) -> <Grid<N> as Size>::Row,
    ) -> bool {
        let Some(bounds) = piece.bounds(N) else {
            return false;
        };
        let within: <Grid<N> as Size>::Row = Bits::span(bounds.lo[0], bounds.hi[0]);
        (bounds.lo[1]..=bounds.hi[1]).any(|y| {
            (bounds.lo[2]..=bounds.hi[2]).any(|z| {
                let near = self.rows.row(y, z) & within;
                if near.is_empty() {
                    return false;
                }
                let Some((lo, hi)) = piece.span(y, z, N) else {
                    return false;
                };
                let inside = near & Bits::span(lo, hi);
                !inside.is_empty() && !among((y, z), inside).is_empty()
            })
        })
    }

    /// Calls `each` with the occupied voxels of a brush, row by row.
    fn each_row(&self, brush: &Brush, mut each: impl FnMut(usize, usize, <Grid<N> as Size>::Row)) {
        let Some(bounds) = brush.bounds(N) else {
            return;
        };
        let within: <Grid<N> as Size>::Row = Bits::span(bounds.lo[0], bounds.hi[0]);
        for y in bounds.lo[1]..=bounds.hi[1] {
            for z in bounds.lo[2]..=bounds.hi[2] {
                let near = self.rows.row(y, z) & within;
                if near.is_empty() {
                    continue;
                }
                let inside = near & brush.row::<N>(y, z);
                if !inside.is_empty() {
                    each(y, z, inside);
                }
            }
        }
    }

    /// The sum of the directions from voxels of a row to their empty six-neighbours.
    fn empty_directions(&self, y: usize, z: usize, of: <Grid<N> as Size>::Row) -> IVec3 {
        let empty = |row: Option<<Grid<N> as Size>::Row>| match row {
            Some(row) => (of & !row).count() as i32,
            None => of.count() as i32,
        };
        let row = |y: usize, z: usize| (y < N && z < N).then(|| self.rows.row(y, z));
        let here = self.rows.row(y, z);
        IVec3::new(
            empty(Some(here.down())) - empty(Some(here.up())),
            empty(row(y + 1, z)) - empty(row(y.wrapping_sub(1), z)),
            empty(row(y, z + 1)) - empty(row(y, z.wrapping_sub(1))),
        )
    }
}

/// Steps of a quarter voxel.
const STEPS_PER_VOXEL: f32 = 4.0;

/// Steps that are skipped at once where nothing is near.
const STRIDE: u32 = 16;

/// How deep a bit may sit, in fixed point.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
struct Limit {
    volume: i32,
    mask: i32,
}

impl Limit {
    /// That of a bit which isn't too deep.
    const fn usual(bit: &GridBit) -> Limit {
        Limit { volume: bit.bite, mask: 0 }
    }

    /// The limit after a step: once a bit is too deep, every step measures anew.
    fn after(self, bit: &GridBit, measure: impl FnOnce() -> Limit) -> Limit {
        if self == Limit::usual(bit) { self } else { measure() }
    }

    /// Whether the bit's centre is too deep, and as near to a voxel's centre as only points in a
    /// voxel are.
    fn is_buried(self, bit: &GridBit) -> bool {
        self != Limit::usual(bit) && self.volume > bit.inner_radius() - HALF_DIAGONAL
    }
}

/// Half a voxel's diagonal in fixed point, rounded up.
const HALF_DIAGONAL: i32 = 222;
