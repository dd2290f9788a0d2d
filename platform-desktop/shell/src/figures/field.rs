//! Signed-distance shapes and the ways to join them.
//!
//! Lengths are units of 1/128 of the box's edge. Only `+ - * /`, square roots and comparisons, so
//! every machine gets the same bits. No shape changes faster than distance itself, and no join makes
//! it. Formulas: Hart (1996), "Sphere tracing"; Quilez, "Distance functions".

use glam::{Vec2, Vec3};

/// The smaller; never NaN here, and the sign of a zero makes no difference.
#[inline]
pub(super) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The larger.
#[inline]
pub(super) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// `t` within 0..=1.
#[inline]
pub(super) fn unit(t: f32) -> f32 {
    max(0.0, min(1.0, t))
}

#[inline]
pub(super) fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// The point with x made positive, for shapes that come in mirrored pairs.
#[inline]
pub(super) fn paired(p: Vec3) -> Vec3 {
    v(p.x.abs(), p.y, p.z)
}

/// Union with a fillet of about `k / 4` where the two meet.
#[inline]
pub(super) fn blend(a: f32, b: f32, k: f32) -> f32 {
    let h = max(k - (a - b).abs(), 0.0);
    min(a, b) - h * h / (4.0 * k)
}

/// `a` without `b`, the new edge rounded.
#[inline]
pub(super) fn cut(a: f32, b: f32, k: f32) -> f32 {
    -blend(-a, b, k)
}

#[inline]
pub(super) fn sphere(p: Vec3, centre: Vec3, radius: f32) -> f32 {
    (p - centre).length() - radius
}

/// A lower bound of the distance to an ellipsoid, true along its shortest axis.
#[inline]
pub(super) fn ellipsoid(p: Vec3, centre: Vec3, radii: Vec3) -> f32 {
    (((p - centre) / radii).length() - 1.0) * min(radii.x, min(radii.y, radii.z))
}

/// A segment `a` to `b`, its radius going from `ra` to `rb`: the union of all spheres between.
#[inline]
pub(super) fn limb(p: Vec3, (a, ra): (Vec3, f32), (b, rb): (Vec3, f32)) -> f32 {
    let (axis, from) = (b - a, p - a);
    let length = axis.length();
    // In the half plane through the axis: distance from it, and place along it.
    let y = from.dot(axis) / length;
    let x = root(max(from.dot(from) - y * y, 0.0));
    // The flank leans by the sine `s`; the spheres at its ends touch it at its normals' feet.
    let s = (ra - rb) / length;
    let c = root(1.0 - s * s);
    let foot = y * c - x * s;
    if foot < 0.0 {
        from.length() - ra
    } else if foot > c * length {
        (p - b).length() - rb
    } else {
        x * c + y * s - ra
    }
}

/// A chain of limbs through the given points and radii.
#[inline]
pub(super) fn chain(p: Vec3, joints: &[(Vec3, f32)]) -> f32 {
    joints.windows(2).fold(f32::MAX, |d, pair| min(d, limb(p, pair[0], pair[1])))
}

/// A box of half extents `half`, its edges rounded by `radius` within them.
#[inline]
pub(super) fn block(p: Vec3, centre: Vec3, half: Vec3, radius: f32) -> f32 {
    let q = (p - centre).abs() - half + Vec3::splat(radius);
    let outside = v(max(q.x, 0.0), max(q.y, 0.0), max(q.z, 0.0)).length();
    outside + min(max(q.x, max(q.y, q.z)), 0.0) - radius
}

/// An upright disc: from height `low` to `high` around the y axis, its rim rounded by `rim`.
#[inline]
pub(super) fn disc(p: Vec3, (low, high): (f32, f32), radius: f32, rim: f32) -> f32 {
    let half = (high - low) * 0.5;
    let q = Vec2::new(turned(p) - radius + rim, (p.y - low - half).abs() - half + rim);
    let outside = Vec2::new(max(q.x, 0.0), max(q.y, 0.0)).length();
    outside + min(max(q.x, q.y), 0.0) - rim
}

/// A ring around the y axis at `height`.
#[inline]
pub(super) fn ring(p: Vec3, height: f32, radius: f32, thickness: f32) -> f32 {
    Vec2::new(turned(p) - radius, p.y - height).length() - thickness
}

/// Distance from the y axis.
#[inline]
pub(super) fn turned(p: Vec3) -> f32 {
    root(p.x * p.x + p.z * p.z)
}

/// A furrow of half width and depth `size` where `line` is zero on the surface of `d`.
#[inline]
pub(super) fn groove(d: f32, line: f32, size: f32) -> f32 {
    cut(d, Vec2::new(d, line).length() - size, size)
}

/// Folds the turn around the y axis onto one of 16 equal wedges: the result lies within a 32nd of a turn
/// from the x axis, where y = 0.
#[inline]
pub(super) fn wedge(p: Vec3) -> Vec2 {
    let mut q = Vec2::new(p.x.abs(), p.z.abs());
    // Sine and cosine of the mirrors at 45, 22.5 and 11.25 degrees.
    const MIRRORS: [(f32, f32); 3] =
        [(0.707_106_77, 0.707_106_77), (0.382_683_43, 0.923_879_5), (0.195_090_32, 0.980_785_3)];
    for (sine, cosine) in MIRRORS {
        let beyond = q.y * cosine - q.x * sine;
        if beyond > 0.0 {
            q += Vec2::new(sine, -cosine) * (2.0 * beyond);
        }
    }
    q
}

/// Lattice noise within -1..=1: values hashed at integer points, eased between. It changes by at most
/// 5.2 over a unit.
pub(super) fn noise(p: Vec3, seed: u32) -> f32 {
    let cell = p.floor();
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (fx, fy, fz) = (ease(p.x - cell.x), ease(p.y - cell.y), ease(p.z - cell.z));
    let [x, y, z] = cell.to_array().map(|c| c as i32);
    let at = |dx, dy, dz| hashed([x + dx, y + dy, z + dz], seed);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let line = |dy, dz| mix(at(0, dy, dz), at(1, dy, dz), fx);
    let face = |dz| mix(line(0, dz), line(1, dz), fy);
    mix(face(0), face(1), fz)
}

/// A lattice point's value within -1..=1.
fn hashed(point: [i32; 3], seed: u32) -> f32 {
    let mut h = seed.wrapping_mul(0x9e37_79b9);
    for c in point {
        h = (h ^ c as u32).wrapping_mul(0x85eb_ca6b);
        h = (h ^ h >> 15).wrapping_mul(0xc2b2_ae35);
        h ^= h >> 13;
    }
    (h >> 8) as f32 / 8_388_607.5 - 1.0
}

#[inline]
fn root(x: f32) -> f32 {
    libm::sqrtf(x)
}
