//! Signed distance functions (SDF) of simple shapes, and smooth operations on them.
//!
//! Lengths are in 1/128 of the box's edge. Only `+ - * /`, square roots and comparisons are used, so every
//! machine computes the same bits. Every shape is Lipschitz with constant 1, and every operation preserves
//! that. Formulas: Hart (1996), "Sphere tracing"; Quilez, "Distance functions".

use std::ops::Range;

use glam::{Vec2, Vec3};

/// Returns the smaller number. Arguments are never NaN, and the sign of a zero doesn't matter.
#[inline]
pub(crate) fn min(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Returns the larger number.
#[inline]
pub(crate) fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Clamps `t` to 0..=1.
#[inline]
pub(crate) fn clamp_to_unit(t: f32) -> f32 {
    max(0.0, min(1.0, t))
}

#[inline]
pub(crate) fn v(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Mirrors a point to x >= 0, for shapes in mirrored pairs.
#[inline]
pub(crate) fn fold_x(p: Vec3) -> Vec3 {
    v(p.x.abs(), p.y, p.z)
}

/// Smooth minimum (Quilez, polynomial): a union with a fillet of about `blend_width / 4`.
#[inline]
pub(crate) fn smooth_union(a: f32, b: f32, blend_width: f32) -> f32 {
    let h = max(blend_width - (a - b).abs(), 0.0);
    min(a, b) - h * h / (4.0 * blend_width)
}

/// Smooth difference: `solid` without `cutter`; `blend_width` as in [`smooth_union`].
#[inline]
pub(crate) fn smooth_subtract(solid: f32, cutter: f32, blend_width: f32) -> f32 {
    -smooth_union(-solid, cutter, blend_width)
}

#[inline]
pub(crate) fn sphere(p: Vec3, centre: Vec3, radius: f32) -> f32 {
    (p - centre).length() - radius
}

/// A lower bound of the distance to an ellipsoid, true along its shortest axis.
#[inline]
pub(crate) fn ellipsoid(p: Vec3, centre: Vec3, radii: Vec3) -> f32 {
    (((p - centre) / radii).length() - 1.0) * min(radii.x, min(radii.y, radii.z))
}

/// A round cone: the union of the spheres on a segment from `a` to `b`, of radii from `radius_a` to
/// `radius_b`.
#[inline]
pub(crate) fn round_cone(p: Vec3, (a, radius_a): (Vec3, f32), (b, radius_b): (Vec3, f32)) -> f32 {
    let (axis, from) = (b - a, p - a);
    let length = axis.length();
    // In the half plane through the axis and `p`: the distance from the axis, and the position along it.
    let y = from.dot(axis) / length;
    let x = square_root(max(from.dot(from) - y * y, 0.0));
    // The flank leans by the sine `s`; the spheres at its ends touch it at its normals' feet.
    let s = (radius_a - radius_b) / length;
    let c = square_root(1.0 - s * s);
    let foot = y * c - x * s;
    if foot < 0.0 {
        from.length() - radius_a
    } else if foot > c * length {
        (p - b).length() - radius_b
    } else {
        x * c + y * s - radius_a
    }
}

/// A chain of round cones through the given centres of spheres, each with its radius.
#[inline]
pub(crate) fn cone_chain(p: Vec3, centres_and_radii: &[(Vec3, f32)]) -> f32 {
    centres_and_radii.windows(2).fold(f32::MAX, |d, pair| min(d, round_cone(p, pair[0], pair[1])))
}

/// A box, its edges rounded by `edge_radius` within the half extents.
#[inline]
pub(crate) fn rounded_box(
    p: Vec3,
    centre: Vec3,
    outer_half_extents: Vec3,
    edge_radius: f32,
) -> f32 {
    let q = (p - centre).abs() - outer_half_extents + Vec3::splat(edge_radius);
    let outside = v(max(q.x, 0.0), max(q.y, 0.0), max(q.z, 0.0)).length();
    outside + min(max(q.x, max(q.y, q.z)), 0.0) - edge_radius
}

/// A disc around the y axis, its rim rounded by `rim_radius` within `radius`.
#[inline]
pub(crate) fn rounded_disc_around_y(
    p: Vec3,
    y_range: Range<f32>,
    radius: f32,
    rim_radius: f32,
) -> f32 {
    let (low, rim) = (y_range.start, rim_radius);
    let half = (y_range.end - low) * 0.5;
    let q =
        Vec2::new(distance_from_y_axis(p) - radius + rim, (p.y - low - half).abs() - half + rim);
    let outside = Vec2::new(max(q.x, 0.0), max(q.y, 0.0)).length();
    outside + min(max(q.x, q.y), 0.0) - rim
}

/// A torus around the y axis.
#[inline]
pub(crate) fn torus_around_y(p: Vec3, centre_y: f32, ring_radius: f32, tube_radius: f32) -> f32 {
    Vec2::new(distance_from_y_axis(p) - ring_radius, p.y - centre_y).length() - tube_radius
}

/// Distance from the y axis.
#[inline]
pub(crate) fn distance_from_y_axis(p: Vec3) -> f32 {
    square_root(p.x * p.x + p.z * p.z)
}

/// Carves a furrow with half width and depth `groove_radius` into the surface `solid_distance` = 0, along the
/// line `line_distance` = 0.
#[inline]
pub(crate) fn carve_groove(solid_distance: f32, line_distance: f32, groove_radius: f32) -> f32 {
    let groove = Vec2::new(solid_distance, line_distance).length() - groove_radius;
    smooth_subtract(solid_distance, groove, groove_radius)
}

/// Carves a furrow of circular section to `depth` (none if zero or less) into the surface `solid_distance` =
/// 0, along the line `line_distance` = 0. It is wide enough for a ball of 15 mm to reach its floor.
#[inline]
pub(crate) fn carve_flute(solid_distance: f32, line_distance: f32, depth: f32) -> f32 {
    // A little more than the ball's radius, 128 * 15 / 450.
    const RADIUS: f32 = 4.8;
    if depth <= 0.0 {
        return solid_distance;
    }
    let flute = Vec2::new(solid_distance - (RADIUS - depth), line_distance).length() - RADIUS;
    smooth_subtract(solid_distance, flute, min(0.6, depth))
}

/// Returns the distance from the nearest of 16 half planes that stand around the y axis like spokes, a 16th
/// of a turn apart. Folds the point by symmetry to within a 32nd of a turn of the first.
#[inline]
pub(crate) fn distance_from_nearest_of_16_spokes(p: Vec3) -> f32 {
    let mut q = Vec2::new(p.x.abs(), p.z.abs());
    // Sines and cosines of the mirrors at 45, 22.5 and 11.25 degrees.
    const MIRRORS: [(f32, f32); 3] =
        [(0.707_106_77, 0.707_106_77), (0.382_683_43, 0.923_879_5), (0.195_090_32, 0.980_785_3)];
    for (sine, cosine) in MIRRORS {
        let beyond = q.y * cosine - q.x * sine;
        if beyond > 0.0 {
            q += Vec2::new(sine, -cosine) * (2.0 * beyond);
        }
    }
    q.y
}

/// Value noise within -1..=1: hashed values at integer points, smoothstep between them. It changes by at most
/// 5.2 over a unit.
pub(crate) fn signed_value_noise(p: Vec3, seed: u32) -> f32 {
    let cell = p.floor();
    let ease = |t: f32| t * t * (3.0 - 2.0 * t);
    let (fx, fy, fz) = (ease(p.x - cell.x), ease(p.y - cell.y), ease(p.z - cell.z));
    let [x, y, z] = cell.to_array().map(|c| c as i32);
    let at = |dx, dy, dz| hash_to_signed_unit([x + dx, y + dy, z + dz], seed);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let line = |dy, dz| mix(at(0, dy, dz), at(1, dy, dz), fx);
    let face = |dz| mix(line(0, dz), line(1, dz), fy);
    mix(face(0), face(1), fz)
}

/// Faceted noise within -1..=1: hashed values at integer points, linear between them over the six tetrahedra of each
/// cube (Kuhn's triangulation), so that it's flat but for creases. It changes by at most 3.5 over a unit.
pub(crate) fn faceted_noise(p: Vec3, seed: u32) -> f32 {
    let cell = p.floor();
    let fraction = (p - cell).to_array();
    let mut corner = cell.to_array().map(|c| c as i32);
    // The corners of the point's tetrahedron lie on a path along the axes, in descending order of the
    // fractions.
    let mut axes = [0, 1, 2];
    for (i, k) in [(0, 1), (1, 2), (0, 1)] {
        if fraction[axes[i]] < fraction[axes[k]] {
            axes.swap(i, k);
        }
    }
    let mut last = hash_to_signed_unit(corner, seed);
    let mut value = last;
    for axis in axes {
        corner[axis] += 1;
        let next = hash_to_signed_unit(corner, seed);
        value += (next - last) * fraction[axis];
        last = next;
    }
    value
}

/// Returns a lattice point's value within -1..=1.
fn hash_to_signed_unit(lattice_point: [i32; 3], seed: u32) -> f32 {
    let mut h = seed.wrapping_mul(0x9e37_79b9);
    for c in lattice_point {
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
