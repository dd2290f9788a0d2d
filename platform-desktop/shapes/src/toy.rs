//! A round little creature with a smile, made to be changed: big smooth forms and few details.

use glam::Vec3;

use crate::sdf::{
    carve_groove, ellipsoid, fold_x, min, round_cone, smooth_subtract, smooth_union, sphere, v,
};

/// Returns the signed distance to the surface.
#[must_use]
pub fn signed_distance(p: Vec3) -> f32 {
    let folded = fold_x(p);
    let body = carve_belly_seam(ellipsoid(folded, v(0.0, 40.0, 0.0), v(30.0, 32.0, 27.0)), folded);
    let creature =
        smooth_union(smooth_union(body, limbs_distance(folded), 4.0), head_distance(folded), 4.0);
    add_face(creature, folded)
}

fn limbs_distance(folded: Vec3) -> f32 {
    let leg = round_cone(folded, (v(15.0, 18.0, 2.0), 13.0), (v(17.0, 10.0, 10.0), 13.0));
    let arm = round_cone(folded, (v(25.0, 54.0, 2.0), 9.0), (v(43.0, 42.0, 9.0), 10.5));
    min(leg, arm)
}

fn head_distance(folded: Vec3) -> f32 {
    let skull = ellipsoid(folded, v(0.0, 88.0, 0.0), v(36.0, 30.0, 30.0));
    let ear = sphere(folded, v(30.0, 111.0, -2.0), 12.5);
    let ear = smooth_subtract(ear, sphere(folded, v(31.0, 112.0, 12.5), 9.0), 2.0);
    smooth_union(skull, ear, 4.0)
}

/// Carves the seam of a round patch on the belly.
fn carve_belly_seam(distance: f32, folded: Vec3) -> f32 {
    if folded.z < 0.0 || distance.abs() > 6.0 {
        return distance;
    }
    carve_groove(distance, ellipsoid(folded, v(0.0, 42.0, 27.0), v(17.0, 19.0, 20.0)), 1.25)
}

fn add_face(distance: f32, folded: Vec3) -> f32 {
    if folded.z < 0.0 || folded.y < 60.0 {
        return distance;
    }
    let snout = ellipsoid(folded, v(0.0, 80.0, 27.0), v(13.0, 10.0, 9.0));
    let distance = smooth_union(distance, snout, 3.0);
    let nose = ellipsoid(folded, v(0.0, 85.0, 35.5), v(5.0, 3.6, 3.6));
    let smile = (v(folded.x, folded.y - 85.5, 0.0).length() - 9.0).abs();
    let distance = if folded.y < 80.0 && folded.x < 8.0 && folded.z > 28.0 {
        carve_groove(distance, smile, 1.4)
    } else {
        distance
    };
    let eye = sphere(folded, v(14.0, 94.0, 24.5), 5.6);
    min(min(distance, nose), eye)
}
