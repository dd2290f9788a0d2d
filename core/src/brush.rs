//! Brushes: convex pieces whose voxels in a row are one interval, found in integers.
//!
//! A voxel is in a brush when its centre is, boundary included. Source: section 3 of the paper
//! (spherical and rectangular cutters), swept here along the tool's path.

use glam::IVec3;
use heapless::Vec;

use crate::limits::SWEEP_PIECES;
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
}

/// A convex part of a brush.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
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

/// The union of its pieces.
#[derive(Clone, Debug)]
pub struct Brush {
    pieces: Vec<Piece, SWEEP_PIECES>,
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
        let radius_squared = i64::from(radius) * i64::from(radius);
        Self::of(Piece::Capsule(Capsule { a, b, radius_squared }))
    }

    /// A box of half extents `half` (fixed point) about a pose.
    #[must_use]
    pub fn oriented_box(half: IVec3, pose: &Pose) -> Self {
        Self::of(Piece::Box(SweptBox::new(half, pose, pose.fixed_position())))
    }

    /// A box swept from one pose to another. Its turn is cut into sub-steps in which no corner
    /// moves more than one voxel; each piece is the box as turned at its sub-step's end, moved
    /// straight from the sub-step's start. At most [`SWEEP_PIECES`] sub-steps, which is half a turn
    /// of the largest bit.
    #[must_use]
    pub fn swept_box(half: IVec3, from: &Pose, to: &Pose) -> Self {
        let corner = half.as_vec3().length() / SUB as f32;
        let turns = libm::ceilf(corner * from.angle_to(to)) as usize;
        let steps = turns.clamp(1, SWEEP_PIECES);
        let mut pieces = Vec::new();
        for i in 0..steps {
            let start = from.toward(to, i as f32 / steps as f32).fixed_position();
            let end = from.toward(to, (i + 1) as f32 / steps as f32);
            // Cannot fail: steps <= SWEEP_PIECES.
            let _ = pieces.push(Piece::Box(SweptBox::new(half, &end, start)));
        }
        Brush { pieces }
    }

    /// Its convex parts.
    #[must_use]
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The voxels of a grid of `n` that it may hold; `None` if it lies outside.
    #[must_use]
    pub fn bounds(&self, n: usize) -> Option<Bounds> {
        self.pieces.iter().filter_map(|piece| piece.bounds(n)).reduce(|a, b| Bounds {
            lo: core::array::from_fn(|i| a.lo[i].min(b.lo[i])),
            hi: core::array::from_fn(|i| a.hi[i].max(b.hi[i])),
        })
    }

    /// Row (y, z) of the brush.
    #[must_use]
    #[inline]
    pub fn row<const N: usize>(&self, y: usize, z: usize) -> <Grid<N> as Size>::Row
    where
        Grid<N>: Size,
    {
        self.pieces
            .iter()
            .filter_map(|piece| piece.span(y, z, N))
            .fold(<Grid<N> as Size>::Row::EMPTY, |row, (lo, hi)| row | Bits::span(lo, hi))
    }

    fn of(piece: Piece) -> Self {
        let mut pieces = Vec::new();
        // Cannot fail: there is room for SWEEP_PIECES.
        let _ = pieces.push(piece);
        Brush { pieces }
    }
}

impl Piece {
    /// The voxels of a grid of `n` that it may hold; `None` if it lies outside.
    #[must_use]
    pub fn bounds(&self, n: usize) -> Option<Bounds> {
        let (lo, hi) = match self {
            Piece::Capsule(c) => {
                let r = IVec3::splat(isqrt(c.radius_squared) as i32 + 1);
                (c.a.min(c.b) - r, c.a.max(c.b) + r)
            }
            Piece::Box(b) => {
                let middle = b.middle.div_euclid(IVec3::splat(2));
                (middle - b.reach, middle + b.reach + IVec3::ONE)
            }
        };
        let mut bounds = Bounds { lo: [0; 3], hi: [0; 3] };
        for i in 0..3 {
            let (lo, hi) = voxels_between(lo[i].into(), hi[i].into(), n)?;
            (bounds.lo[i], bounds.hi[i]) = (lo, hi);
        }
        Some(bounds)
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
        let d = glam::I64Vec3::from_array(p) - self.a.as_i64vec3();
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
    /// are looked for from the ends of the stretch that the row's distance to the path allows.
    fn span(&self, y: i64, z: i64, n: usize) -> Option<(usize, usize)> {
        let (lo, hi) = self.stretch(y, z)?;
        let (lo, hi) = voxels_between(lo, hi, n)?;
        let first = (lo..=hi).find(|&x| self.contains([centre(x), y, z]))?;
        let last = (first..=hi).rfind(|&x| self.contains([centre(x), y, z]))?;
        Some((first, last))
    }

    /// Where along x the parts of the path lie that come within the radius of the row in y and in
    /// z, widened by the radius.
    fn stretch(&self, y: i64, z: i64) -> Option<(i64, i64)> {
        let r = isqrt(self.radius_squared) + 1;
        let (mut t0, mut t1) = (0.0f64, 1.0f64);
        for (at, a, b) in [(y, self.a.y, self.b.y), (z, self.a.z, self.b.z)] {
            let (a, v) = (i64::from(a), i64::from(b) - i64::from(a));
            if v == 0 {
                if (at - a).abs() > r {
                    return None;
                }
                continue;
            }
            let ends = [(at - r - a) as f64 / v as f64, (at + r - a) as f64 / v as f64];
            t0 = t0.max(ends[0].min(ends[1]));
            t1 = t1.min(ends[0].max(ends[1]));
        }
        // The slack of a unit either way outweighs the rounding of the two divisions.
        if t0 > t1 + 1e-6 {
            return None;
        }
        let (a, v) = (f64::from(self.a.x), f64::from(self.b.x) - f64::from(self.a.x));
        let (x0, x1) = (a + v * t0, a + v * t1);
        Some((x0.min(x1) as i64 - r - 2, x0.max(x1) as i64 + r + 2))
    }
}

impl SweptBox {
    /// A box of half extents `half`, turned as `pose`, moved straight from `start` to the pose's
    /// position. The path is rounded to fixed point in the box's own frame, so the planes are those
    /// of an exact swept box.
    #[must_use]
    pub fn new(half: IVec3, pose: &Pose, start: IVec3) -> Self {
        let axes = pose.fixed_axes().map(|axis| axis.to_array().map(i64::from));
        let end = pose.fixed_position();
        let travel = end - start;
        let half = half.to_array().map(i64::from);
        let unit = i64::from(UNIT);
        let w: [i64; 3] = axes.map(|axis| {
            let along: i64 = (0..3).map(|i| axis[i] * i64::from(travel[i])).sum();
            (along + unit / 2).div_euclid(unit)
        });
        let face = |i: usize| (axes[i], (2 * half[i] + w[i].abs()) * unit);
        let swept = |i: usize, j: usize| {
            let normal = core::array::from_fn(|k| axes[i][k] * w[j] - axes[j][k] * w[i]);
            (normal, 2 * (half[i] * w[j].abs() + half[j] * w[i].abs()) * unit)
        };
        let reach = core::array::from_fn(|k| {
            let turned: i64 = (0..3).map(|i| axes[i][k].abs() * half[i]).sum();
            (turned / unit + i64::from(travel[k].abs()) / 2 + 4) as i32
        });
        SweptBox {
            middle: start + end,
            planes: [face(0), face(1), face(2), swept(0, 1), swept(0, 2), swept(1, 2)],
            reach: IVec3::from_array(reach),
        }
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
    v.max(0).isqrt()
}
