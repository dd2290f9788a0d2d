//! Light at a surface point: damped samples towards the sun, and harmonics for all else.
//!
//! Source: section 4.3 of the paper.

use glam::Vec3;

use crate::constants::{
    AMBIENT, GOLDEN_TURN, SHADOW_DAMPING, SHADOW_RADIUS_FAR, SHADOW_RADIUS_NEAR, SHADOW_SAMPLES,
};
use crate::harmonics;
use crate::march::{Ray, inside_cube};

/// How much of the light from direction `towards` reaches a point in the cube of side `n`, both in
/// voxels: 1, times the damping for every occupied sample on the way out of the cube.
///
/// The samples are dispersed in a cone around the way, wide at the point and narrow at its end;
/// `dither` in 0..1 turns the pattern, so that neighbouring fragments differ.
#[must_use]
pub fn visibility(
    n: usize,
    point: Vec3,
    towards: Vec3,
    dither: f32,
    occupied: impl Fn(Vec3) -> bool,
) -> f32 {
    let way = Ray { origin: point, direction: towards };
    let Some((_, length)) = inside_cube(&way, n as f32) else {
        return 1.0;
    };
    let mut visibility = 1.0;
    for sample in cone(&way, length, dither) {
        if occupied(sample) {
            visibility *= SHADOW_DAMPING;
        }
    }
    visibility
}

/// The dispersed samples along `length` of a way.
pub fn cone(way: &Ray, length: f32, dither: f32) -> impl Iterator<Item = Vec3> {
    let (u, v) = across(way.direction);
    let way = *way;
    let [mut cos, mut sin] = circle(dither);
    (0..SHADOW_SAMPLES).map(move |i| {
        let part = (i as f32 + 0.5) / SHADOW_SAMPLES as f32;
        let cone = SHADOW_RADIUS_NEAR + (SHADOW_RADIUS_FAR - SHADOW_RADIUS_NEAR) * part;
        // Equal areas of the disc, in an order that spreads them along the way.
        let radius =
            cone * (((i * 7 % SHADOW_SAMPLES) as f32 + 0.5) / SHADOW_SAMPLES as f32).sqrt();
        let offset = u * (radius * cos) + v * (radius * sin);
        let [c, s] = GOLDEN_TURN;
        (cos, sin) = (cos * c - sin * s, sin * c + cos * s);
        way.at(part * length) + offset
    })
}

/// A point of the unit circle for a number in 0..1. Sines differ from GPU to GPU, this doesn't.
#[must_use]
pub fn circle(part: f32) -> [f32; 2] {
    let quarter = (part * 4.0).floor();
    let t = part * 4.0 - quarter;
    let [x, y] = [(1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t)];
    let [x, y] = if quarter == 1.0 || quarter == 3.0 { [-y, x] } else { [x, y] };
    if quarter >= 2.0 { [-x, -y] } else { [x, y] }
}

/// The ambient light that a surface with this normal receives, over pi.
#[must_use]
pub fn ambient(normal: Vec3) -> Vec3 {
    harmonics::ambient(&AMBIENT, normal)
}

/// Radiance of the studio in a direction, without the sun: a cool sky over a warm floor, and a
/// large soft box on the side away from the sun.
#[must_use]
pub fn environment(direction: Vec3) -> Vec3 {
    let up = ((direction.y + 0.35) / 1.1).clamp(0.0, 1.0);
    let sky =
        Vec3::new(0.13, 0.11, 0.095).lerp(Vec3::new(0.26, 0.31, 0.39), up * up * (3.0 - 2.0 * up));
    let side = direction.dot(Vec3::new(0.84, 0.30, -0.45)).max(0.0);
    sky + Vec3::new(0.34, 0.44, 0.60) * (side * side * side)
}

/// Two unit vectors across a unit vector and each other (Duff et al. 2017).
#[must_use]
pub fn across(d: Vec3) -> (Vec3, Vec3) {
    let sign = if d.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + d.z);
    let b = d.x * d.y * a;
    (
        Vec3::new(1.0 + sign * d.x * d.x * a, sign * b, -sign * d.x),
        Vec3::new(b, sign + d.y * d.y * a, -d.y),
    )
}
