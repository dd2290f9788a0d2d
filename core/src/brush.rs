//! Brushes: convex pieces whose voxels in a row are one interval, found in integers.
//!
//! A voxel is in a brush when its centre is, boundary included. Source: section 3 of the paper
//! (spherical and rectangular cutters), swept here along the tool's path.

use glam::{I64Vec3, IVec3};
use heapless::Vec;

use crate::limits::SWEEP_PIECES;
use crate::maps::Range;
use crate::pose::{Pose, SUB, UNIT};
use crate::row::Bits;
use crate::size::{Grid, Size};

/// A sphere of `radius` swept from `a` to `b`, in fixed point. `radius_squared` may be a little
/// less than the square of a whole radius: "strictly inside".
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Capsule {
    /// One end of the path.
    pub a: IVec3,
    /// The other end; the same for a plain sphere.
    pub b: IVec3,
    /// Greatest squared distance from the path.
    pub radius_squared: i64,
}

/// An oriented box swept along a straight line: the points `p` with `|plane . (2p - middle)| <=
/// extent` for its six pairs of planes.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct SweptBox {
    /// Twice the middle of the path, in fixed point.
    pub middle: IVec3,
    /// Normals and extents: three faces of the box, three that the sweep adds.
    pub planes: [([i64; 3], i64); 6],
    /// Half extents along the grid's axes, in fixed point, rounded up.
    pub reach: IVec3,
    /// The box's three edges and the path, in fixed point: sums of up to so much of each, forward
    /// or back, are all of `2p - middle`, but for `slack` either way.
    edges: [[i64; 3]; 4],
    slack: i64,
}

/// A convex part of a brush.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to box the larger on")]
pub enum Piece {
    /// A swept sphere.
    Capsule(Capsule),
    /// A swept oriented box.
    Box(SweptBox),
}

/// The rows a brush can touch, ends included.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Bounds {
    /// First and last voxel along x, y, z.
    pub lo: [usize; 3],
    /// See `lo`.
    pub hi: [usize; 3],
}

/// A union of convex pieces, described in few bytes.
///
/// Coordinates beyond 8,192 voxels from the grid's corner are held there, and negative radii and
/// half extents are none: every product of two lengths then stays in its integer.
#[derive(Clone, Debug)]
pub struct Brush(Shape);

#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to box the larger on")]
enum Shape {
    One(Piece),
    Sweep { half: IVec3, from: Pose, to: Pose, turns: usize },
}

/// A brush's pieces, worked out once, and the rows that they touch of the layer at hand.
#[derive(Debug)]
pub struct Pieces {
    all: Vec<Piece, SWEEP_PIECES, u8>,
    y: usize,
    layer: Vec<(u8, Range), SWEEP_PIECES, u8>,
}

impl Brush {
    /// A sphere; centre and radius in fixed point.
    #[must_use]
    pub fn sphere(centre: IVec3, radius: i32) -> Self {
        Self::capsule(centre, centre, radius)
    }

    /// A sphere swept from `a` to `b`: a fast stroke leaves no dots.
    #[must_use]
    pub fn capsule(a: IVec3, b: IVec3, radius: i32) -> Self {
        let radius = i64::from(radius.clamp(0, FAR));
        let (a, b) = (held(a), held(b));
        Brush(Shape::One(Piece::Capsule(Capsule { a, b, radius_squared: radius * radius })))
    }

    /// A box of half extents `half` (fixed point) about a pose.
    #[must_use]
    pub fn oriented_box(half: IVec3, pose: &Pose) -> Self {
        Brush(Shape::One(Piece::Box(SweptBox::new(half, pose, pose.fixed_position()))))
    }

    /// A box swept from one pose to another. Its turn is cut into sub-steps in which no corner
    /// moves more than one voxel; a piece is the box as turned at one of the times between (the
    /// two ends included), moved straight from half a sub-step before to half a sub-step after. At
    /// most [`SWEEP_PIECES`], which is half a turn of the largest bit.
    #[must_use]
    pub fn swept_box(half: IVec3, from: &Pose, to: &Pose) -> Self {
        if from.fixed_axes() == to.fixed_axes() {
            let piece = SweptBox::new(half, to, from.fixed_position());
            return Brush(Shape::One(Piece::Box(piece)));
        }
        let corner = half.as_vec3().length() / SUB as f32;
        let turns = libm::ceilf(corner * from.angle_to(to)) as usize;
        let turns = turns.clamp(1, SWEEP_PIECES - 1);
        Brush(Shape::Sweep { half, from: *from, to: *to, turns })
    }

