//! Things that stand and hang about the room.

use glam::{Affine3A, Vec3, Vec3Swizzles as _};

use super::extent::{LOW, add_box_between};
use super::paint::{
    BRASS, CAST, CLAY, FRAME, IRON, LEAF, OAK, PLASTER, STONE, WALNUT, hash_fraction, vary_colour,
};
use super::shapes::{
    ball, bevelled_beam, bevelled_box, divided_box, lathe_about_y, round_profile,
    upright_rounded_post,
};
use super::{MeshBuilder, translation};

/// Adds two boards with plaster casts on the far wall, to the right of the sculpture.
pub(super) fn add_shelves(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    let back = LOW.z;
    for (y, left, right) in [(1.36, 0.62, 2.38), (1.9, 0.62, 2.38)] {
        let half = v(0.5 * (right - left), 0.018, 0.13);
        let made = divided_box(half, 0.006, [7, 1, 1], |_| OAK);
        mesh.append(&made, translation(0.5 * (left + right), y - 0.018, back + 0.13));
        for x in [left + 0.22, right - 0.22] {
            add_box_between(
                mesh,
                v(x - 0.012, y - 0.2, back),
                v(x + 0.012, y - 0.036, back + 0.02),
                0.004,
                IRON,
            );
            let strut = bevelled_beam(
                v(x, y - 0.19, back + 0.01),
                v(x, y - 0.04, back + 0.2),
                [0.008, 0.008],
                0.003,
                IRON,
            );
            mesh.append(&strut, Affine3A::IDENTITY);
        }
    }
    let z = back + 0.135;
    mesh.append(&ball(0.09, 32, CAST), translation(0.86, 1.45, z));
    let cone =
        [(0.0, 0.0), (0.088, 0.0), (0.092, 0.004), (0.092, 0.01), (0.004, 0.215), (0.0, 0.218)];
    mesh.append(&lathe_about_y(&cone.map(|(r, y)| (r, y, CAST)), 32), translation(1.15, 1.36, z));
    let cube =
        Affine3A::from_rotation_translation(glam::Quat::from_rotation_y(0.6), v(1.44, 1.435, z));
    mesh.append(&bevelled_box(Vec3::splat(0.075), 0.006, CAST), cube);
    mesh.append(&vase_about_y(CLAY * 1.1), translation(1.75, 1.36, z));
    mesh.append(
        &torus_about_y(0.075, 0.03),
        Affine3A::from_rotation_translation(glam::Quat::from_rotation_x(1.25), v(2.08, 1.46, z)),
    );
    let egg = Affine3A::from_scale_rotation_translation(
        v(0.075, 0.105, 0.075),
        glam::Quat::IDENTITY,
        v(0.9, 2.03, z),
    );
    mesh.append(&ball(1.0, 28, CAST), egg);
    mesh.append(&upright_rounded_post(0.055, 0.22, 0.006, 32, CAST), translation(1.2, 1.9, z));
    mesh.append(&plaster_bust(), translation(1.55, 1.9, z));
    for (i, wide) in [0.036f32, 0.03, 0.042, 0.026, 0.034].into_iter().enumerate() {
        let x = 1.93 + 0.075 * i as f32;
        let tall = 0.19 + 0.05 * hash_fraction(i as u32 + 7);
        let cover = [CLAY, FRAME, OAK, WALNUT * 1.4, PLASTER * 0.8][i];
        add_box_between(
            mesh,
            v(x - wide, 1.9, z - 0.08),
            v(x + wide - 0.002, 1.9 + tall, z + 0.07),
            0.004,
            cover,
        );
    }
}

/// Builds a plain bust: shoulders, neck and a head turned aside.
fn plaster_bust() -> MeshBuilder {
    let mut bust = MeshBuilder::default();
    let rings = [
        (0.0, 0.0),
        (0.062, 0.0),
        (0.066, 0.004),
        (0.066, 0.02),
        (0.045, 0.032),
        (0.042, 0.045),
        (0.085, 0.075),
        (0.102, 0.105),
        (0.095, 0.13),
        (0.06, 0.15),
        (0.04, 0.165),
        (0.036, 0.2),
        (0.0, 0.21),
    ];
    let flat = Affine3A::from_scale(Vec3::new(1.0, 1.0, 0.72));
    let rounded = round_profile(&rings.map(|(r, y)| (r, y, CAST)), 2);
    bust.append(&lathe_about_y(&rounded, 32), flat);
    let turned = glam::Quat::from_rotation_y(-0.6) * glam::Quat::from_rotation_x(0.12);
    let skull = Affine3A::from_scale_rotation_translation(
        Vec3::new(0.058, 0.08, 0.07),
        turned,
        Vec3::new(0.0, 0.265, 0.004),
    );
    bust.append(&ball(1.0, 28, CAST), skull);
    let nose = Affine3A::from_scale_rotation_translation(
        Vec3::new(0.011, 0.026, 0.016),
        turned,
        Vec3::new(-0.036, 0.26, 0.06),
    );
    bust.append(&ball(1.0, 16, CAST), nose);
    bust
}

fn vase_about_y(colour: Vec3) -> MeshBuilder {
    let rings = [
        (0.0, 0.0),
        (0.05, 0.0),
        (0.055, 0.005),
        (0.05, 0.02),
        (0.072, 0.06),
        (0.088, 0.11),
        (0.08, 0.16),
        (0.05, 0.2),
        (0.034, 0.235),
        (0.036, 0.265),
        (0.052, 0.285),
        (0.05, 0.29),
        (0.03, 0.268),
        (0.026, 0.23),
        (0.0, 0.22),
    ];
    lathe_about_y(&round_profile(&rings.map(|(r, y)| (r, y, colour)), 2), 32)
}

