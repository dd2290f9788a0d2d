//! A small owl on a stump, looking a little surprised.

use glam::Vec3;

use super::sdf::{
    carve_groove, ellipsoid, fold_x, max, min, round_cone, rounded_disc_around_y, smooth_subtract,
    smooth_union, sphere, torus_around_y, v,
};

pub(super) fn signed_distance(p: Vec3) -> f32 {
    let folded = fold_x(p);
    let bird = smooth_union(body_distance(p, folded), head_distance(folded), 7.0);
    let bird = min(bird, face_distance(folded));
    min(
        smooth_union(min(bird, wings_distance(folded)), feet_distance(folded), 2.0),
        stump_distance(p),
    )
}

fn stump_distance(p: Vec3) -> f32 {
    let distance = rounded_disc_around_y(p, -4.0..14.0, 36.0, 3.0);
    let distance = carve_groove(distance, p.y - 9.5, 1.0);
    carve_groove(distance, torus_around_y(p, 14.0, 32.0, 0.0), 1.0)
}

fn body_distance(p: Vec3, folded: Vec3) -> f32 {
    let trunk = round_cone(p, (v(0.0, 40.0, -2.0), 27.0), (v(0.0, 66.0, -2.0), 23.0));
    let tail = round_cone(p, (v(0.0, 34.0, -20.0), 11.0), (v(0.0, 16.0, -27.0), 6.0));
    let distance = smooth_union(trunk, tail, 8.0);
    if distance.abs() > 8.0 || p.z < 0.0 {
        return distance;
    }
    // Breast feathers: rows of scallops, every second row shifted by half a feather.
    let row = ((68.0 - p.y) / 9.0).floor();
    let shift = if row - 2.0 * (row * 0.5).floor() > 0.5 { 5.0 } else { 0.0 };
    let x = folded.x + shift;
    let x = x - 10.0 * ((x / 10.0) + 0.5).floor();
    let y = p.y - (68.0 - 9.0 * row);
    let scallop = v(x, y + 1.0, 0.0).length() - 6.5;
    let breast = max(folded.x - 19.0, max(p.y - 66.0, 24.0 - p.y));
    if breast > 0.0 { distance } else { carve_groove(distance, scallop, 1.3) }
}

fn head_distance(folded: Vec3) -> f32 {
    let skull = ellipsoid(folded, v(0.0, 86.0, 0.0), v(28.0, 20.0, 22.0));
    let tuft = round_cone(folded, (v(15.0, 99.0, 2.0), 7.0), (v(26.0, 111.0, 0.0), 2.6));
    let distance = smooth_union(skull, tuft, 7.0);
    // The two dishes of the face.
    smooth_subtract(distance, sphere(folded, v(12.5, 86.0, 36.0), 19.0), 2.0)
}

fn face_distance(folded: Vec3) -> f32 {
    let ball = sphere(folded, v(11.8, 87.5, 14.5), 9.4);
    let iris = v(folded.x - 11.6, folded.y - 87.5, 0.0).length() - 5.4;
    let eye = if folded.z > 18.0 { carve_groove(ball, iris, 1.2) } else { ball };
    let eye = smooth_subtract(eye, sphere(folded, v(11.4, 87.5, 24.6), 2.8), 0.8);
    let beak = round_cone(folded, (v(0.0, 83.0, 19.0), 5.0), (v(0.0, 74.0, 24.5), 2.0));
    min(eye, beak)
}

fn wings_distance(folded: Vec3) -> f32 {
    let distance = round_cone(folded, (v(20.5, 60.0, -3.0), 13.0), (v(18.0, 20.0, -20.0), 4.6));
    // Flight feathers: furrows that sweep down and back.
    let along = folded.z * 0.85 - folded.y * 0.42 + 20.0;
    let furrow = along - 7.5 * (along / 7.5 + 0.5).floor();
    if folded.y > 52.0 || distance.abs() > 6.0 {
        distance
    } else {
        carve_groove(distance, furrow, 1.4)
    }
}

fn feet_distance(folded: Vec3) -> f32 {
    [4.0, 9.5, 15.0].iter().fold(f32::MAX, |distance, &x| {
        let toe = round_cone(folded, (v(9.5, 17.0, 16.0), 4.0), (v(x, 15.0, 27.0), 3.0));
        min(distance, toe)
    })
}
