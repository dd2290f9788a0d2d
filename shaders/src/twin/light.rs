//! Light at a surface point: a sampled shadow ray to the sun, spherical harmonics for the rest.
//!
//! Source: section 4.3 of the paper.

use glam::Vec3;

use super::harmonics;
use super::march::{Ray, clip_to_cube};
use crate::constants::{
    AMBIENT_HARMONICS, GOLDEN_ANGLE_COS_SIN, SHADOW_DAMPING, SHADOW_DISC_STRIDE, SHADOW_RADIUS_FAR,
    SHADOW_RADIUS_NEAR, SHADOW_SAMPLES,
};

/// Stochastic soft shadow: returns the visibility, 0 to 1, in direction `to_light` from a point in the cube
/// of `grid_side` voxels. It is the product of the damping of every occupied sample up to the cube's
/// border.
///
/// The samples are dispersed in a cone that is wide at the point and narrow at the border. `dither`
/// in 0..1 rotates the pattern, so that neighbouring fragments differ.
#[must_use]
pub fn cone_visibility(
    grid_side: usize,
    grid_point: Vec3,
    to_light: Vec3,
    dither: f32,
    is_occupied: impl Fn(Vec3) -> bool,
) -> f32 {
    let axis = Ray { origin: grid_point, direction: to_light };
    let Some(span) = clip_to_cube(&axis, grid_side as f32) else {
        return 1.0;
    };
    let mut visibility = 1.0;
    for sample in cone_sample_points(&axis, span.far, dither) {
        if is_occupied(sample) {
            visibility *= SHADOW_DAMPING;
        }
    }
    visibility
}

/// Returns the points sampled in a shadow ray's cone, dispersed around the first `length` of its axis.
pub fn cone_sample_points(axis: &Ray, length: f32, dither: f32) -> impl Iterator<Item = Vec3> {
    let (u, v) = tangent_basis(axis.direction);
    let axis = *axis;
    let [mut cos, mut sin] = rational_circle_point(dither);
    (0..SHADOW_SAMPLES).map(move |i| {
        let part = (i as f32 + 0.5) / SHADOW_SAMPLES as f32;
        let cone = SHADOW_RADIUS_NEAR + (SHADOW_RADIUS_FAR - SHADOW_RADIUS_NEAR) * part;
        // Rings of equal area, in an order that spreads them along the ray.
        let radius = cone
            * (((i * SHADOW_DISC_STRIDE % SHADOW_SAMPLES) as f32 + 0.5) / SHADOW_SAMPLES as f32)
                .sqrt();
        let offset = u * (radius * cos) + v * (radius * sin);
        let [c, s] = GOLDEN_ANGLE_COS_SIN;
        (cos, sin) = (cos * c - sin * s, sin * c + cos * s);
        axis.at(part * length) + offset
    })
}

/// Returns the point of the unit circle at an angle of about `turns`, at least 0 and less than 1, by the
/// rational parametrisation of each quadrant. Unlike sine and cosine, the result is the same on every GPU.
#[must_use]
pub fn rational_circle_point(turns: f32) -> [f32; 2] {
    let quarter = (turns * 4.0).floor();
    let t = turns * 4.0 - quarter;
    let [x, y] = [(1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t)];
    let [x, y] = if quarter == 1.0 || quarter == 3.0 { [-y, x] } else { [x, y] };
    if quarter >= 2.0 { [-x, -y] } else { [x, y] }
}

/// Returns the ambient irradiance over pi of a surface with this normal, in the studio.
#[must_use]
pub fn ambient_over_pi(studio_normal: Vec3) -> Vec3 {
    harmonics::irradiance_over_pi(&AMBIENT_HARMONICS, studio_normal)
}

/// Returns the radiance of the studio in a direction, without the sun: a cool sky over a warm floor, and a
/// large soft box on the side away from the sun.
#[must_use]
pub fn environment_radiance(direction: Vec3) -> Vec3 {
    let up = ((direction.y + 0.35) / 1.1).clamp(0.0, 1.0);
    let sky =
        Vec3::new(0.13, 0.11, 0.095).lerp(Vec3::new(0.26, 0.31, 0.39), up * up * (3.0 - 2.0 * up));
    let side = direction.dot(Vec3::new(0.84, 0.30, -0.45)).max(0.0);
    sky + Vec3::new(0.34, 0.44, 0.60) * (side * side * side)
}

/// Returns an orthonormal basis: two unit vectors at right angles to a unit vector (Duff et al. 2017).
#[must_use]
pub fn tangent_basis(unit_normal: Vec3) -> (Vec3, Vec3) {
    let d = unit_normal;
    let sign = if d.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + d.z);
    let b = d.x * d.y * a;
    (
        Vec3::new(1.0 + sign * d.x * d.x * a, sign * b, -sign * d.x),
        Vec3::new(b, sign + d.y * d.y * a, -d.y),
    )
}
