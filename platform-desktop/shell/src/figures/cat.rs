//! A cat that sits upright, its tail around its feet.

use glam::Vec3;

use super::sdf::{
    carve_groove, cone_chain, ellipsoid, fold_x, min, round_cone, rounded_box, smooth_subtract,
    smooth_union, sphere, v,
};

pub(super) fn signed_distance(p: Vec3) -> f32 {
    let folded = fold_x(p);
    let torso = smooth_union(body_distance(folded), legs_distance(folded), 5.0);
    let animal = smooth_union(torso, head_distance(folded), 6.0);
    let animal = min(animal, tail_distance(p));
    min(add_face(animal, folded), plinth_distance(p))
}

fn plinth_distance(p: Vec3) -> f32 {
    let distance = rounded_box(p, v(0.0, 1.0, 0.0), v(36.0, 9.0, 38.0), 3.0);
    carve_groove(distance, p.y - 5.5, 1.0)
}

fn body_distance(folded: Vec3) -> f32 {
    let trunk = cone_chain(
        folded,
        &[
            (v(0.0, 27.0, -13.0), 20.0),
            (v(0.0, 48.0, -2.0), 16.5),
            (v(0.0, 66.0, 5.0), 13.0),
            (v(0.0, 78.0, 7.0), 11.0),
        ],
    );
    let haunch = ellipsoid(folded, v(17.0, 25.0, -9.0), v(11.0, 17.0, 20.0));
    let chest = ellipsoid(folded, v(0.0, 56.0, 11.0), v(11.5, 17.0, 10.0));
    smooth_union(smooth_union(trunk, chest, 8.0), haunch, 4.0)
}

fn legs_distance(folded: Vec3) -> f32 {
    let fore = round_cone(folded, (v(8.5, 50.0, 12.0), 7.0), (v(8.0, 14.0, 19.0), 5.2));
    let paw = ellipsoid(folded, v(8.0, 13.0, 23.0), v(6.0, 5.0, 8.5));
    let hind = ellipsoid(folded, v(19.5, 13.0, 11.0), v(6.5, 5.0, 11.0));
    min(smooth_union(fore, paw, 4.0), hind)
}

fn head_distance(folded: Vec3) -> f32 {
    let skull = ellipsoid(folded, v(0.0, 88.0, 9.0), v(17.5, 15.0, 16.0));
    let cheek = sphere(folded, v(8.0, 82.0, 14.0), 8.5);
    let muzzle = ellipsoid(folded, v(3.2, 81.5, 23.0), v(5.5, 4.6, 5.0));
    let ear = round_cone(folded, (v(10.5, 97.0, 6.0), 7.0), (v(15.5, 113.0, 4.0), 1.8));
    let ear = smooth_subtract(ear, ellipsoid(folded, v(12.5, 103.0, 13.0), v(4.5, 9.0, 7.5)), 1.5);
    let distance = smooth_union(skull, cheek, 6.0);
    smooth_union(smooth_union(distance, muzzle, 4.0), ear, 3.0)
}

fn add_face(distance: f32, folded: Vec3) -> f32 {
    if distance.abs() > 8.0 || folded.y < 70.0 {
        return distance;
    }
    let eye = ellipsoid(folded, v(7.2, 90.0, 23.2), v(4.3, 2.7, 2.4));
    let distance = min(
        smooth_subtract(distance, ellipsoid(folded, v(7.2, 90.0, 25.0), v(5.6, 3.8, 4.0)), 1.0),
        eye,
    );
    let nose = ellipsoid(folded, v(0.0, 85.0, 27.0), v(2.6, 1.9, 2.2));
    min(
        carve_groove(
            distance,
            if folded.y < 84.0 && folded.z > 20.0 { folded.x } else { 9.0 },
            1.1,
        ),
        nose,
    )
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