    /// Its convex parts, worked out one by one; at most [`SWEEP_PIECES`].
    pub fn pieces(&self) -> impl ExactSizeIterator<Item = Piece> + '_ {
        let last = match self.0 {
            Shape::One(_) => 0,
            Shape::Sweep { turns, .. } => turns,
        };
        (0..last + 1).map(|i| match &self.0 {
            Shape::One(piece) => *piece,
            Shape::Sweep { half, from, to, turns } => {
                let at = |halves: usize| from.toward(to, halves as f32 / (2 * turns) as f32);
                let start = at((2 * i).max(1) - 1);
                let start = if i == 0 { from } else { &start };
                let end = Pose { position: at(2 * i + 1).position, ..at(2 * i) };
                Piece::Box(SweptBox::new(*half, &end, start.fixed_position()))
            }
        })
    }

    /// The voxels of a grid of `n` that it may hold; `None` if it lies outside.
    #[must_use]
    pub fn bounds(&self, n: usize) -> Option<Bounds> {
        self.pieces().filter_map(|piece| piece.bounds(n)).reduce(Bounds::union)
    }

    /// Row (y, z) of the brush. [`Pieces`] are quicker where many rows of a sweep are asked for.
    #[must_use]
    #[inline]
    pub fn row<const N: usize>(&self, y: usize, z: usize) -> <Grid<N> as Size>::Row
    where
        Grid<N>: Size,
    {
        self.pieces()
            .filter_map(|piece| piece.span(y, z, N))
            .fold(<Grid<N> as Size>::Row::EMPTY, |row, (lo, hi)| row | Bits::span(lo, hi))
    }
}

impl Bounds {
    fn union(self, other: Self) -> Self {
        Bounds {
            lo: core::array::from_fn(|i| self.lo[i].min(other.lo[i])),
            hi: core::array::from_fn(|i| self.hi[i].max(other.hi[i])),
        }
    }
}

impl Pieces {
    /// Of no brush. For static initialisers only.
    #[must_use]
    #[allow(clippy::new_without_default)] // a Default would hand the pieces about by value
    pub const fn new() -> Self {
        Pieces { all: Vec::new(), y: 0, layer: Vec::new() }
    }

    /// Works out the pieces of a brush. Returns its bounds in a grid of `n`.
    pub fn set(&mut self, brush: &Brush, n: usize) -> Option<Bounds> {
        self.all.clear();
        self.layer.clear();
        for piece in brush.pieces() {
            // Cannot fail: no brush has more.
            let _ = self.all.push(piece);
        }
        self.all.iter().filter_map(|piece| piece.bounds(n)).reduce(Bounds::union)
    }

    /// Goes to layer `y` of a grid of `n`. Returns all z whose row (y, z) can hold a voxel.
    pub fn enter(&mut self, y: usize, n: usize) -> Range {
        self.y = y;
        self.layer.clear();
        let mut all = Range::EMPTY;
        for (i, piece) in (0..).zip(&self.all) {
            if let Some((lo, hi)) = piece.rows(y, n) {
                let rows = Range::new(lo, hi);
                all = all.hull_with(rows);
                // Cannot fail: there is room for all the pieces.
                let _ = self.layer.push((i, rows));
            }
        }
        all
    }

    /// Row z of the layer at hand.
    #[must_use]
    #[inline]
    pub fn row<const N: usize>(&self, z: usize) -> <Grid<N> as Size>::Row
    where
        Grid<N>: Size,
    {
        let mut row = <Grid<N> as Size>::Row::EMPTY;
        for &(i, rows) in &self.layer {
            if rows.contains(z)
                && let Some((lo, hi)) = self.all[usize::from(i)].span(self.y, z, N)
            {
                row |= Bits::span(lo, hi);
            }
        }
        row
    }
}

