//! The sculptor's studio: a room of plaster and oak with one large window on the sun's side, and
//! the garden that is seen through it. The visitor stands at the origin and looks to -z.

use glam::{Affine3A, Vec3};

use super::decor::{add_corner_items, add_lamp, add_pot_plant, add_shelves};
use super::extent::{HIGH, LOW, add_box_between};
use super::paint::{
    BEAM, BRASS, CAST, DADO, FRAME, IRON, LEAF, OAK, PLASTER, hash_fraction, vary_colour,
};
use super::shapes::{ball, bevelled_beam, divided_box, flat_sheet, lathe_about_y};
use super::{MeshBuilder, translation};

/// The window in the wall at `LOW.x`. The path of the sun's light to every point of the sculpture's box
/// passes through its upper middle pane.
const WINDOW_Y: [f32; 2] = [0.75, 3.74];
const WINDOW_Z: [f32; 2] = [-0.795, 2.655];
/// Positions of the bars between panes: mullions along z, transoms along y.
const MULLIONS: [f32; 2] = [0.355, 1.505];
const TRANSOMS: [f32; 2] = [1.63, 2.52];

/// Thickness of walls.
const WALL: f32 = 0.28;
/// Height of the lower, darker part of the walls.
const DADO_HEIGHT: f32 = 1.02;

/// Builds everything that stands still, except the bench and the stool.
pub(crate) fn room_mesh() -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    add_floor(&mut mesh);
    add_walls(&mut mesh);
    add_window(&mut mesh);
    add_ceiling(&mut mesh);
    add_trim(&mut mesh);
    add_door(&mut mesh);
    add_shelves(&mut mesh);
    add_corner_items(&mut mesh);
    add_lamp(&mut mesh);
    mesh
}

/// Adds a sheet spanned by two edges from a corner, in cells of about `cell_metres`.
fn add_tiled_sheet(
    mesh: &mut MeshBuilder,
    corner: Vec3,
    edges: [Vec3; 2],
    cell_metres: f32,
    colour: impl Fn(Vec3) -> Vec3,
) {
    let parts = edges.map(|edge| (edge.length() / cell_metres).round().max(1.0) as usize);
    mesh.append(&flat_sheet(corner, edges, parts, colour), Affine3A::IDENTITY);
}

/// Adds boards of oak with bevelled edges, side by side.
fn add_floor(mesh: &mut MeshBuilder) {
    const WIDTH: f32 = 0.2;
    const EDGE: f32 = 0.004;
    let rows = ((HIGH.x - LOW.x) / WIDTH).round() as u32;
    for row in 0..rows {
        let x = LOW.x + WIDTH * row as f32;
        let (mut z, mut board) = (LOW.z, 0);
        while z < HIGH.z - 0.01 {
            let seed = row * 16 + board;
            let long = if board == 0 {
                0.7 + 2.0 * hash_fraction(seed)
            } else {
                1.9 + hash_fraction(seed)
            };
            let end = if HIGH.z - z - long < 0.5 { HIGH.z } else { z + long };
            let colour = vary_colour(OAK, 0.2, seed);
            let mut strip = |x: f32, y: f32, across: Vec3, shade: f32| {
                let edges = [Vec3::new(0.0, 0.0, end - z - 0.003), across];
                let parts = [((end - z) / 0.4).ceil() as usize, 1];
                mesh.append(
                    &flat_sheet(Vec3::new(x, y, z), edges, parts, |_| colour * shade),
                    Affine3A::IDENTITY,
                );
            };
            strip(x, -EDGE, Vec3::new(EDGE, EDGE, 0.0), 0.6);
            strip(x + EDGE, 0.0, Vec3::new(WIDTH - 2.0 * EDGE, 0.0, 0.0), 1.0);
            strip(x + WIDTH - EDGE, 0.0, Vec3::new(EDGE, -EDGE, 0.0), 0.6);
            (z, board) = (end, board + 1);
        }
    }
}

/// Returns the colour of lime plaster, unevenly applied.
fn plaster_colour(p: Vec3) -> Vec3 {
    let cloud = (p.x * 1.9 + p.y * 1.3).sin() * (p.z * 1.7 - p.y * 0.9).sin();
    PLASTER * (1.0 + 0.025 * cloud)
}

