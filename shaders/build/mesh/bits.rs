//! The bits: exactly the brush that the core cuts with, and a shank behind it.

use glam::{Quat, Vec3};
use paros_core::tools::{Bit, Shape, Tool};

use super::paint::{BRASS, GRAPHITE, PASTE, STEEL};
use super::shapes::{ball, block, lathe};
use super::{Mesh, to};

/// How far behind the bit's centre a tool's nose is, in metres; the shank reaches a little into it.
pub(crate) fn nose(tool: Tool) -> f32 {
    match tool {
        Tool::Rotary => 0.045,
        Tool::Impact => 0.05,
        Tool::FillGun => 0.042,
        Tool::Rasp => 0.04,
    }
}

/// A bit about its centre, working towards -z. The brush comes first, then the shank.
pub(crate) fn bit(bit: Bit) -> Mesh {
    let data = bit.data();
    let colour = match data.tool {
        Tool::FillGun => PASTE,
        Tool::Impact => STEEL * 0.8,
        Tool::Rotary | Tool::Rasp => STEEL,
    };
    let mut mesh = Mesh::default();
    let back = match data.shape {
        Shape::Ball { radius } => {
            let radius = metres(radius);
            let mut head = ball(radius, 24, colour);
            if data.tool == Tool::Rotary {
                flutes(&mut head);
            }
            mesh.add(&head, glam::Affine3A::IDENTITY);
            radius
        }
        Shape::Box { half } => {
            let half = Vec3::from_array(half.map(metres));
            mesh.add(&block(half, 0.0008, colour), glam::Affine3A::IDENTITY);
            half.z
        }
    };
    mesh.add(&shank(data.tool, back), glam::Affine3A::from_quat(Quat::from_rotation_x(0.5 * PI)));
    mesh
}

const PI: f32 = core::f32::consts::PI;

/// What joins a brush that ends at `back` to the nose, about y.
fn shank(tool: Tool, back: f32) -> Mesh {
    let end = nose(tool) + 0.01;
    let start = back - 0.0012;
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
    lathe(&rings, 12)
}

/// Dark lines over a ball, from pole to pole.
fn flutes(ball: &mut Mesh) {
    for corner in &mut ball.corners {
        let p = corner.position;
        let turn = p.z.atan2(p.x) / PI * 8.0 + p.y * 60.0;
        corner.colour *= if turn.rem_euclid(2.0) < 1.0 { 1.0 } else { 0.62 };
    }
}

/// A rack in which bits stand on their shanks, `pitch` metres apart along z.
pub(crate) fn rack(count: usize, pitch: f32) -> Mesh {
    let mut mesh = Mesh::default();
    let half = 0.5 * pitch * count as f32;
    mesh.add(
        &block(Vec3::new(0.034, 0.014, half), 0.004, super::paint::WALNUT),
        to(0.0, 0.014, 0.0),
    );
    for i in 0..count {
        let z = pitch * (i as f32 + 0.5) - half;
        mesh.add(&super::shapes::post(0.0075, 0.004, 0.001, 10, BRASS), to(0.0, 0.0275, z));
    }
    mesh
}

fn metres(micrometres: i32) -> f32 {
    micrometres as f32 * 1e-6
}
