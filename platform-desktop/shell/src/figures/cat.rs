//! A cat that sits upright, its tail around its feet.

use glam::Vec3;

use super::sdf::{
    carve_groove, cone_chain, ellipsoid, min, mirror_x, round_cone, rounded_box, smooth_subtract,
    smooth_union, sphere, v,
};

pub(super) fn signed_distance(p: Vec3) -> f32 {
    let q = mirror_x(p);
    let torso = smooth_union(body_distance(q), legs_distance(q), 5.0);
    let animal = smooth_union(torso, head_distance(q), 6.0);
    let animal = min(animal, tail_distance(p));
    min(add_face(animal, q), plinth_distance(p))
}

fn plinth_distance(p: Vec3) -> f32 {
    let d = rounded_box(p, v(0.0, 1.0, 0.0), v(36.0, 9.0, 38.0), 3.0);
    carve_groove(d, p.y - 5.5, 1.0)
}

fn body_distance(q: Vec3) -> f32 {
    let trunk = cone_chain(
        q,
        &[
            (v(0.0, 27.0, -13.0), 20.0),
            (v(0.0, 48.0, -2.0), 16.5),
            (v(0.0, 66.0, 5.0), 13.0),
            (v(0.0, 78.0, 7.0), 11.0),
        ],
    );
    let haunch = ellipsoid(q, v(17.0, 25.0, -9.0), v(11.0, 17.0, 20.0));
    let chest = ellipsoid(q, v(0.0, 56.0, 11.0), v(11.5, 17.0, 10.0));
    smooth_union(smooth_union(trunk, chest, 8.0), haunch, 4.0)
}

fn legs_distance(q: Vec3) -> f32 {
    let fore = round_cone(q, (v(8.5, 50.0, 12.0), 7.0), (v(8.0, 14.0, 19.0), 5.2));
    let paw = ellipsoid(q, v(8.0, 13.0, 23.0), v(6.0, 5.0, 8.5));
    let hind = ellipsoid(q, v(19.5, 13.0, 11.0), v(6.5, 5.0, 11.0));
    min(smooth_union(fore, paw, 4.0), hind)
}

fn head_distance(q: Vec3) -> f32 {
    let skull = ellipsoid(q, v(0.0, 88.0, 9.0), v(17.5, 15.0, 16.0));
    let cheek = sphere(q, v(8.0, 82.0, 14.0), 8.5);
    let muzzle = ellipsoid(q, v(3.2, 81.5, 23.0), v(5.5, 4.6, 5.0));
    let ear = round_cone(q, (v(10.5, 97.0, 6.0), 7.0), (v(15.5, 113.0, 4.0), 1.8));
    let ear = smooth_subtract(ear, ellipsoid(q, v(12.5, 103.0, 13.0), v(4.5, 9.0, 7.5)), 1.5);
    let d = smooth_union(skull, cheek, 6.0);
    smooth_union(smooth_union(d, muzzle, 4.0), ear, 3.0)
}

fn add_face(d: f32, q: Vec3) -> f32 {
    if d.abs() > 8.0 || q.y < 70.0 {
        return d;
    }
    let eye = ellipsoid(q, v(7.2, 90.0, 23.2), v(4.3, 2.7, 2.4));
    let d = min(smooth_subtract(d, ellipsoid(q, v(7.2, 90.0, 25.0), v(5.6, 3.8, 4.0)), 1.0), eye);
    let nose = ellipsoid(q, v(0.0, 85.0, 27.0), v(2.6, 1.9, 2.2));
    min(carve_groove(d, if q.y < 84.0 && q.z > 20.0 { q.x } else { 9.0 }, 1.1), nose)
}

fn tail_distance(p: Vec3) -> f32 {
    cone_chain(
        p,
        &[
            (v(6.0, 14.0, -31.0), 5.5),
            (v(24.0, 13.0, -24.0), 5.5),
            (v(30.0, 13.0, -4.0), 5.2),
            (v(29.0, 13.0, 16.0), 5.0),
            (v(20.0, 13.0, 30.0), 4.6),
            (v(5.0, 13.0, 33.0), 4.2),
        ],
    )
}
