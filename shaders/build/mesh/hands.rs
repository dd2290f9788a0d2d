//! Leather gloves in the frame of the grip: OpenXR's, where -z runs along what is held from the
//! little finger to the thumb, and x out of the back of the right hand.

use glam::{Affine3A, Vec3};

use super::MeshBuilder;
use super::paint::{LEATHER, WALNUT};
use super::shapes::{lathe_about_y, motion_of_y_axis_onto, round_ended_rod};

const FINGERS: [f32; 4] = [-0.031, -0.0105, 0.0105, 0.030];

/// A hand's shape.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum HandShape {
    Open,
    /// Closed on a handle.
    Closed,
}

/// Builds the right hand.
pub(crate) fn right_hand(shape: HandShape) -> MeshBuilder {
    let closed = shape == HandShape::Closed;
    let mut mesh = MeshBuilder::default();
    let v = Vec3::new;
    add_palm(&mut mesh);
    for (i, z) in FINGERS.into_iter().enumerate() {
        let long = [0.96, 1.0, 0.97, 0.82][i];
        let thick = [0.0100, 0.0102, 0.0098, 0.0088][i];
        let joints = if closed {
            [v(0.029, -0.036, z), v(0.0, -0.0375, z), v(-0.026, -0.025, z), v(-0.0265, 0.002, z)]
        } else {
            let (x, y) = (0.024, -0.04);
            [
                v(x, y, z),
                v(x - 0.008, y - 0.040 * long, z * 1.1),
                v(x - 0.022, y - 0.064 * long, z * 1.12),
                v(x - 0.038, y - 0.080 * long, z * 1.1),
            ]
        };
        add_finger(&mut mesh, &joints, thick);
    }
    let thumb = if closed {
        [v(0.018, 0.030, -0.036), v(-0.012, 0.016, -0.047), v(-0.028, -0.012, -0.046)]
    } else {
        [v(0.018, 0.030, -0.036), v(0.0, 0.010, -0.062), v(-0.012, -0.016, -0.074)]
    };
    add_finger(&mut mesh, &thumb, 0.0112);
    mesh
}

/// Builds the left hand: the right one in a mirror.
pub(crate) fn left_hand(shape: HandShape) -> MeshBuilder {
    right_hand(shape).transformed(Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0)))
}

fn add_palm(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    for (i, z) in FINGERS.into_iter().enumerate() {
        let wrist = v(0.022, 0.052, z * 0.62 + 0.004);
        let knuckle = v(0.027, -0.034, z);
        mesh.append(
            &round_ended_rod(wrist, knuckle, [0.0165, 0.0125], 12, leather_shade(i)),
            Affine3A::IDENTITY,
        );
    }
    let ball = round_ended_rod(
        v(0.012, 0.044, -0.012),
        v(0.010, 0.020, -0.030),
        [0.017, 0.0145],
        12,
        LEATHER,
    );
    mesh.append(&ball, Affine3A::IDENTITY);
    let rings = [
        (0.0, 0.0, LEATHER),
        (0.019, 0.004, LEATHER),
        (0.024, 0.016, LEATHER),
        (0.025, 0.028, WALNUT),
        (0.0265, 0.030, WALNUT),
        (0.0275, 0.044, WALNUT),
        (0.026, 0.046, LEATHER),
        (0.034, 0.085, LEATHER),
        (0.0355, 0.087, WALNUT),
        (0.0355, 0.092, WALNUT),
        (0.033, 0.093, WALNUT),
        (0.0, 0.088, WALNUT),
    ];
    mesh.append(
        &lathe_about_y(&rings, 20),
        motion_of_y_axis_onto(v(0.021, 0.036, 0.002), v(0.026, 0.125, 0.026)),
    );
}

fn add_finger(mesh: &mut MeshBuilder, joints: &[Vec3], radius: f32) {
    for (i, pair) in joints.windows(2).enumerate() {
        let taper = |k: usize| radius * (1.08 - 0.07 * k as f32);
        let part = round_ended_rod(pair[0], pair[1], [taper(i), taper(i + 1)], 8, leather_shade(i));
        mesh.append(&part, Affine3A::IDENTITY);
    }
}

fn leather_shade(i: usize) -> Vec3 {
    super::paint::vary_colour(LEATHER, 0.06, i as u32)
}