impl Piece {
    /// The voxels of a grid of `n` that it may hold; `None` if it lies outside.
    #[must_use]
    pub fn bounds(&self, n: usize) -> Option<Bounds> {
        let (lo, hi) = match self {
            Piece::Capsule(c) => {
                let r = I64Vec3::splat(isqrt(c.radius_squared));
                (c.a.min(c.b).as_i64vec3() - r, c.a.max(c.b).as_i64vec3() + r)
            }
            Piece::Box(b) => {
                let middle = b.middle.div_euclid(IVec3::splat(2));
                ((middle - b.reach).as_i64vec3(), (middle + b.reach + IVec3::ONE).as_i64vec3())
            }
        };
        let mut bounds = Bounds { lo: [0; 3], hi: [0; 3] };
        for i in 0..3 {
            let (lo, hi) = voxels_between(lo[i], hi[i], n)?;
            (bounds.lo[i], bounds.hi[i]) = (lo, hi);
        }
        Some(bounds)
    }

    /// The rows (y, z) of layer `y` of a grid of `n` that it may touch, as an interval of z.
    #[must_use]
    fn rows(&self, y: usize, n: usize) -> Option<(usize, usize)> {
        match self {
            Piece::Capsule(c) => c.rows(centre(y), n),
            Piece::Box(b) => b.rows(centre(y), n),
        }
    }

    /// The interval of voxels of row (y, z) of a grid of `n` whose centres are inside.
    #[must_use]
    #[inline]
    pub fn span(&self, y: usize, z: usize, n: usize) -> Option<(usize, usize)> {
        match self {
            Piece::Capsule(c) if c.a == c.b => c.sphere_span(centre(y), centre(z), n),
            Piece::Capsule(c) => c.span(centre(y), centre(z), n),
            Piece::Box(b) => b.span(centre(y), centre(z), n),
        }
    }
}

impl Capsule {
    /// Whether a point is inside. Exact: distances are compared squared, and scaled by the squared
    /// length of the path where the nearest point lies within it.
    #[must_use]
    pub fn contains(&self, p: [i64; 3]) -> bool {
        let path = (self.b - self.a).as_i64vec3();
        let d = I64Vec3::from_array(p) - self.a.as_i64vec3();
        let along = d.dot(path);
        let length_squared = path.dot(path);
        if along <= 0 {
            return d.dot(d) <= self.radius_squared;
        }
        if along >= length_squared {
            let d = d - path;
            return d.dot(d) <= self.radius_squared;
        }
        let wide = i128::from;
        wide(d.dot(d) - self.radius_squared) * wide(length_squared) <= wide(along) * wide(along)
    }

    fn sphere_span(&self, y: i64, z: i64, n: usize) -> Option<(usize, usize)> {
        let (dy, dz) = (y - i64::from(self.a.y), z - i64::from(self.a.z));
        let left = self.radius_squared - dy * dy - dz * dz;
        if left < 0 {
            return None;
        }
        let reach = isqrt(left);
        voxels_between(i64::from(self.a.x) - reach, i64::from(self.a.x) + reach, n)
    }

    /// The capsule is convex, so its voxels in a row run from the first inside to the last; both
    /// are looked for from the ends of a stretch that is at most a unit too long.
    fn span(&self, y: i64, z: i64, n: usize) -> Option<(usize, usize)> {
        let path = (self.b - self.a).as_i64vec3();
        let d = [y - i64::from(self.a.y), z - i64::from(self.a.z)];
        let (lo, hi) = self.stretch(path.x, [path.y, path.z], d)?;
        let (lo, hi) = voxels_between(i64::from(self.a.x) + lo, i64::from(self.a.x) + hi, n)?;
        let first = (lo..=hi).find(|&x| self.contains([centre(x), y, z]))?;
        let last = (first..=hi).rfind(|&x| self.contains([centre(x), y, z]))?;
        Some((first, last))
    }

    /// The shadow of the capsule along x is a capsule in y and z; its voxels in a column along z.
    fn rows(&self, y: i64, n: usize) -> Option<(usize, usize)> {
        let path = (self.b - self.a).as_i64vec3();
        let (lo, hi) = self.stretch(path.z, [path.y, 0], [y - i64::from(self.a.y), 0])?;
        voxels_between(i64::from(self.a.z) + lo, i64::from(self.a.z) + hi, n)
    }