fn add_walls(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    let (lo, hi) = (LOW - Vec3::splat(WALL), HIGH + Vec3::splat(WALL));
    let [low, head] = WINDOW_Y;
    let [near, far] = WINDOW_Z;
    let size = HIGH - LOW;
    let up = Vec3::Y * size.y;
    add_tiled_sheet(mesh, LOW, [Vec3::X * size.x, up], 0.3, plaster_colour);
    add_tiled_sheet(mesh, v(HIGH.x, 0.0, HIGH.z), [Vec3::NEG_X * size.x, up], 0.4, plaster_colour);
    add_tiled_sheet(mesh, v(HIGH.x, 0.0, LOW.z), [Vec3::Z * size.z, up], 0.36, plaster_colour);
    let mut left_wall = |z0: f32, z1: f32, y0: f32, y1: f32| {
        let edges = [v(0.0, 0.0, z0 - z1), v(0.0, y1 - y0, 0.0)];
        add_tiled_sheet(mesh, v(LOW.x, y0, z1), edges, 0.3, plaster_colour);
    };
    left_wall(LOW.z, near, 0.0, HIGH.y);
    left_wall(far, HIGH.z, 0.0, HIGH.y);
    left_wall(near, far, 0.0, low);
    left_wall(near, far, head, HIGH.y);
    // Boxes for the walls' thickness, a hair behind the sheets, keep the sun out and frame the window.
    let hair = 0.001;
    for (a, b) in [
        (v(lo.x, -0.3, lo.z), v(hi.x, HIGH.y, LOW.z - hair)),
        (v(lo.x, -0.3, HIGH.z + hair), v(hi.x, HIGH.y, hi.z)),
        (v(HIGH.x + hair, -0.3, lo.z), v(hi.x, HIGH.y, hi.z)),
        (v(lo.x, -0.3, lo.z), v(LOW.x - hair, HIGH.y, near)),
        (v(lo.x, -0.3, far), v(LOW.x - hair, HIGH.y, hi.z)),
        (v(lo.x, -0.3, near), v(LOW.x - hair, low, far)),
        (v(lo.x, head, near), v(LOW.x - hair, HIGH.y, far)),
    ] {
        add_box_between(mesh, a, b, 0.0, PLASTER);
    }
    add_box_between(mesh, v(lo.x, -0.3, lo.z), v(hi.x, -0.012, hi.z), 0.01, IRON);
    add_box_between(mesh, v(lo.x, HIGH.y + 0.02, lo.z), v(hi.x, HIGH.y + 0.2, hi.z), 0.01, IRON);
}

fn add_window(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    let x = LOW.x - 0.16;
    let [low, head] = WINDOW_Y;
    let [near, far] = WINDOW_Z;
    let mut bar = |lo: Vec3, hi: Vec3, bevel| add_box_between(mesh, lo, hi, bevel, FRAME);
    for z in [near, far] {
        bar(v(x - 0.035, low, z - 0.05), v(x + 0.035, head, z + 0.05), 0.008);
    }
    for y in [low, head] {
        bar(v(x - 0.035, y - 0.05, near), v(x + 0.035, y + 0.05, far), 0.008);
    }
    for z in MULLIONS {
        bar(v(x - 0.03, low, z - 0.022), v(x + 0.03, head, z + 0.022), 0.008);
    }
    for y in TRANSOMS {
        bar(v(x - 0.022, y - 0.016, near), v(x + 0.022, y + 0.016, far), 0.006);
    }
    // The sill's board, and a pot of herbs on it.
    add_box_between(
        mesh,
        v(LOW.x - 0.14, low - 0.01, near - 0.1),
        v(LOW.x + 0.13, low + 0.03, far + 0.1),
        0.008,
        OAK,
    );
    add_pot_plant(mesh, v(LOW.x + 0.02, low + 0.03, -0.52), 1.0);
    add_pot_plant(mesh, v(LOW.x + 0.0, low + 0.03, -0.17), 0.72);
    let cup = [
        (0.0, 0.0),
        (0.03, 0.0),
        (0.036, 0.006),
        (0.04, 0.085),
        (0.037, 0.086),
        (0.033, 0.01),
        (0.0, 0.009),
    ];
    mesh.append(
        &lathe_about_y(&cup.map(|(r, y)| (r, y, CAST)), 36),
        translation(LOW.x + 0.04, low + 0.03, 0.2),
    );
}

fn add_ceiling(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    let mut z = LOW.z;
    let mut seed = 900;
    while z < HIGH.z - 0.01 {
        let end = (z + 0.29).min(HIGH.z);
        let colour = vary_colour(PLASTER * 0.85, 0.05, seed);
        add_tiled_sheet(
            mesh,
            v(LOW.x, HIGH.y, end),
            [v(0.0, 0.0, z + 0.004 - end), v(HIGH.x - LOW.x, 0.0, 0.0)],
            0.5,
            |_| colour,
        );
        (z, seed) = (end, seed + 1);
    }
    for z in [-2.75, -1.65, -0.55, 0.55, 1.65, 2.6] {
        let half = Vec3::new(0.5 * (HIGH.x - LOW.x) + 0.05, 0.1, 0.085);
        let made = divided_box(half, 0.012, [6, 1, 1], |_| BEAM);
        mesh.append(&made, translation(0.5 * (LOW.x + HIGH.x), HIGH.y - 0.09, z));
    }
}

