//! A round little creature with a smile, made to be changed: big smooth forms and few details.

use glam::Vec3;

use super::sdf::{
    carve_groove, ellipsoid, min, mirror_x, round_cone, smooth_subtract, smooth_union, sphere, v,
};

pub(super) fn signed_distance(p: Vec3) -> f32 {
    let q = mirror_x(p);
    let body = carve_belly_seam(ellipsoid(q, v(0.0, 40.0, 0.0), v(30.0, 32.0, 27.0)), q);
    let creature = smooth_union(smooth_union(body, limbs_distance(q), 4.0), head_distance(q), 4.0);
    add_face(creature, q)
}

fn limbs_distance(q: Vec3) -> f32 {
    let leg = round_cone(q, (v(15.0, 18.0, 2.0), 13.0), (v(17.0, 10.0, 10.0), 13.0));
    let arm = round_cone(q, (v(25.0, 54.0, 2.0), 9.0), (v(43.0, 42.0, 9.0), 10.5));
    min(leg, arm)
}

fn head_distance(q: Vec3) -> f32 {
    let skull = ellipsoid(q, v(0.0, 88.0, 0.0), v(36.0, 30.0, 30.0));
    let ear = sphere(q, v(30.0, 111.0, -2.0), 12.5);
    let ear = smooth_subtract(ear, sphere(q, v(31.0, 112.0, 12.5), 9.0), 2.0);
    smooth_union(skull, ear, 4.0)
}

/// The seam of a round patch on the belly.
fn carve_belly_seam(d: f32, q: Vec3) -> f32 {
    if q.z < 0.0 || d.abs() > 6.0 {
        return d;
    }
    carve_groove(d, ellipsoid(q, v(0.0, 42.0, 27.0), v(17.0, 19.0, 20.0)), 1.25)
}

fn add_face(d: f32, q: Vec3) -> f32 {
    if q.z < 0.0 || q.y < 60.0 {
        return d;
    }
    let snout = ellipsoid(q, v(0.0, 80.0, 27.0), v(13.0, 10.0, 9.0));
    let d = smooth_union(d, snout, 3.0);
    let nose = ellipsoid(q, v(0.0, 85.0, 35.5), v(5.0, 3.6, 3.6));
    let smile = (v(q.x, q.y - 85.5, 0.0).length() - 9.0).abs();
    let d = if q.y < 80.0 && q.x < 8.0 && q.z > 28.0 { carve_groove(d, smile, 1.4) } else { d };
    let eye = sphere(q, v(14.0, 94.0, 24.5), 5.6);
    min(min(d, nose), eye)
}
