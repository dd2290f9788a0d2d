//! A two-handled jar with petals cut around its foot and a zigzag around its shoulder.
//!
//! Its hollows are wide enough for a ball of 15 mm, like the owl's.

use glam::Vec3;

use crate::sdf::{
    carve_flute, clamp_to_unit, distance_from_nearest_of_16_spokes, distance_from_y_axis,
    ellipsoid, fold_x, max, min, round_cone, rounded_disc_around_y, smooth_subtract, smooth_union,
    torus_around_y, v,
};

/// Returns the signed distance to the surface.
#[must_use]
pub fn signed_distance(p: Vec3) -> f32 {
    let jar = smooth_union(carve_ornament(belly_distance(p), p), neck_distance(p), 8.0);
    let jar = smooth_union(jar, handle_distance(fold_x(p)), 8.0);
    let hollow = ellipsoid(p, v(0.0, 115.0, 0.0), v(14.5, 22.0, 14.5));
    smooth_union(smooth_subtract(jar, hollow, 2.0), foot_distance(p), 8.0)
}

fn foot_distance(p: Vec3) -> f32 {
    let tread = rounded_disc_around_y(p, -4.0..7.0, 29.0, 3.0);
    let stem = round_cone(p, (v(0.0, 4.0, 0.0), 18.0), (v(0.0, 18.0, 0.0), 14.0));
    smooth_union(tread, max(stem, -p.y - 4.0), 8.0)
}

fn belly_distance(p: Vec3) -> f32 {
    let round = ellipsoid(p, v(0.0, 56.0, 0.0), v(45.0, 32.0, 45.0));
    let lower = round_cone(p, (v(0.0, 16.0, 0.0), 12.0), (v(0.0, 48.0, 0.0), 37.0));
    smooth_union(round, lower, 8.0)
}

fn neck_distance(p: Vec3) -> f32 {
    let tube = round_cone(p, (v(0.0, 76.0, 0.0), 19.0), (v(0.0, 101.0, 0.0), 17.0));
    let lip = rounded_disc_around_y(p, 102.0..112.0, 24.0, 4.5);
    let ring = torus_around_y(p, 90.0, 17.5, 3.0);
    smooth_union(smooth_union(tube, lip, 8.0), ring, 6.0)
}

/// Returns the distance to a handle: an elongated torus between lip and shoulder, partly inside the jar.
fn handle_distance(folded: Vec3) -> f32 {
    let p = folded - v(28.0, 87.0, 0.0);
    let p = v(p.x, p.y - max(-5.0, min(5.0, p.y)), p.z);
    torus_around_y(v(p.x, p.z, p.y), 0.0, 16.5, 6.0)
}

fn carve_ornament(distance: f32, p: Vec3) -> f32 {
    if distance.abs() > 8.0 {
        return distance;
    }
    let band = |height: f32| (p.y - height).abs();
    let distance = carve_flute(distance, min(band(41.0), band(70.0)), 1.3);
    let aside = distance_from_nearest_of_16_spokes(p);
    // Petals: a furrow along every spoke, which ends where the spokes are too close together.
    let room = (distance_from_y_axis(p) - 17.0) * 0.1;
    let petal = min(room, (37.0 - p.y) * 0.3);
    let distance = carve_flute(distance, aside, 2.4 * clamp_to_unit(petal));
    // A zigzag with half a tooth on each side of a spoke.
    let rise = 61.5 - aside * (12.0 / 8.6);
    let within = min(p.y - 43.0, 68.0 - p.y) * 0.3;
    carve_flute(distance, (p.y - rise) * 0.58, 1.1 * clamp_to_unit(within))
}