/// Builds a torus about y, around the origin.
fn torus_about_y(ring_radius: f32, tube_radius: f32) -> MeshBuilder {
    let ring = |i: u32| {
        let angle = core::f32::consts::TAU * (i % 18) as f32 / 18.0;
        (ring_radius + tube_radius * angle.cos(), tube_radius * angle.sin(), CAST)
    };
    lathe_about_y(&(0..=18).map(ring).collect::<Vec<_>>(), 32)
}

/// Adds blocks of stone in one corner; in the other a plinth with an amphora.
pub(super) fn add_corner_items(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    let plinth = v(-1.72, 0.0, -2.45);
    let mut stand = |half: Vec3, y: f32| {
        let made = divided_box(half, 0.008, [2, 5, 2], |_| CAST * 0.96);
        mesh.append(&made, Affine3A::from_translation(plinth + Vec3::Y * y));
    };
    stand(v(0.22, 0.05, 0.22), 0.05);
    stand(v(0.185, 0.42, 0.185), 0.5);
    stand(v(0.21, 0.03, 0.21), 0.93);
    let tall = Affine3A::from_scale_rotation_translation(
        Vec3::splat(1.55),
        glam::Quat::IDENTITY,
        plinth + Vec3::Y * 0.96,
    );
    mesh.append(&vase_about_y(CAST), tall);
    for (i, (at, half, turn)) in [
        (v(2.12, 0.19, -2.45), v(0.33, 0.19, 0.26), 0.1f32),
        (v(2.2, 0.52, -2.5), v(0.22, 0.14, 0.2), -0.25),
        (v(1.5, 0.13, -2.62), v(0.2, 0.13, 0.19), 0.5),
        (v(2.24, 0.16, -1.72), v(0.2, 0.16, 0.24), -0.12),
    ]
    .into_iter()
    .enumerate()
    {
        let mut stone = divided_box(half, 0.02, [4, 4, 4], |_| STONE);
        roughen_corners(&mut stone, i as u32);
        mesh.append(
            &stone,
            Affine3A::from_rotation_translation(glam::Quat::from_rotation_y(turn), at),
        );
    }
}

/// Moves a block's corners about a little, the same way where they coincide.
fn roughen_corners(stone: &mut MeshBuilder, seed: u32) {
    for corner in &mut stone.corners {
        let p = corner.position;
        let wave = |a: Vec3| (p.dot(a) * 14.0 + seed as f32).sin();
        let push = Vec3::new(
            wave(Vec3::new(0.3, 1.0, 0.7)),
            wave(Vec3::new(1.0, 0.2, -0.8)),
            wave(Vec3::new(-0.6, 0.9, 0.4)),
        );
        corner.position += push * 0.011;
        corner.normal = (corner.normal + push.zxy() * 0.16).normalize();
    }
}

/// Adds an enamel lamp that hangs over the bench.
pub(super) fn add_lamp(mesh: &mut MeshBuilder) {
    let at = translation(0.62, 2.2, -0.32);
    let rings = [
        (0.0, 0.13, IRON),
        (0.018, 0.13, IRON),
        (0.03, 0.128, FRAME),
        (0.06, 0.12, FRAME),
        (0.12, 0.08, FRAME),
        (0.16, 0.03, FRAME),
        (0.185, 0.0, FRAME),
        (0.185, -0.004, FRAME),
        (0.18, -0.004, CAST),
        (0.155, 0.028, CAST),
        (0.115, 0.072, CAST),
        (0.06, 0.105, CAST),
        (0.0, 0.118, CAST),
    ];
    let mut dome = lathe_about_y(&round_profile(&rings.map(|(r, y, c)| (r, -y, c)), 2), 32);
    dome = dome.transformed(Affine3A::from_rotation_x(core::f32::consts::PI));
    mesh.append(&dome, at);
    mesh.append(&ball(0.035, 20, CAST), at * translation(0.0, 0.06, 0.0));
    mesh.append(
        &upright_rounded_post(0.02, 0.07, 0.004, 16, BRASS),
        at * translation(0.0, 0.125, 0.0),
    );
    mesh.append(
        &upright_rounded_post(0.004, 1.6, 0.001, 8, IRON),
        at * translation(0.0, 0.19, 0.0),
    );
}

/// Adds a clay pot with a leafy plant.
pub(super) fn add_pot_plant(mesh: &mut MeshBuilder, foot: Vec3, scale: f32) {
    let at =
        Affine3A::from_scale_rotation_translation(Vec3::splat(scale), glam::Quat::IDENTITY, foot);
    let rings = [
        (0.0, 0.0),
        (0.048, 0.0),
        (0.052, 0.004),
        (0.068, 0.105),
        (0.076, 0.107),
        (0.077, 0.135),
        (0.072, 0.138),
        (0.066, 0.125),
        (0.0, 0.12),
    ];
    mesh.append(&lathe_about_y(&rings.map(|(r, y)| (r, y, CLAY)), 30), at);
    for i in 0..18u32 {
        let angle = 2.4 * i as f32;
        let out = 0.03 + 0.075 * hash_fraction(i);
        let tip =
            Vec3::new(out * angle.cos(), 0.17 + 0.16 * hash_fraction(i + 40), out * angle.sin());
        let turn = glam::Quat::from_rotation_y(-angle)
            * glam::Quat::from_rotation_z(-0.5 - 0.9 * hash_fraction(i + 90));
        let leaf = ball(1.0, 8, vary_colour(LEAF, 0.4, i));
        let shape =
            Affine3A::from_scale_rotation_translation(Vec3::new(0.022, 0.05, 0.009), turn, tip);
        mesh.append(&leaf, at * shape);
    }
}
