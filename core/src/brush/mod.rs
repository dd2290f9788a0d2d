//! Brushes: convex pieces whose voxels in a row are one interval, found in integers.
//!
//! A voxel is in a brush when its centre is, boundary included. Source: section 3 of the paper
//! (spherical and rectangular cutters), swept here along the tool's path.

mod capsule;
mod swept_box;

use glam::{I64Vec3, IVec3};
use heapless::Vec;

use crate::limits::SWEEP_PIECES;
use crate::pose::{Pose, SUB};
use crate::row::Bits;
use crate::size::{Grid, Size};

pub use capsule::Capsule;
use swept_box::BoxLayer;
pub use swept_box::SweptBox;

/// A convex part of a brush.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[expect(clippy::large_enum_variant, reason = "there is no heap to box the larger on")]
pub enum Piece {
    /// A swept sphere.
    Capsule(Capsule),
    /// A swept oriented box.
    Box(SweptBox),
}

/// What a piece holds of the rows of one y.
#[derive(Clone, Copy, Debug)]
pub struct Layer<'a>(Kind<'a>);

#[derive(Clone, Copy, Debug)]
enum Kind<'a> {
    Sphere(&'a Capsule, i64),
    Capsule(&'a Capsule, i64),
    Box(BoxLayer<'a>),
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

/// A brush's pieces, worked out once.
#[derive(Debug)]
pub struct Pieces(Vec<Piece, SWEEP_PIECES, u8>);

impl Brush {
    /// A sphere; centre and radius in fixed point.
    #[must_use]
    pub fn sphere(centre: IVec3, radius: i32) -> Self {
        Piece::sphere(centre, radius).into()
    }

    /// A sphere swept from `a` to `b`: a fast stroke leaves no dots.
    #[must_use]
    pub fn capsule(a: IVec3, b: IVec3, radius: i32) -> Self {
        Piece::capsule(a, b, radius).into()
    }

    /// A box of half extents `half` (fixed point) about a pose.
    #[must_use]
    pub fn oriented_box(half: IVec3, pose: &Pose) -> Self {
        Piece::oriented_box(half, pose).into()
    }

    /// A box swept from one pose to another. Its turn is cut into sub-steps in which no corner
    /// moves more than one voxel; a piece is the box as turned at one of the times between (the
    /// two ends included), moved straight from half a sub-step before to half a sub-step after. At
    /// most [`SWEEP_PIECES`], which is half a turn of the largest bit.
    #[must_use]
    pub fn swept_box(half: IVec3, from: &Pose, to: &Pose) -> Self {
        if from.fixed_axes() == to.fixed_axes() {
            let piece = SweptBox::new(half, to, from.fixed_position());
            return Piece::Box(piece).into();
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

impl From<Piece> for Brush {
    fn from(piece: Piece) -> Self {
        Brush(Shape::One(piece))
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
        Pieces(Vec::new())
    }

    /// Works out the pieces of a brush. Returns its bounds in a grid of `n`.
    pub fn set(&mut self, brush: &Brush, n: usize) -> Option<Bounds> {
        self.0.clear();
        for piece in brush.pieces() {
            // Cannot fail: no brush has more.
            let _ = self.0.push(piece);
        }
        self.0.iter().filter_map(|piece| piece.bounds(n)).reduce(Bounds::union)
    }

    /// Tells the intervals of voxels, first and last, that make up layer `y` of a grid of `n`, each
    /// with the z of its row; piece by piece.
    #[inline]
    pub fn layer(&self, y: usize, n: usize, mut tell: impl FnMut(usize, (usize, usize))) {
        for piece in &self.0 {
            let layer = piece.layer(y);
            let Some((first, last)) = layer.rows(n) else {
                continue;
            };
            for z in first..last + 1 {
                if let Some(span) = layer.span(z, n) {
                    tell(z, span);
                }
            }
        }
    }
}

impl Piece {
    /// A sphere; centre and radius in fixed point.
    #[must_use]
    pub fn sphere(centre: IVec3, radius: i32) -> Self {
        Self::capsule(centre, centre, radius)
    }

    /// A box of half extents `half` (fixed point) about a pose.
    #[must_use]
    pub fn oriented_box(half: IVec3, pose: &Pose) -> Self {
        Piece::Box(SweptBox::new(half, pose, pose.fixed_position()))
    }

    fn capsule(a: IVec3, b: IVec3, radius: i32) -> Self {
        let radius = i64::from(radius.clamp(0, FAR));
        Piece::Capsule(Capsule { a: held(a), b: held(b), radius_squared: radius * radius })
    }

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

    /// A ball that holds all of a swept sphere, and whose rows are quicker to find.
    #[must_use]
    pub fn ball(&self) -> Option<Piece> {
        match self {
            Piece::Capsule(c) if c.a != c.b => {
                let path = (c.b - c.a).as_i64vec3();
                // Both roots are rounded down, and so is the middle.
                let radius = isqrt(c.radius_squared) + isqrt(path.dot(path)) / 2 + 4;
                let middle = ((c.a.as_i64vec3() + c.b.as_i64vec3()) / 2).as_ivec3();
                let radius_squared = radius * radius;
                Some(Piece::Capsule(Capsule { a: middle, b: middle, radius_squared }))
            }
            _ => None,
        }
    }

    /// Its part in layer `y`, whose rows are quicker to find together.
    #[must_use]
    #[inline]
    pub fn layer(&self, y: usize) -> Layer<'_> {
        Layer(match self {
            Piece::Capsule(c) if c.a == c.b => Kind::Sphere(c, centre(y)),
            Piece::Capsule(c) => Kind::Capsule(c, centre(y)),
            Piece::Box(b) => Kind::Box(b.layer(centre(y))),
        })
    }

    /// The interval of voxels of row (y, z) of a grid of `n` whose centres are inside.
    #[must_use]
    #[inline]
    pub fn span(&self, y: usize, z: usize, n: usize) -> Option<(usize, usize)> {
        self.layer(y).span(z, n)
    }
}

impl Layer<'_> {
    /// The rows of a grid of `n` that it may hold voxels of, first and last by their z; fewer than
    /// the piece's bounds tell where it is round or stands askew.
    #[must_use]
    #[inline]
    pub fn rows(&self, n: usize) -> Option<(usize, usize)> {
        match &self.0 {
            Kind::Sphere(c, y) => c.sphere_rows(*y, n),
            Kind::Capsule(c, y) => c.rows(*y, n),
            Kind::Box(layer) => layer.rows(n),
        }
    }

    /// The interval of voxels of the row at `z` of a grid of `n` whose centres are inside.
    #[must_use]
    #[inline]
    pub fn span(&self, z: usize, n: usize) -> Option<(usize, usize)> {
        match &self.0 {
            Kind::Sphere(c, y) => c.sphere_span(*y, centre(z), n),
            Kind::Capsule(c, y) => c.span(*y, centre(z), n),
            Kind::Box(layer) => layer.span(centre(z), n),
        }
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
