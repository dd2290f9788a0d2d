//! Signed distance functions (SDF) of simple shapes, and smooth operations on them.
//!
//! Lengths are units of 1/128 of the box's edge. Only `+ - * /`, square roots and comparisons, so
//! every machine gets the same bits. Every shape is Lipschitz with constant 1, and every operation
//! keeps it so. Formulas: Hart (1996), "Sphere tracing"; Quilez, "Distance functions".

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

/// Clamps `t` to 0..=1.
#[inline]
pub(super) fn clamp_to_unit(t: f32) -> f32 {
    max(0.0, min(1.0, t))
}

#[inline]
pub(super) fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Mirrors a point to x >= 0, for shapes in mirrored pairs.
#[inline]
pub(super) fn mirror_x(p: Vec3) -> Vec3 {
    v(p.x.abs(), p.y, p.z)
}

/// Smooth minimum (Quilez, polynomial): a union with a fillet of about `k / 4`.
#[inline]
pub(super) fn smooth_union(a: f32, b: f32, k: f32) -> f32 {
    let h = max(k - (a - b).abs(), 0.0);
    min(a, b) - h * h / (4.0 * k)
}

/// Smooth difference `a` minus `b`; `k` as in [`smooth_union`].
#[inline]
pub(super) fn smooth_subtract(a: f32, b: f32, k: f32) -> f32 {
    -smooth_union(-a, b, k)
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

/// A round cone: the union of the spheres on a segment from `a` to `b`, of radii from `ra` to `rb`.
#[inline]
pub(super) fn round_cone(p: Vec3, (a, ra): (Vec3, f32), (b, rb): (Vec3, f32)) -> f32 {
    let (axis, from) = (b - a, p - a);
    let length = axis.length();
    // In the half plane through the axis: distance from it, and place along it.
    let y = from.dot(axis) / length;
    let x = square_root(max(from.dot(from) - y * y, 0.0));
    // The flank leans by the sine `s`; the spheres at its ends touch it at its normals' feet.
    let s = (ra - rb) / length;
    let c = square_root(1.0 - s * s);
    let foot = y * c - x * s;
    if foot < 0.0 {
        from.length() - ra
    } else if foot > c * length {
        (p - b).length() - rb
    } else {
        x * c + y * s - ra
    }
}

/// A chain of round cones through the given points and radii.
#[inline]
pub(super) fn cone_chain(p: Vec3, joints: &[(Vec3, f32)]) -> f32 {
    joints.windows(2).fold(f32::MAX, |d, pair| min(d, round_cone(p, pair[0], pair[1])))
}

/// A box of half extents `half`, its edges rounded by `radius` within them.
#[inline]
pub(super) fn rounded_box(p: Vec3, centre: Vec3, half: Vec3, radius: f32) -> f32 {
    let q = (p - centre).abs() - half + Vec3::splat(radius);
    let outside = v(max(q.x, 0.0), max(q.y, 0.0), max(q.z, 0.0)).length();
    outside + min(max(q.x, max(q.y, q.z)), 0.0) - radius
}

/// An upright disc: from height `low` to `high` around the y axis, its rim rounded by `rim`.
#[inline]
pub(super) fn rounded_disc(p: Vec3, (low, high): (f32, f32), radius: f32, rim: f32) -> f32 {
    let half = (high - low) * 0.5;
    let q = Vec2::new(axis_distance(p) - radius + rim, (p.y - low - half).abs() - half + rim);
    let outside = Vec2::new(max(q.x, 0.0), max(q.y, 0.0)).length();
    outside + min(max(q.x, q.y), 0.0) - rim
}

/// A torus around the y axis at `height`; `thickness` is its tube's radius.
#[inline]
pub(super) fn torus(p: Vec3, height: f32, radius: f32, thickness: f32) -> f32 {
    Vec2::new(axis_distance(p) - radius, p.y - height).length() - thickness
}

/// Distance from the y axis.
#[inline]
pub(super) fn axis_distance(p: Vec3) -> f32 {
    square_root(p.x * p.x + p.z * p.z)
}

/// Carves a furrow of half width and depth `size` into the surface of `d` where `line` is zero.
#[inline]
pub(super) fn carve_groove(d: f32, line: f32, size: f32) -> f32 {
    smooth_subtract(d, Vec2::new(d, line).length() - size, size)
}

/// Folds a point by symmetry around the y axis into one of 16 equal wedges. The result's x is
/// along the wedge's middle and y across it, within a 32nd of a turn.
#[inline]
pub(super) fn fold_to_wedge(p: Vec3) -> Vec2 {
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

/// Value noise within -1..=1: hashed values at integer points, smoothstep between them. It changes by at most
/// 5.2 over a unit.
pub(super) fn lattice_noise(p: Vec3, seed: u32) -> f32 {
    let cell = p.floor();
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (fx, fy, fz) = (ease(p.x - cell.x), ease(p.y - cell.y), ease(p.z - cell.z));
    let [x, y, z] = cell.to_array().map(|c| c as i32);
    let at = |dx, dy, dz| hash_lattice_point([x + dx, y + dy, z + dz], seed);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let line = |dy, dz| mix(at(0, dy, dz), at(1, dy, dz), fx);
    let face = |dz| mix(line(0, dz), line(1, dz), fy);
    mix(face(0), face(1), fz)
}

/// A lattice point's value within -1..=1.
fn hash_lattice_point(point: [i32; 3], seed: u32) -> f32 {
    let mut h = seed.wrapping_mul(0x9e37_79b9);
    for c in point {
        h = (h ^ c as u32).wrapping_mul(0x85eb_ca6b);
        h = (h ^ h >> 15).wrapping_mul(0xc2b2_ae35);
        h ^= h >> 13;
    }
    (h >> 8) as f32 / 8_388_607.5 - 1.0
}

#[inline]
fn square_root(x: f32) -> f32 {
    libm::sqrtf(x)
}