    /// The stretch inside, relative to `a`, of a line along an axis, `d` away from `a` across that
    /// axis; `v` is the path's part along the axis and `w` its parts across. Up to a unit too long.
    ///
    /// It is the hull of three: those inside the two end spheres and inside the cylinder between,
    /// where it runs between the roots of a quadratic, cut off at the two end planes.
    fn stretch(&self, v: i64, w: [i64; 2], d: [i64; 2]) -> Option<(i64, i64)> {
        let left = |d: [i64; 2]| self.radius_squared - d[0] * d[0] - d[1] * d[1];
        let (left_a, left_b) = (left(d), left([d[0] - w[0], d[1] - w[1]]));
        let (mut lo, mut hi) = (i64::MAX, i64::MIN);
        for (left, at) in [(left_a, 0), (left_b, v)] {
            if left >= 0 {
                let reach = isqrt(left);
                (lo, hi) = (lo.min(at - reach), hi.max(at + reach));
            }
        }
        if let Some((from, to)) = self.cylinder_stretch(v, w, d) {
            (lo, hi) = (lo.min(from), hi.max(to));
        }
        (lo <= hi).then_some((lo, hi))
    }

    /// Exact up to the discriminant; what floats round after it is far below the unit that is
    /// added either way.
    fn cylinder_stretch(&self, v: i64, w: [i64; 2], d: [i64; 2]) -> Option<(i64, i64)> {
        let across = w[0] * w[0] + w[1] * w[1];
        let length_squared = across + v * v;
        let along = w[0] * d[0] + w[1] * d[1];
        if across == 0 {
            let inside = d[0] * d[0] + d[1] * d[1] <= self.radius_squared;
            return inside.then_some((v.min(0), v.max(0)));
        }
        let cross = i128::from(w[0] * d[1] - w[1] * d[0]);
        let discriminant = i128::from(across) * i128::from(self.radius_squared) - cross * cross;
        if discriminant < 0 {
            return None;
        }
        let middle = along as f64 * v as f64 / across as f64;
        let reach = libm::sqrt(length_squared as f64 * discriminant as f64) / across as f64;
        let (mut lo, mut hi) = (middle - reach, middle + reach);
        if v != 0 {
            let ends = [-along as f64 / v as f64, (length_squared - along) as f64 / v as f64];
            let (first, last) = if v > 0 { (ends[0], ends[1]) } else { (ends[1], ends[0]) };
            lo = if lo > first { lo } else { first };
            hi = if hi < last { hi } else { last };
        } else if along < 0 || along > length_squared {
            return None;
        }
        (lo <= hi + 2.0).then_some((libm::floor(lo) as i64 - 1, libm::ceil(hi) as i64 + 1))
    }
}

impl SweptBox {
    /// A box of half extents `half`, turned as `pose`, moved straight from `start` to the pose's
    /// position. The path is rounded to fixed point in the box's own frame, so the planes are those
    /// of an exact swept box; a box that moves is half a unit wider, so that the rounding loses
    /// nothing.
    #[must_use]
    pub fn new(half: IVec3, pose: &Pose, start: IVec3) -> Self {
        let unit = i64::from(UNIT);
        let axes =
            pose.fixed_axes().map(|axis| axis.to_array().map(|c| i64::from(c).clamp(-unit, unit)));
        let (start, end) = (held(start), pose.fixed_position());
        let travel = (end - start).to_array().map(i64::from);
        let doubled =
            half.to_array().map(|h| 2 * i64::from(h.clamp(0, FAR)) + i64::from(start != end));
        let w: [i64; 3] = axes.map(|axis| {
            let along: i64 = (0..3).map(|i| axis[i] * travel[i]).sum();
            (along + unit / 2).div_euclid(unit)
        });
        let face = |i: usize| (axes[i], (doubled[i] + w[i].abs()) * unit);
        let swept = |i: usize, j: usize| {
            let normal = core::array::from_fn(|k| axes[i][k] * w[j] - axes[j][k] * w[i]);
            (normal, (doubled[i] * w[j].abs() + doubled[j] * w[i].abs()) * unit)
        };
        let edge = |i: usize| axes[i].map(|c| c * doubled[i] / unit);
        let edges = [edge(0), edge(1), edge(2), travel];
        // Rounding an axis tilts it by up to a part in 2^15, which counts as far as the box reaches.
        let size: i64 = doubled.iter().chain(&travel).map(|l| l.abs()).sum();
        let slack = size / (1 << 12) + 16;
        let reach = core::array::from_fn(|k| {
            let sum: i64 = edges.iter().map(|edge| edge[k].abs()).sum();
            ((sum + slack) / 2 + 1) as i32
        });
        SweptBox {
            middle: start + end,
            planes: [face(0), face(1), face(2), swept(0, 1), swept(0, 2), swept(1, 2)],
            reach: IVec3::from_array(reach),
            edges,
            slack,
        }
    }

