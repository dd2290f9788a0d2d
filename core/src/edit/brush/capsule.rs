//! A capsule (swept sphere), rasterised by integer square roots and exact comparisons.

use glam::{I64Vec3, IVec3};

use super::{SubunitInterval, isqrt, voxel_centre_subunits, voxels_with_centre_in};
use crate::volume::range::Range;

/// A sphere of `radius` swept from `a` to `b`, in fixed point. For a strict interior, `radius_squared` may be
/// slightly less than the square of an integer radius.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Capsule {
    /// One end of the path.
    pub a: IVec3,
    /// The other end; equal to `a` for a plain sphere.
    pub b: IVec3,
    /// Greatest squared distance from the path.
    pub radius_squared: i64,
}

/// A slice of a ball: a circle.
#[derive(Clone, Copy)]
pub(super) struct BallLayer {
    x: i64,
    z: i64,
    /// Negative if the slice is empty.
    radius_squared: i64,
}

impl BallLayer {
    /// Returns `true` if the first and the last voxel of a range of the row at a fixed-point z are inside.
    #[inline]
    pub(super) fn holds_ends(&self, x_range: Range, z_subunits: i64) -> bool {
        let dz = z_subunits - self.z;
        let left = self.radius_squared - dz * dz;
        let is_inside = |x: usize| {
            let dx = voxel_centre_subunits(x) - self.x;
            dx * dx <= left
        };
        is_inside(x_range.first()) && is_inside(x_range.last())
    }
}

