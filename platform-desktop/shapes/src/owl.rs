//! A small owl on a stump, looking a little surprised.
//!
//! Its hollows are wide: a ball of 15 mm (4.3 units) reaches the floor of nearly all of them.

use glam::Vec3;

use crate::sdf::{
    carve_flute, clamp_to_unit, ellipsoid, fold_x, min, round_cone, rounded_disc_around_y,
    smooth_subtract, smooth_union, sphere, v,
};

/// Returns the signed distance to the surface.
#[must_use]
pub fn signed_distance(p: Vec3) -> f32 {
    let folded = fold_x(p);
    let bird = smooth_union(body_distance(p, folded), wings_distance(folded), 8.0);
    let bird = smooth_union(bird, head_distance(folded), 8.0);
    let bird = smooth_union(bird, feet_distance(folded), 8.0);
    smooth_union(bird, stump_distance(p), 9.0)
}

fn stump_distance(p: Vec3) -> f32 {
    let distance = rounded_disc_around_y(p, -4.0..11.0, 46.0, 4.0);
    carve_flute(distance, p.y - 3.0, 1.5)
}

fn body_distance(p: Vec3, folded: Vec3) -> f32 {
    let trunk = round_cone(p, (v(0.0, 38.0, -2.0), 33.0), (v(0.0, 68.0, -2.0), 27.0));
    let tail = round_cone(p, (v(0.0, 32.0, -24.0), 14.0), (v(0.0, 15.0, -32.0), 10.0));
    let distance = smooth_union(trunk, tail, 14.0);
    if distance.abs() > 8.0 || p.z < 0.0 {
        return distance;
    }
    let within = min(23.0 - folded.x, min(67.0 - p.y, p.y - 20.0));
    carve_flute(
        distance,
        scallops_distance(folded.x, 68.0 - p.y),
        1.5 * clamp_to_unit(within * 0.25),
    )
}

/// Returns the distance to the breast feathers' edges: lower half circles in rows of scallops, every second
/// row shifted by half a feather.
fn scallops_distance(x: f32, down: f32) -> f32 {
    let row = (down / 11.0).floor();
    let in_row = |row: f32| {
        let shift = if row - 2.0 * (row * 0.5).floor() > 0.5 { 6.5 } else { 0.0 };
        let x = x + shift;
        let x = x - 13.0 * (x / 13.0 + 0.5).floor();
        let y = down - 11.0 * row - 1.0;
        let across = v(x, y, 0.0).length() - 8.0;
        if y > 0.0 { across.abs() } else { v(x.abs() - 8.0, y, 0.0).length() }
    };
    min(in_row(row), in_row(row - 1.0))
}

fn head_distance(folded: Vec3) -> f32 {
    let skull = ellipsoid(folded, v(0.0, 88.0, 0.0), v(35.0, 23.0, 27.0));
    let tuft = round_cone(folded, (v(19.0, 101.0, 2.0), 9.0), (v(31.0, 113.5, 0.0), 3.2));
    let distance = smooth_union(skull, tuft, 9.0);
    // The two dishes of the face, each with an eye, and the beak between them.
    let distance = smooth_subtract(distance, sphere(folded, v(17.0, 87.5, 38.0), 21.0), 1.5);
    let eye = smooth_union(distance, sphere(folded, v(15.5, 88.5, 14.5), 12.5), 2.0);
    let eye = smooth_subtract(eye, sphere(folded, v(14.6, 88.5, 29.6), 6.0), 0.5);
    let beak = round_cone(folded, (v(0.0, 86.0, 20.0), 6.0), (v(0.0, 73.0, 31.0), 2.6));
    smooth_union(eye, beak, 3.5)
}

fn wings_distance(folded: Vec3) -> f32 {
    let distance = round_cone(folded, (v(26.0, 60.0, -3.0), 15.0), (v(24.0, 18.0, -26.0), 7.0));
    // Flight feathers: furrows that sweep down and back.
    let along = folded.z * 0.85 - folded.y * 0.42 + 20.0;
    let furrow = along - 9.5 * (along / 9.5 + 0.5).floor();
    carve_flute(distance, furrow, 1.6 * clamp_to_unit((56.0 - folded.y) * 0.1))
}

fn feet_distance(folded: Vec3) -> f32 {
    [6.0, 14.0, 22.0].iter().fold(f32::MAX, |distance, &x| {
        let toe = round_cone(folded, (v(13.0, 16.0, 20.0), 5.0), (v(x, 12.0, 33.0), 4.0));
        smooth_union(distance, toe, 5.0)
    })
}