    /// The shadow of the box along x is a polygon whose sides run along the edges' shadows.
    fn rows(&self, y: i64, n: usize) -> Option<(usize, usize)> {
        let at = 2 * y - i64::from(self.middle.y);
        let [_, reach, reach_z] = self.reach.to_array().map(i64::from);
        if at.abs() > 2 * reach {
            return None;
        }
        let (mut lo, mut hi) = (-2 * reach_z, 2 * reach_z);
        for side in self.edges {
            if side[1] == 0 {
                continue;
            }
            // Of this sign, the side's shadow runs up.
            let [_, sy, sz] = side.map(|c| c * side[1].signum());
            let across = |edge: &[i64; 3]| (sy * edge[2] - sz * edge[1]).abs();
            let extent: i64 =
                self.edges.iter().map(across).sum::<i64>() + (sy + sz.abs()) * self.slack;
            lo = lo.max((sz * at - extent).div_euclid(sy));
            hi = hi.min((sz * at + extent).div_euclid(sy) + 1);
        }
        let middle = i64::from(self.middle.z);
        voxels_between((middle + lo).div_euclid(2), (middle + hi).div_euclid(2) + 1, n)
    }

    fn span(&self, y: i64, z: i64, n: usize) -> Option<(usize, usize)> {
        let step = 2 * i64::from(SUB);
        let first = 2 * centre(0) - i64::from(self.middle.x);
        let (y, z) = (2 * y - i64::from(self.middle.y), 2 * z - i64::from(self.middle.z));
        let (mut lo, mut hi) = (0, n as i64 - 1);
        for (normal, extent) in &self.planes {
            let at_zero = normal[0] * first + normal[1] * y + normal[2] * z;
            let slope = normal[0] * step;
            if slope == 0 {
                if at_zero.abs() > *extent {
                    return None;
                }
                continue;
            }
            let at_zero = if slope < 0 { -at_zero } else { at_zero };
            let slope = slope.abs();
            lo = lo.max(-(extent + at_zero).div_euclid(slope));
            hi = hi.min((extent - at_zero).div_euclid(slope));
        }
        (lo <= hi).then_some((lo as usize, hi as usize))
    }
}

/// How far from the grid's corner coordinates are held, and lengths: 8,192 voxels.
const FAR: i32 = 8192 * SUB;

fn held(point: IVec3) -> IVec3 {
    point.clamp(IVec3::splat(-FAR), IVec3::splat(FAR))
}

/// The fixed-point coordinate of the centre of voxel `i`.
#[must_use]
#[inline]
pub const fn centre(i: usize) -> i64 {
    i as i64 * SUB as i64 + SUB as i64 / 2
}

/// The voxels of a grid of `n` whose centres lie in `lo..=hi`.
#[inline]
fn voxels_between(lo: i64, hi: i64, n: usize) -> Option<(usize, usize)> {
    let sub = i64::from(SUB);
    let first = (lo - sub / 2 + sub - 1).div_euclid(sub).max(0);
    let last = (hi - sub / 2).div_euclid(sub).min(n as i64 - 1);
    (first <= last).then_some((first as usize, last as usize))
}

/// The integer part of a square root; 0 for negative numbers.
#[must_use]
#[inline]
pub fn isqrt(v: i64) -> i64 {
    // Below 2^52 a correctly rounded root never reaches the next integer.
    match v.max(0) {
        v if v < 1 << 52 => libm::sqrt(v as f64) as i64,
        v => v.isqrt(),
    }
}