/// Adds skirting boards, and a rail over the darker lower part of the walls.
fn add_trim(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    let mut strip = |lo: Vec3, hi: Vec3, colour: Vec3, bevel: f32| {
        let (half, middle) = (0.5 * (hi - lo), 0.5 * (lo + hi));
        let parts = [0, 1, 2].map(|k| ((hi[k] - lo[k]) / 0.45).round().max(1.0) as usize);
        let made = divided_box(half, bevel, parts, |_| colour);
        mesh.append(&made, Affine3A::from_translation(middle));
    };
    let far = WINDOW_Z[1];
    for (low, high, deep, colour, bevel) in [
        (0.0, 0.14, 0.022, OAK * 0.75, 0.007),
        (0.12, DADO_HEIGHT, 0.008, DADO, 0.001),
        (DADO_HEIGHT - 0.02, DADO_HEIGHT + 0.03, 0.024, OAK * 0.75, 0.008),
    ] {
        strip(v(LOW.x, low, LOW.z), v(HIGH.x, high, LOW.z + deep), colour, bevel);
        strip(v(HIGH.x - deep, low, LOW.z), v(HIGH.x, high, HIGH.z), colour, bevel);
        strip(v(LOW.x, low, LOW.z), v(LOW.x + deep, high, WINDOW_Z[0] - 0.1), colour, bevel);
        strip(v(LOW.x, low, far + 0.1), v(LOW.x + deep, high, HIGH.z), colour, bevel);
        strip(v(LOW.x, low, HIGH.z - deep), v(0.55, high, HIGH.z), colour, bevel);
        strip(v(1.75, low, HIGH.z - deep), v(HIGH.x, high, HIGH.z), colour, bevel);
    }
    let top = WINDOW_Y[0] - 0.01;
    strip(v(LOW.x, 0.0, WINDOW_Z[0] - 0.1), v(LOW.x + 0.022, 0.14, far + 0.1), OAK * 0.75, 0.007);
    strip(v(LOW.x, 0.12, WINDOW_Z[0] - 0.1), v(LOW.x + 0.008, top, far + 0.1), DADO, 0.001);
}

fn add_door(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    let z = HIGH.z;
    for (lo, hi) in [(0.55, 0.65), (1.65, 1.75)] {
        add_box_between(mesh, v(lo, 0.0, z - 0.04), v(hi, 2.15, z + 0.01), 0.008, OAK * 0.75);
    }
    add_box_between(mesh, v(0.5, 2.12, z - 0.045), v(1.8, 2.25, z + 0.01), 0.01, OAK * 0.75);
    for board in 0..5u32 {
        let x = 0.65 + 0.2 * board as f32;
        add_box_between(
            mesh,
            v(x + 0.001, 0.01, z - 0.025),
            v(x + 0.199, 2.12, z + 0.01),
            0.005,
            vary_colour(FRAME, 0.1, board),
        );
    }
    for y in [0.35, 1.75] {
        add_box_between(
            mesh,
            v(0.68, y - 0.06, z - 0.04),
            v(1.62, y + 0.06, z - 0.01),
            0.006,
            FRAME * 0.9,
        );
    }
    mesh.append(&ball(0.026, 20, BRASS), translation(0.74, 1.05, z - 0.075));
    mesh.append(
        &bevelled_beam(
            v(0.74, 1.05, z - 0.02),
            v(0.74, 1.05, z - 0.06),
            [0.009, 0.009],
            0.003,
            BRASS,
        ),
        Affine3A::IDENTITY,
    );
}

/// Builds the garden and the sky, which are emissive and cast no shadow.
pub(crate) fn outside_mesh() -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    let haze = |p: Vec3| {
        let up = ((p.y - 0.5) / 11.0).clamp(0.0, 1.0);
        Vec3::new(0.93, 0.93, 0.90).lerp(Vec3::new(0.42, 0.60, 0.86), up.sqrt())
    };
    let sky =
        divided_box(Vec3::new(0.1, 14.0, 22.0), 0.01, [1, 12, 2], |p| haze(p + Vec3::Y * 6.0));
    mesh.append(&sky, translation(-17.0, 6.0, 2.0));
    let lawn = divided_box(Vec3::new(7.0, 0.1, 22.0), 0.01, [4, 1, 3], |p| {
        LEAF.lerp(Vec3::new(0.42, 0.47, 0.30), 1.0 - (p.x + 7.0) / 14.0) * 1.4
    });
    mesh.append(&lawn, translation(-9.9, -0.9, 2.0));
    for i in 0..15u32 {
        let far = hash_fraction(i);
        let size = 0.8 + 1.5 * hash_fraction(i + 50);
        let at = Vec3::new(
            -10.0 - 6.0 * far,
            -0.8 + 0.55 * size,
            -17.0 + 2.5 * i as f32 + hash_fraction(i + 80),
        );
        let near = vary_colour(LEAF * 1.3, 0.25, i + 120);
        let colour = near.lerp(Vec3::new(0.50, 0.58, 0.50), 0.2 + 0.4 * far);
        let mut crown = ball(1.0, 12, colour);
        for corner in &mut crown.corners {
            corner.colour *= 0.8 + 0.25 * corner.position.y;
        }
        let shape = Vec3::new(size, size * (0.9 + 0.5 * hash_fraction(i + 7)), size);
        mesh.append(
            &crown,
            Affine3A::from_scale_rotation_translation(shape, glam::Quat::IDENTITY, at),
        );
    }
    mesh
}