impl Capsule {
    /// Returns `true` if a point is inside. Exact: squared distances are compared, scaled by the squared
    /// length of the path if the nearest point lies within it.
    #[must_use]
    pub fn contains(&self, point_subunits: [i64; 3]) -> bool {
        let path = (self.b - self.a).as_i64vec3();
        let d = I64Vec3::from_array(point_subunits) - self.a.as_i64vec3();
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

    /// Returns the ball at the end of the path, at a fixed-point y.
    #[inline]
    pub(super) fn ball_at_end(&self, y_subunits: i64) -> BallLayer {
        let dy = y_subunits - i64::from(self.b.y);
        let (x, z) = (i64::from(self.b.x), i64::from(self.b.z));
        BallLayer { x, z, radius_squared: self.radius_squared - dy * dy }
    }

    /// [`Capsule::x_range`], which also handles a plain sphere.
    #[inline]
    pub(super) fn x_range_at(
        &self,
        y_subunits: i64,
        z_subunits: i64,
        grid_side: usize,
    ) -> Option<Range> {
        match self.a == self.b {
            true => self.sphere_x_range(y_subunits, z_subunits, grid_side),
            false => self.x_range(y_subunits, z_subunits, grid_side),
        }
    }

    /// [`Capsule::z_range`] of a plain sphere.
    #[inline]
    pub(super) fn sphere_z_range(&self, y_subunits: i64, grid_side: usize) -> Option<Range> {
        let dy = y_subunits - i64::from(self.a.y);
        let left = self.radius_squared - dy * dy;
        if left < 0 {
            return None;
        }
        let reach = isqrt(left);
        voxels_with_centre_in(SubunitInterval::around(self.a.z, reach), grid_side)
    }

    /// [`Capsule::x_range`] of a plain sphere.
    #[inline]
    pub(super) fn sphere_x_range(
        &self,
        y_subunits: i64,
        z_subunits: i64,
        grid_side: usize,
    ) -> Option<Range> {
        let (dy, dz) = (y_subunits - i64::from(self.a.y), z_subunits - i64::from(self.a.z));
        let left = self.radius_squared - dy * dy - dz * dz;
        if left < 0 {
            return None;
        }
        let reach = isqrt(left);
        voxels_with_centre_in(SubunitInterval::around(self.a.x, reach), grid_side)
    }

    /// Returns the voxels of a row, given the fixed-point y and z of its centres. The capsule is convex, so
    /// they are one interval. Both ends are searched from an interval that is at most a unit too long.
    pub(super) fn x_range(
        &self,
        y_subunits: i64,
        z_subunits: i64,
        grid_side: usize,
    ) -> Option<Range> {
        let path = (self.b - self.a).as_i64vec3();
        let (y, z) = (y_subunits, z_subunits);
        let offset = [y - i64::from(self.a.y), z - i64::from(self.a.z)];
        let inside = self.line_interval(path.x, [path.y, path.z], offset)?.shifted_by(self.a.x);
        let candidates = voxels_with_centre_in(inside, grid_side)?;
        let (lo, hi) = (candidates.first(), candidates.last());
        let first = (lo..=hi).find(|&x| self.contains([voxel_centre_subunits(x), y, z]))?;
        let last = (first..=hi).rfind(|&x| self.contains([voxel_centre_subunits(x), y, z]))?;
        Some(Range::new(first, last))
    }

    /// Returns the z of the rows at a fixed-point y that may hold voxels. The projection of the capsule along
    /// x is a 2D capsule.
    pub(super) fn z_range(&self, y_subunits: i64, grid_side: usize) -> Option<Range> {
        let path = (self.b - self.a).as_i64vec3();
        let offset = [y_subunits - i64::from(self.a.y), 0];
        let inside = self.line_interval(path.z, [path.y, 0], offset)?.shifted_by(self.a.z);
        voxels_with_centre_in(inside, grid_side)
    }

    /// Line-capsule intersection: the interval of an axis-parallel line inside, relative to `a`, up to a
    /// unit too long. `line_offset` is the line's offset from `a` across the axis; `path_along` is the
    /// path's component along the axis, `path_across` those across.
    ///
    /// The result is the hull of three intervals: those in the two end spheres, and the one in the cylinder
    /// between them, where the line lies between the roots of a quadratic, clipped by the two end planes.
    fn line_interval(
        &self,
        path_along: i64,
        path_across: [i64; 2],
        line_offset: [i64; 2],
    ) -> Option<SubunitInterval> {
        let (v, w, d) = (path_along, path_across, line_offset);
        let left = |d: [i64; 2]| self.radius_squared - d[0] * d[0] - d[1] * d[1];
        let (left_a, left_b) = (left(d), left([d[0] - w[0], d[1] - w[1]]));
        let (mut lo, mut hi) = (i64::MAX, i64::MIN);
        for (left, at) in [(left_a, 0), (left_b, v)] {
            if left >= 0 {
                let reach = isqrt(left);
                (lo, hi) = (lo.min(at - reach), hi.max(at + reach));
            }
        }
        if let Some(inside) = self.cylinder_interval(v, w, d) {
            (lo, hi) = (lo.min(inside.lo), hi.max(inside.hi));
        }
        (lo <= hi).then_some(SubunitInterval { lo, hi })
    }

    /// Line-cylinder intersection, with the arguments of [`Capsule::line_interval`]. Exact up to the
    /// discriminant; the later float rounding is far below the unit that is added at both ends.
    fn cylinder_interval(
        &self,
        path_along: i64,
        path_across: [i64; 2],
        line_offset: [i64; 2],
    ) -> Option<SubunitInterval> {
        let (v, w, d) = (path_along, path_across, line_offset);
        let across = w[0] * w[0] + w[1] * w[1];
        let length_squared = across + v * v;
        let along = w[0] * d[0] + w[1] * d[1];
        if across == 0 {
            let inside = d[0] * d[0] + d[1] * d[1] <= self.radius_squared;
            return inside.then_some(SubunitInterval { lo: v.min(0), hi: v.max(0) });
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
        (lo <= hi + 2.0).then_some(SubunitInterval {
            lo: libm::floor(lo) as i64 - 1,
            hi: libm::ceil(hi) as i64 + 1,
        })
    }
}
