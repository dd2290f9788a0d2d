//! Leather gloves in the frame of the grip: OpenXR's, where -z runs along what is held from the
//! little finger to the thumb, and x out of the back of the right hand.

use glam::{Affine3A, Vec3};

use super::Mesh;
use super::paint::{LEATHER, WALNUT};
use super::shapes::{along, lathe, rod};

const FINGERS: [f32; 4] = [-0.031, -0.0105, 0.0105, 0.030];

/// The right hand, closed on a handle or open.
pub(crate) fn right(closed: bool) -> Mesh {
    let mut mesh = Mesh::default();
    let v = Vec3::new;
    palm(&mut mesh);
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
        limbs(&mut mesh, &joints, thick);
    }
    let thumb = if closed {
        [v(0.018, 0.030, -0.036), v(-0.012, 0.016, -0.047), v(-0.028, -0.012, -0.046)]
    } else {
        [v(0.018, 0.030, -0.036), v(0.0, 0.010, -0.062), v(-0.012, -0.016, -0.074)]
    };
    limbs(&mut mesh, &thumb, 0.0112);
    mesh
}

/// The left hand: the right one in a mirror.
pub(crate) fn left(closed: bool) -> Mesh {
    right(closed).moved(Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0)))
}

fn palm(mesh: &mut Mesh) {
    let v = Vec3::new;
    for (i, z) in FINGERS.into_iter().enumerate() {
        let wrist = v(0.022, 0.052, z * 0.62 + 0.004);
        let knuckle = v(0.027, -0.034, z);
        mesh.add(&rod(wrist, knuckle, [0.0165, 0.0125], 12, shade(i)), Affine3A::IDENTITY);
    }
    let ball = rod(v(0.012, 0.044, -0.012), v(0.010, 0.020, -0.030), [0.017, 0.0145], 12, LEATHER);
    mesh.add(&ball, Affine3A::IDENTITY);
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
    mesh.add(&lathe(&rings, 20), along(v(0.021, 0.036, 0.002), v(0.026, 0.125, 0.026)));
}

fn limbs(mesh: &mut Mesh, joints: &[Vec3], thick: f32) {
    for (i, pair) in joints.windows(2).enumerate() {
        let taper = |k: usize| thick * (1.08 - 0.07 * k as f32);
        let part = rod(pair[0], pair[1], [taper(i), taper(i + 1)], 8, shade(i));
        mesh.add(&part, Affine3A::IDENTITY);
    }
}

fn shade(i: usize) -> Vec3 {
    super::paint::vary(LEATHER, 0.06, i as u32)
}
