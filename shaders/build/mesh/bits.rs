//! The bits: exactly the brush shape that the core cuts with, and a shank behind it.

use glam::{Quat, Vec3};
use paros_core::internals::BitShape;
use paros_core::session::{Tool, ToolBit};

use super::paint::{BRASS, GRAPHITE, PASTE, STEEL};
use super::shapes::{ball, bevelled_box, lathe_about_y};
use super::{MeshBuilder, translation};

/// Returns the distance from the bit's centre back to the tool's nose, in metres; the shank reaches 10 mm
/// further.
pub(crate) fn bit_to_nose_metres(tool: Tool) -> f32 {
    match tool {
        Tool::Rotary => 0.045,
        Tool::Impact => 0.05,
        Tool::FillGun => 0.042,
        Tool::Rasp => 0.04,
    }
}

/// Builds a bit about its centre, working towards -z: the brush's shape, then the shank.
pub(crate) fn bit_mesh(bit: ToolBit) -> MeshBuilder {
    let data = bit.spec();
    let colour = match data.tool {
        Tool::FillGun => PASTE,
        Tool::Impact => STEEL * 0.8,
        Tool::Rotary | Tool::Rasp => STEEL,
    };
    let mut mesh = MeshBuilder::default();
    let back = match data.shape {
        BitShape::Ball { radius_um } => {
            let radius = metres_from_micrometres(radius_um);
            let mut head = ball(radius, 24, colour);
            if data.tool == Tool::Rotary {
                darken_flutes(&mut head);
            }
            mesh.append(&head, glam::Affine3A::IDENTITY);
            radius
        }
        BitShape::Box { half_extents_um } => {
            let half = Vec3::from_array(half_extents_um.map(metres_from_micrometres));
            mesh.append(&bevelled_box(half, 0.0008, colour), glam::Affine3A::IDENTITY);
            half.z
        }
        BitShape::Disc { radius_um } => {
            let blade = blade_about_y(metres_from_micrometres(radius_um), colour);
            mesh.append(&blade, glam::Affine3A::from_quat(Quat::from_rotation_z(0.5 * PI)));
            // The shank holds the blade at its middle.
            -0.01
        }
    };
    mesh.append(
        &shank_mesh_along_y(data.tool, back),
        glam::Affine3A::from_quat(Quat::from_rotation_x(0.5 * PI)),
    );
    mesh
}

const PI: f32 = core::f32::consts::PI;

/// Builds the shank about y, from `head_end_metres` behind the head's centre to the nose.
fn shank_mesh_along_y(tool: Tool, head_end_metres: f32) -> MeshBuilder {
    let end = bit_to_nose_metres(tool) + 0.01;
    let start = head_end_metres - 0.0012;
    let rings = match tool {
        Tool::FillGun => vec![
            (0.0, start, BRASS),
            (0.0045, start, BRASS),
            (0.0055, start + 0.004, BRASS),
            (0.012, end - 0.006, BRASS),
            (0.012, end, BRASS),
            (0.0, end, BRASS),
        ],
        Tool::Rotary | Tool::Impact | Tool::Rasp => vec![
            (0.0, start, STEEL),
            (0.0040, start, STEEL),
            (0.0040, end - 0.001, STEEL),
            (0.0032, end, STEEL),
            (0.0, end, GRAPHITE),
        ],
    };
    lathe_about_y(&rings, 12)
}

/// Builds a saw's blade about y, as thick as two voxels at 256.
fn blade_about_y(radius: f32, colour: Vec3) -> MeshBuilder {
    let rings = [
        (0.0, -BLADE_HALF_THICKNESS, GRAPHITE),
        (0.3 * radius, -BLADE_HALF_THICKNESS, GRAPHITE),
        (0.92 * radius, -BLADE_HALF_THICKNESS, colour),
        (radius, -BLADE_HALF_THICKNESS, colour * 0.6),
        (radius, BLADE_HALF_THICKNESS, colour * 0.6),
        (0.92 * radius, BLADE_HALF_THICKNESS, colour),
        (0.3 * radius, BLADE_HALF_THICKNESS, GRAPHITE),
        (0.0, BLADE_HALF_THICKNESS, GRAPHITE),
    ];
    lathe_about_y(&rings, 48)
}

const BLADE_HALF_THICKNESS: f32 = 0.0018;

/// Colours a ball with dark helical lines from pole to pole.
fn darken_flutes(ball: &mut MeshBuilder) {
    for corner in &mut ball.corners {
        let p = corner.position;
        let turn = p.z.atan2(p.x) / PI * 8.0 + p.y * 60.0;
        corner.colour *= if turn.rem_euclid(2.0) < 1.0 { 1.0 } else { 0.62 };
    }
}

/// Builds a rack in which bits stand on their shanks, side by side along z.
pub(crate) fn rack_mesh(bit_count: usize, pitch_metres: f32) -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    let half = 0.5 * pitch_metres * bit_count as f32;
    mesh.append(
        &bevelled_box(Vec3::new(0.034, 0.014, half), 0.004, super::paint::WALNUT),
        translation(0.0, 0.014, 0.0),
    );
    for i in 0..bit_count {
        let z = pitch_metres * (i as f32 + 0.5) - half;
        mesh.append(
            &super::shapes::upright_rounded_post(0.0075, 0.004, 0.001, 10, BRASS),
            translation(0.0, 0.0275, z),
        );
    }
    mesh
}

fn metres_from_micrometres(micrometres: i32) -> f32 {
    micrometres as f32 * 1e-6
}
