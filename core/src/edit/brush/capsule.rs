//! A capsule (swept sphere), rasterised by integer square roots and exact comparisons.

use glam::{I64Vec3, IVec3};

use super::{isqrt, voxel_centre, voxels_between};

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

    /// [`Capsule::row_range`] of a plain sphere.
    #[inline]
    pub(super) fn sphere_row_range(&self, y: i64, side: usize) -> Option<(usize, usize)> {
        let dy = y - i64::from(self.a.y);
        let left = self.radius_squared - dy * dy;
        if left < 0 {
            return None;
        }
        let reach = isqrt(left);
        voxels_between(i64::from(self.a.z) - reach, i64::from(self.a.z) + reach, side)
    }

    /// [`Capsule::row_span`] of a plain sphere.
    #[inline]
    pub(super) fn sphere_row_span(&self, y: i64, z: i64, side: usize) -> Option<(usize, usize)> {
        let (dy, dz) = (y - i64::from(self.a.y), z - i64::from(self.a.z));
        let left = self.radius_squared - dy * dy - dz * dz;
        if left < 0 {
            return None;
        }
        let reach = isqrt(left);
        voxels_between(i64::from(self.a.x) - reach, i64::from(self.a.x) + reach, side)
    }

    /// The voxels of row (y, z), first and last; y and z in fixed point. The capsule is convex, so they
    /// are one interval. Both ends are searched from an interval that is at most a unit too long.
    pub(super) fn row_span(&self, y: i64, z: i64, side: usize) -> Option<(usize, usize)> {
        let path = (self.b - self.a).as_i64vec3();
        let d = [y - i64::from(self.a.y), z - i64::from(self.a.z)];
        let (lo, hi) = self.line_interval(path.x, [path.y, path.z], d)?;
        let (lo, hi) = voxels_between(i64::from(self.a.x) + lo, i64::from(self.a.x) + hi, side)?;
        let first = (lo..=hi).find(|&x| self.contains([voxel_centre(x), y, z]))?;
        let last = (first..=hi).rfind(|&x| self.contains([voxel_centre(x), y, z]))?;
        Some((first, last))
    }

    /// The rows at `y` (fixed point) that may hold voxels, first and last z. The projection of the
    /// capsule along x is a 2D capsule.
    pub(super) fn row_range(&self, y: i64, side: usize) -> Option<(usize, usize)> {
        let path = (self.b - self.a).as_i64vec3();
        let (lo, hi) = self.line_interval(path.z, [path.y, 0], [y - i64::from(self.a.y), 0])?;
        voxels_between(i64::from(self.a.z) + lo, i64::from(self.a.z) + hi, side)
    }

    /// Line-capsule intersection: the interval of an axis-parallel line inside, relative to `a`, up to a
    /// unit too long. `d` is the line's offset from `a` across the axis; `v` is the path's component
    /// along the axis, `w` those across.
    ///
    /// It is the hull of three intervals: in the two end spheres, and in the cylinder between them, where
    /// it lies between the roots of a quadratic, clipped by the two end planes.
    fn line_interval(&self, v: i64, w: [i64; 2], d: [i64; 2]) -> Option<(i64, i64)> {
        let left = |d: [i64; 2]| self.radius_squared - d[0] * d[0] - d[1] * d[1];
        let (left_a, left_b) = (left(d), left([d[0] - w[0], d[1] - w[1]]));
        let (mut lo, mut hi) = (i64::MAX, i64::MIN);
        for (left, at) in [(left_a, 0), (left_b, v)] {
            if left >= 0 {
                let reach = isqrt(left);
                (lo, hi) = (lo.min(at - reach), hi.max(at + reach));
            }
        }
        if let Some((from, to)) = self.cylinder_interval(v, w, d) {
            (lo, hi) = (lo.min(from), hi.max(to));
        }
        (lo <= hi).then_some((lo, hi))
    }

    /// Line-cylinder intersection. Exact up to the discriminant; later float rounding is far below the
    /// unit that is added at both ends.
    fn cylinder_interval(&self, v: i64, w: [i64; 2], d: [i64; 2]) -> Option<(i64, i64)> {
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
