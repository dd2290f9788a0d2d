//! A two-handled jar, petals cut around its foot and a wave around its shoulder.

use glam::Vec3;

use super::sdf::{
    carve_groove, distance_from_nearest_of_16_spokes, ellipsoid, fold_x, max, min, round_cone,
    rounded_disc_around_y, smooth_subtract, smooth_union, torus_around_y, v,
};

pub(super) fn signed_distance(p: Vec3) -> f32 {
    let jar = smooth_union(carve_ornament(belly_distance(p), p), neck_distance(p), 5.0);
    let jar = smooth_union(jar, handle_distance(fold_x(p)), 2.5);
    let hollow = ellipsoid(p, v(0.0, 116.0, 0.0), v(12.5, 22.0, 12.5));
    min(smooth_subtract(jar, hollow, 2.0), foot_distance(p))
}

fn foot_distance(p: Vec3) -> f32 {
    let tread = rounded_disc_around_y(p, -4.0..6.0, 23.0, 2.5);
    let stem = round_cone(p, (v(0.0, 4.0, 0.0), 15.0), (v(0.0, 18.0, 0.0), 11.0));
    smooth_union(tread, max(stem, -p.y - 4.0), 6.0)
}

fn belly_distance(p: Vec3) -> f32 {
    let round = ellipsoid(p, v(0.0, 56.0, 0.0), v(37.0, 30.0, 37.0));
    let lower = round_cone(p, (v(0.0, 16.0, 0.0), 9.0), (v(0.0, 48.0, 0.0), 31.0));
    smooth_union(round, lower, 8.0)
}

fn neck_distance(p: Vec3) -> f32 {
    let tube = round_cone(p, (v(0.0, 76.0, 0.0), 16.0), (v(0.0, 102.0, 0.0), 14.5));
    let lip = rounded_disc_around_y(p, 103.0..112.0, 20.5, 4.0);
    min(smooth_union(tube, lip, 5.0), torus_around_y(p, 88.0, 15.0, 2.0))
}

/// A link that hangs between lip and shoulder; the rest of its loop is inside the jar.
fn handle_distance(folded: Vec3) -> f32 {
    let p = folded - v(23.0, 87.0, 0.0);
    let p = v(p.x, p.y - max(-5.0, min(5.0, p.y)), p.z);
    torus_around_y(v(p.x, p.z, p.y), 0.0, 15.0, 5.0)
}

fn carve_ornament(distance: f32, p: Vec3) -> f32 {
    if distance.abs() > 6.0 {
        return distance;
    }
    let band = |height: f32| (p.y - height).abs();
    let distance = carve_groove(distance, min(band(45.0), min(band(64.5), band(68.5))), 1.1);
    let aside = distance_from_nearest_of_16_spokes(p);
    if p.y < 43.0 {
        // Petals: a furrow along every spoke.
        return carve_groove(distance, aside, 1.7);
    }
    if p.y > 47.5 && p.y < 62.0 {
        // A zigzag: half a tooth of it on each side of a spoke.
        let rise = 60.0 - aside * (10.0 / 7.2);
        return carve_groove(distance, (p.y - rise) * 0.58, 1.3);
    }
    distance
}
