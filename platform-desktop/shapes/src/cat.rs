//! A cat that sits upright, its tail around its feet.
//!
//! Its hollows are wide enough for a ball of 15 mm, like the owl's.

use glam::Vec3;

use crate::sdf::{
    carve_flute, clamp_to_unit, cone_chain, ellipsoid, fold_x, min, round_cone, rounded_box,
    smooth_subtract, smooth_union, sphere, v,
};

/// Returns the signed distance to the surface.
#[must_use]
pub fn signed_distance(p: Vec3) -> f32 {
    let folded = fold_x(p);
    let torso = smooth_union(body_distance(folded), legs_distance(folded), 8.0);
    let animal = smooth_union(torso, head_distance(folded), 8.0);
    let animal = smooth_union(animal, tail_distance(p), 9.0);
    smooth_union(animal, plinth_distance(p), 9.0)
}

fn plinth_distance(p: Vec3) -> f32 {
    let distance = rounded_box(p, v(0.0, 1.0, 0.0), v(42.0, 9.0, 45.0), 7.0);
    carve_flute(distance, p.y - 3.0, 1.5)
}

fn body_distance(folded: Vec3) -> f32 {
    let trunk = cone_chain(
        folded,
        &[
            (v(0.0, 29.0, -15.0), 25.0),
            (v(0.0, 50.0, -3.0), 21.0),
            (v(0.0, 68.0, 4.0), 17.0),
            (v(0.0, 80.0, 7.0), 14.5),
        ],
    );
    let haunch = ellipsoid(folded, v(22.0, 26.0, -10.0), v(14.0, 19.0, 23.0));
    let chest = ellipsoid(folded, v(0.0, 56.0, 12.0), v(15.0, 20.0, 13.0));
    smooth_union(smooth_union(trunk, chest, 10.0), haunch, 7.0)
}

fn legs_distance(folded: Vec3) -> f32 {
    let fore = round_cone(folded, (v(9.5, 50.0, 14.0), 9.5), (v(10.0, 14.0, 22.0), 8.0));
    let paw = ellipsoid(folded, v(10.0, 13.0, 28.0), v(9.0, 6.5, 10.5));
    let hind = ellipsoid(folded, v(26.0, 13.0, 12.0), v(8.5, 6.5, 13.0));
    // Fills the gap between the legs up to a furrow.
    let between = round_cone(folded, (v(0.0, 50.0, 10.0), 9.0), (v(0.0, 14.0, 17.0), 9.0));
    let fore = smooth_union(smooth_union(fore, paw, 5.0), between, 6.0);
    smooth_union(fore, hind, 9.0)
}

fn head_distance(folded: Vec3) -> f32 {
    let skull = ellipsoid(folded, v(0.0, 89.0, 9.0), v(25.0, 18.5, 20.0));
    let cheek = sphere(folded, v(11.0, 82.0, 15.0), 11.0);
    let ear = round_cone(folded, (v(16.0, 98.0, 5.0), 10.0), (v(22.5, 114.5, 3.0), 2.6));
    let hollow = ellipsoid(folded, v(18.5, 105.0, 14.5), v(7.5, 12.0, 8.0));
    let ear = smooth_subtract(ear, hollow, 1.0);
    let distance = smooth_union(smooth_union(skull, cheek, 8.0), ear, 6.0);
    add_face(distance, folded)
}

fn add_face(distance: f32, folded: Vec3) -> f32 {
    // Almond eyes in shallow sockets, a muzzle, a nose, and the furrow under it.
    let socket = ellipsoid(folded, v(11.5, 91.5, 33.0), v(10.5, 8.5, 8.0));
    let eye = ellipsoid(folded, v(10.5, 91.0, 23.0), v(7.5, 5.2, 5.6));
    let distance = smooth_union(smooth_subtract(distance, socket, 1.0), eye, 1.5);
    let distance = smooth_subtract(distance, sphere(folded, v(10.3, 91.0, 32.3), 5.0), 0.5);
    let muzzle = ellipsoid(folded, v(4.8, 81.0, 26.5), v(7.5, 6.2, 6.5));
    let distance = smooth_union(distance, muzzle, 4.5);
    let under_nose = clamp_to_unit(min(86.0 - folded.y, folded.z - 22.0) * 0.3);
    let distance = carve_flute(distance, folded.x, 1.2 * under_nose);
    let nose = ellipsoid(folded, v(0.0, 86.0, 31.0), v(4.2, 2.8, 3.2));
    smooth_union(distance, nose, 2.0)
}

fn tail_distance(p: Vec3) -> f32 {
    cone_chain(
        p,
        &[
            (v(6.0, 14.0, -37.0), 7.0),
            (v(27.0, 13.5, -30.0), 7.0),
            (v(35.0, 13.5, -8.0), 6.8),
            (v(35.0, 13.0, 14.0), 6.6),
            (v(28.0, 13.0, 30.0), 6.4),
            (v(12.0, 13.0, 39.0), 6.0),
            (v(0.0, 13.0, 39.0), 5.6),
        ],
    )
}
