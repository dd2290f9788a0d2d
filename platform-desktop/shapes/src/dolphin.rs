//! A dolphin that leaps over the crest of a wave.
//!
//! Its hollows are wide enough for a ball of 15 mm, like the owl's.

use glam::Vec3;

use crate::sdf::{
    carve_flute, clamp_to_unit, cone_chain, min, round_cone, rounded_disc_around_y, smooth_union,
    sphere, v,
};

/// Returns the signed distance to the surface.
#[must_use]
pub fn signed_distance(p: Vec3) -> f32 {
    let folded_z = v(p.x, p.y, p.z.abs());
    let animal = smooth_union(
        smooth_union(body_distance(folded_z), fins_distance(folded_z), 8.0),
        fluke_distance(folded_z),
        5.0,
    );
    smooth_union(add_face(animal, folded_z), wave_distance(p), 9.0)
}

fn body_distance(folded_z: Vec3) -> f32 {
    let trunk = cone_chain(
        folded_z,
        &[
            (v(-38.0, 48.0, 0.0), 4.5),
            (v(-31.0, 62.0, 0.0), 7.5),
            (v(-19.0, 76.0, 0.0), 12.0),
            (v(-3.0, 86.0, 0.0), 15.5),
            (v(13.0, 85.0, 0.0), 16.5),
            (v(27.0, 76.0, 0.0), 13.5),
        ],
    );
    let beak = round_cone(folded_z, (v(34.0, 66.0, 0.0), 6.0), (v(44.0, 55.0, 0.0), 3.4));
    smooth_union(trunk, beak, 4.0)
}

fn fins_distance(folded_z: Vec3) -> f32 {
    let back = cone_chain(
        folded_z,
        &[(v(-1.0, 97.0, 0.0), 6.0), (v(-11.0, 109.0, 0.0), 3.4), (v(-19.0, 112.0, 0.0), 2.0)],
    );
    let side = cone_chain(
        folded_z,
        &[(v(17.0, 74.0, 11.0), 5.0), (v(9.0, 63.0, 22.0), 3.6), (v(1.0, 58.0, 27.0), 2.2)],
    );
    min(back, side)
}

fn fluke_distance(folded_z: Vec3) -> f32 {
    cone_chain(
        folded_z,
        &[(v(-38.0, 48.0, 0.0), 4.5), (v(-41.0, 38.0, 10.0), 3.8), (v(-38.0, 33.0, 21.0), 2.4)],
    )
}

fn add_face(distance: f32, folded_z: Vec3) -> f32 {
    if folded_z.x < 15.0 || distance.abs() > 6.0 {
        return distance;
    }
    let eye = sphere(folded_z, v(28.5, 74.0, 12.4), 3.6);
    // The mouth: a furrow along the beak that turns up at its end, like a smile.
    let mouth = (folded_z.x - 33.0) * 0.74 + (folded_z.y - 63.0) * 0.67;
    let gap = (folded_z.x - 33.0) * 0.67 + (folded_z.y - 65.0) * 0.74;
    let within = clamp_to_unit(min(mouth + 6.0, 70.0 - folded_z.y) * 0.3);
    smooth_union(carve_flute(distance, gap, 1.2 * within), eye, 1.5)
}

fn wave_distance(p: Vec3) -> f32 {
    let sea = rounded_disc_around_y(p, -4.0..9.0, 46.0, 4.0);
    let swell = cone_chain(
        p,
        &[
            (v(-6.0, 6.0, 0.0), 27.0),
            (v(-9.0, 34.0, 0.0), 17.0),
            (v(0.0, 56.0, 0.0), 11.5),
            (v(9.0, 68.0, 0.0), 9.0),
        ],
    );
    let curl = cone_chain(
        p,
        &[
            (v(0.0, 54.0, 0.0), 10.0),
            (v(16.0, 58.0, 0.0), 7.0),
            (v(27.0, 51.0, 0.0), 5.0),
            (v(27.0, 42.0, 0.0), 3.6),
        ],
    );
    smooth_union(carve_streams(smooth_union(sea, swell, 12.0), p), curl, 9.0)
}

/// Carves streams of water: furrows that follow the wave's back, and one around the rim.
fn carve_streams(distance: f32, p: Vec3) -> f32 {
    if distance.abs() > 6.0 {
        return distance;
    }
    let away = v(p.x - 46.0, p.y - 26.0, 0.0).length() * 0.9;
    let stream = away - 9.5 * (away / 9.5 + 0.5).floor();
    let distance = carve_flute(distance, stream, 1.8 * clamp_to_unit((p.y - 12.0) * 0.1));
    carve_flute(distance, p.y - 2.5, 1.3)
}
