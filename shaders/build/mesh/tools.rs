//! The tools' bodies in the frame of the hand's grip, pointing to -z. A lathe's y is their -z.

use core::f32::consts::FRAC_PI_2;

use glam::{Affine3A, Quat, Vec3};
use paros_core::session::Tool;

use super::bits::bit_to_nose_metres;
use super::paint::{BEECH, BRASS, GRAPHITE, IRON, RUST, STEEL, TEAL, WALNUT};
use super::shapes::{Ring, bevelled_box, lathe_about_y, upright_rounded_post};
use super::{MeshBuilder, translation};

/// Builds a tool without its bit.
pub(crate) fn tool_body(tool: Tool) -> MeshBuilder {
    // The end of the nose, ahead of the grip.
    let nose_metres = tool.length_um() as f32 * 1e-6 - bit_to_nose_metres(tool);
    let ahead = Affine3A::from_quat(Quat::from_rotation_x(-FRAC_PI_2));
    let mut mesh = MeshBuilder::default();
    match tool {
        Tool::Rotary => mesh.append(&rotary_body_along_y(nose_metres), ahead),
        Tool::Impact => mesh.append(&impact_body_along_y(nose_metres), ahead),
        Tool::FillGun => mesh.append(&fill_gun_body_along_y(nose_metres), ahead),
        Tool::Rasp => mesh.append(&lathe_about_y(&rasp_profile_along_y(nose_metres), 24), ahead),
    }
    mesh
}

fn rotary_body_along_y(nose_y_metres: f32) -> MeshBuilder {
    let profile: Vec<Ring> = vec![
        (0.0, -0.085, GRAPHITE),
        (0.005, -0.085, GRAPHITE),
        (0.0055, -0.072, GRAPHITE),
        (0.013, -0.068, GRAPHITE),
        (0.0195, -0.063, GRAPHITE),
        (0.0215, -0.055, TEAL),
        (0.0215, -0.040, TEAL),
        (0.0225, -0.039, BRASS),
        (0.0225, -0.035, BRASS),
        (0.0205, -0.033, TEAL),
        (0.0185, -0.010, TEAL),
        (0.0180, 0.015, TEAL),
        (0.0190, 0.040, TEAL),
        (0.0190, 0.046, TEAL),
        (0.0165, 0.052, GRAPHITE),
        (0.0125, 0.056, GRAPHITE),
        (0.0105, nose_y_metres - 0.016, GRAPHITE),
        (0.0100, nose_y_metres - 0.014, STEEL),
        (0.0100, nose_y_metres - 0.004, STEEL),
        (0.0070, nose_y_metres, STEEL),
        (0.0, nose_y_metres, IRON),
    ];
    let mut mesh = lathe_about_y(&profile, 24);
    mesh.append(
        &bevelled_box(Vec3::new(0.004, 0.009, 0.0025), 0.001, RUST),
        translation(0.0, 0.026, 0.0185),
    );
    mesh
}

fn impact_body_along_y(nose_y_metres: f32) -> MeshBuilder {
    let profile: Vec<Ring> = vec![
        (0.0, -0.095, BRASS),
        (0.007, -0.095, BRASS),
        (0.008, -0.093, BRASS),
        (0.008, -0.082, BRASS),
        (0.012, -0.080, IRON),
        (0.0185, -0.076, IRON),
        (0.0200, -0.070, IRON),
        (0.0200, -0.050, IRON),
        (0.0185, -0.047, RUST),
        (0.0185, 0.040, RUST),
        (0.0200, 0.043, STEEL),
        (0.0225, 0.047, STEEL),
        (0.0225, 0.078, STEEL),
        (0.0200, 0.083, STEEL),
        (0.0150, nose_y_metres - 0.018, STEEL),
        (0.0130, nose_y_metres - 0.006, STEEL),
        (0.0100, nose_y_metres, STEEL),
        (0.0, nose_y_metres, IRON),
    ];
    let mut mesh = lathe_about_y(&profile, 24);
    for i in 0..3 {
        let ring: [Ring; 6] = [
            (0.017, -0.001, IRON),
            (0.0192, -0.001, IRON),
            (0.0196, 0.0, IRON),
            (0.0196, 0.004, IRON),
            (0.0192, 0.005, IRON),
            (0.017, 0.005, IRON),
        ];
        // Closes the ring with an inner side of its own, hidden in the handle.
        let closed = [ring.as_slice(), &[ring[0]]].concat();
        mesh.append(&lathe_about_y(&closed, 24), translation(0.0, -0.036 + 0.031 * i as f32, 0.0));
    }
    mesh
}

fn fill_gun_body_along_y(nose_y_metres: f32) -> MeshBuilder {
    let profile: Vec<Ring> = vec![
        (0.0, -0.125, IRON),
        (0.010, -0.125, IRON),
        (0.011, -0.121, IRON),
        (0.004, -0.119, STEEL),
        (0.004, -0.072, STEEL),
        (0.016, -0.070, TEAL),
        (0.0195, -0.066, TEAL),
        (0.0200, -0.060, TEAL),
        (0.0200, -0.052, TEAL),
        (0.0180, -0.050, BEECH),
        (0.0190, -0.020, BEECH),
        (0.0185, 0.010, BEECH),
        (0.0175, 0.036, BEECH),
        (0.0205, 0.039, BRASS),
        (0.0205, 0.046, BRASS),
        (0.0225, 0.049, TEAL),
        (0.0225, nose_y_metres - 0.016, TEAL),
        (0.0200, nose_y_metres - 0.010, TEAL),
        (0.0140, nose_y_metres - 0.004, BRASS),
        (0.0140, nose_y_metres, BRASS),
        (0.0, nose_y_metres, BRASS),
    ];
    let mut mesh = lathe_about_y(&profile, 24);
    let lever = upright_rounded_post(0.0045, 0.055, 0.002, 12, STEEL);
    mesh.append(&lever, translation(0.0, 0.036, 0.0225) * Affine3A::from_rotation_x(2.95));
    mesh
}

fn rasp_profile_along_y(nose_y_metres: f32) -> Vec<Ring> {
    vec![
        (0.0, -0.072, WALNUT),
        (0.009, -0.072, WALNUT),
        (0.0155, -0.068, WALNUT),
        (0.0190, -0.060, WALNUT),
        (0.0195, -0.050, WALNUT),
        (0.0165, -0.020, WALNUT),
        (0.0160, 0.005, WALNUT),
        (0.0175, 0.028, WALNUT),
        (0.0150, 0.044, WALNUT),
        (0.0120, 0.050, WALNUT),
        (0.0120, 0.052, BRASS),
        (0.0120, 0.062, BRASS),
        (0.0090, 0.064, BRASS),
        (0.0055, 0.066, STEEL),
        (0.0060, nose_y_metres, STEEL),
        (0.0, nose_y_metres, STEEL),
    ]
}
