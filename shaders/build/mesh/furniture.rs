//! The furniture: the bench, the stool and its turning top; and chips, shards and dust of the stone.

use core::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec3};
use paros_core::internals::{BENCH_REACH, BENCH_TOP, STOOL_RADIUS, STOOL_TOP};
use paros_core::session::{BenchItem, Tool, ToolBit};

use super::bits::rack_mesh;
use super::paint::{
    BEECH, BRASS, CAST, CLAY, IRON, OAK, STONE, WALNUT, hash_fraction, vary_colour,
};
use super::shapes::{
    Ring, bevelled_beam, bevelled_box, divided_box, lathe_about_y, upright_rounded_post,
};
use super::{MeshBuilder, translation};

/// Bits in the rack. The large ones stand behind it.
const BITS: usize = 7;

/// Builds the bench, in the room: its top is the rectangle of the core's `rest_height`.
pub(crate) fn workbench() -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    let v = Vec3::new;
    let [[left, right], [far, near]] = BENCH_REACH;
    let (lo, hi) = (v(left, BENCH_TOP, far), v(right, BENCH_TOP, near));
    let middle = 0.5 * (lo + hi);
    for board in 0..4u32 {
        let x = lo.x + 0.15 * (board as f32 + 0.5);
        let half = v(0.0745, 0.024, 0.5 * (hi.z - lo.z));
        let colour = vary_colour(BEECH, 0.08, board + 3);
        let made = divided_box(half, 0.003, [2, 1, 10], |_| colour);
        mesh.append(&made, translation(x, BENCH_TOP - 0.024, middle.z));
    }
    for z in [lo.z + 0.07, hi.z - 0.07] {
        for x in [lo.x + 0.06, hi.x - 0.06] {
            let leg =
                divided_box(v(0.036, 0.5 * (BENCH_TOP - 0.05), 0.036), 0.005, [1, 4, 1], |_| OAK);
            mesh.append(&leg, translation(x, 0.5 * (BENCH_TOP - 0.05), z));
        }
        mesh.append(
            &bevelled_box(v(0.24, 0.04, 0.02), 0.004, OAK),
            translation(middle.x, BENCH_TOP - 0.09, z),
        );
        mesh.append(&bevelled_box(v(0.24, 0.03, 0.02), 0.004, OAK), translation(middle.x, 0.17, z));
    }
    for x in [lo.x + 0.06, hi.x - 0.06] {
        let apron = divided_box(v(0.016, 0.05, 0.43), 0.004, [1, 1, 6], |_| OAK);
        mesh.append(&apron, translation(x, BENCH_TOP - 0.1, middle.z));
    }
    let board = divided_box(v(0.24, 0.012, 0.45), 0.004, [3, 1, 5], |_| BEECH * 0.85);
    mesh.append(&board, translation(middle.x, 0.212, middle.z));
    add_bench_items(&mut mesh);
    mesh
}

fn add_bench_items(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    // Two rests under each tool, which lies across the bench.
    for tool in Tool::ALL {
        let home = BenchItem::Tool(tool).home_position();
        for (x, high) in [(-0.045, 0.018), (0.035, 0.018)] {
            for side in [-1.0, 1.0f32] {
                let wedge = bevelled_box(v(0.007, high, 0.011), 0.003, WALNUT);
                let lean = Affine3A::from_rotation_x(-0.35 * side);
                mesh.append(
                    &wedge,
                    translation(home.x + x, home.y + high - 0.002, home.z + 0.021 * side) * lean,
                );
            }
        }
    }
    let first = BenchItem::Bit(ToolBit::SmallBall).home_position();
    let last = BenchItem::Bit(ToolBit::ALL[BITS - 1]).home_position();
    let pitch = (last.z - first.z) / (BITS - 1) as f32;
    mesh.append(&rack_mesh(BITS, pitch), Affine3A::from_translation(0.5 * (first + last)));
    add_board_items(mesh);
    add_brush_jar(mesh);
}

/// Adds spare stone and a bucket on the board below.
fn add_board_items(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    let stone = |mesh: &mut MeshBuilder, half: Vec3, x: f32, z: f32, turn: f32| {
        let at = Affine3A::from_rotation_translation(
            Quat::from_rotation_y(turn),
            v(x, 0.224 + half.y, z),
        );
        mesh.append(&bevelled_box(half, 0.012, STONE), at);
    };
    stone(mesh, v(0.11, 0.075, 0.09), 0.6, -0.46, 0.2);
    stone(mesh, v(0.08, 0.05, 0.07), 0.52, -0.18, -0.4);
    let bucket = [
        (0.0, 0.0),
        (0.085, 0.0),
        (0.09, 0.005),
        (0.115, 0.19),
        (0.121, 0.192),
        (0.121, 0.2),
        (0.112, 0.2),
        (0.087, 0.02),
        (0.0, 0.018),
    ];
    mesh.append(
        &lathe_about_y(&bucket.map(|(r, y)| (r, y, IRON * 2.2)), 36),
        translation(0.62, 0.224, 0.1),
    );
}

/// Adds brushes in a jar.
fn add_brush_jar(mesh: &mut MeshBuilder) {
    let v = Vec3::new;
    let jar = [
        (0.0, 0.0),
        (0.036, 0.0),
        (0.041, 0.005),
        (0.043, 0.06),
        (0.038, 0.1),
        (0.04, 0.112),
        (0.035, 0.112),
        (0.03, 0.02),
        (0.0, 0.018),
    ];
    let jar_at = v(0.53, BENCH_TOP, 0.23);
    mesh.append(
        &lathe_about_y(&jar.map(|(r, y)| (r, y, CLAY)), 32),
        Affine3A::from_translation(jar_at),
    );
    for i in 0..5u32 {
        let angle = 1.25 * i as f32;
        let foot = jar_at + v(0.012 * angle.cos(), 0.03, 0.012 * angle.sin());
        let tip =
            jar_at + v(0.034 * angle.cos(), 0.2 + 0.05 * hash_fraction(i), 0.034 * angle.sin());
        mesh.append(
            &bevelled_beam(foot, tip, [0.004, 0.004], 0.0015, vary_colour(BEECH, 0.2, i)),
            Affine3A::IDENTITY,
        );
        let top = Affine3A::from_scale_rotation_translation(
            v(0.007, 0.018, 0.004),
            Quat::from_rotation_y(angle),
            tip,
        );
        mesh.append(&super::shapes::ball(1.0, 10, [IRON, BRASS, CAST][i as usize % 3]), top);
    }
}

/// Thickness of the stool's top, in metres.
const TOP: f32 = 0.042;

/// Builds the stool's foot, in the room: three splayed legs and an iron screw.
pub(crate) fn stool_base() -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    let at = |radius: f32, y: f32, i: u32, turn: f32| {
        let angle = TAU * i as f32 / 3.0 + 0.5 + turn;
        Vec3::new(STOOL_TOP.x + radius * angle.cos(), y, STOOL_TOP.z + radius * angle.sin())
    };
    for i in 0..3 {
        let leg = bevelled_beam(
            at(0.3, 0.012, i, 0.0),
            at(0.085, 0.64, i, 0.0),
            [0.024, 0.03],
            0.005,
            OAK,
        );
        mesh.append(&leg, Affine3A::IDENTITY);
        mesh.append(
            &upright_rounded_post(0.032, 0.016, 0.004, 20, IRON),
            Affine3A::from_translation(at(0.303, 0.0, i, 0.0)),
        );
        let bar = bevelled_beam(
            at(0.225, 0.23, i, 0.0),
            at(0.225, 0.23, i + 1, 0.0),
            [0.015, 0.02],
            0.004,
            OAK,
        );
        mesh.append(&bar, Affine3A::IDENTITY);
    }
    let rings: Vec<Ring> = vec![
        (0.0, 0.40, IRON),
        (0.02, 0.40, IRON),
        (0.021, 0.402, IRON),
        (0.021, 0.575, IRON),
        (0.05, 0.578, OAK),
        (0.125, 0.578, OAK),
        (0.13, 0.583, OAK),
        (0.13, 0.638, OAK),
        (0.125, 0.643, OAK),
        (0.06, 0.643, IRON),
        (0.05, 0.648, IRON),
        (0.05, 0.70, IRON),
        (0.075, 0.706, BRASS),
        (0.16, 0.722, BRASS),
        (0.165, 0.727, BRASS),
        (0.165, STOOL_TOP.y - TOP - 0.006, BRASS),
        (0.0, STOOL_TOP.y - TOP - 0.006, BRASS),
    ];
    mesh.append(&lathe_about_y(&rings, 36), translation(STOOL_TOP.x, 0.0, STOOL_TOP.z));
    mesh
}

/// Builds the turning top about the middle of its upper side.
pub(crate) fn stool_top() -> MeshBuilder {
    const WEDGES: u32 = 12;
    const PER_WEDGE: usize = 5;
    let radius = STOOL_RADIUS;
    let segments = WEDGES as usize * PER_WEDGE;
    let rim = [
        (0.0, -TOP),
        (radius - 0.02, -TOP),
        (radius - 0.012, -TOP + 0.004),
        (radius - 0.003, -TOP + 0.012),
        (radius, -TOP + 0.016),
        (radius, -0.006),
        (radius - 0.002, -0.002),
        (radius - 0.006, 0.0),
        (0.286, 0.0),
        (0.2, 0.0),
        (0.1, 0.0),
        (0.0, 0.0),
    ];
    let mut mesh = lathe_about_y(&rim.map(|(r, y)| (r, y, BEECH)), segments);
    // Wedges of two woods, an inlaid ring, and a rim that is darker all round.
    let mut centre = vec![Vec3::ZERO; mesh.corners.len()];
    for triangle in &mut mesh.triangles {
        let middle: Vec3 =
            triangle.iter().map(|i| mesh.corners[*i as usize].position).sum::<Vec3>() / 3.0;
        for number in triangle {
            if centre[*number as usize] == Vec3::ZERO {
                centre[*number as usize] = middle;
            } else if wedge_index(centre[*number as usize], WEDGES) != wedge_index(middle, WEDGES) {
                // A corner between two wedges belongs to both: it is split.
                let copy = mesh.corners[*number as usize];
                mesh.corners.push(copy);
                centre.push(middle);
                *number = mesh.corners.len() as u32 - 1;
            }
        }
    }
    for (corner, middle) in mesh.corners.iter_mut().zip(&centre) {
        let on_top = middle.y > -0.0001;
        let far = (middle.x * middle.x + middle.z * middle.z).sqrt();
        corner.colour = match wedge_index(*middle, WEDGES) {
            _ if !on_top || far > 0.29 => WALNUT,
            number if number % 2 == 0 => vary_colour(BEECH, 0.05, number),
            number => vary_colour(BEECH * 0.82, 0.05, number),
        };
    }
    for i in 0..WEDGES {
        let turn = Affine3A::from_rotation_y(TAU * i as f32 / WEDGES as f32);
        let long = if i % 3 == 0 { 0.013 } else { 0.006 };
        mesh.append(
            &bevelled_box(Vec3::new(0.0028, 0.0065, long), 0.0012, BRASS),
            turn * translation(0.0, -0.0155, radius)
                * Affine3A::from_rotation_z(core::f32::consts::FRAC_PI_2),
        );
    }
    mesh
}

fn wedge_index(p: Vec3, count: u32) -> u32 {
    let turn = p.z.atan2(p.x) / TAU + 1.0;
    (turn * count as f32) as u32 % count
}

/// Builds a small faceted splinter, about 1 across: scaled where it is drawn.
pub(crate) fn chip_mesh() -> MeshBuilder {
    let v = Vec3::new;
    faceted_octahedron(&[
        v(0.5, 0.05, 0.1),
        v(-0.45, 0.1, -0.1),
        v(0.05, 0.3, 0.08),
        v(0.0, -0.22, -0.05),
        v(0.1, 0.02, 0.42),
        v(-0.12, -0.05, -0.36),
    ])
}

/// Builds a shard of rough stone, about a unit wide. A falling stone is drawn as such shards.
pub(crate) fn shard_mesh() -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    let corner = |i: usize| {
        let sign = |k: usize| if i >> k & 1 == 0 { -0.5 } else { 0.5 };
        let part = |k: usize| 0.8 + 0.35 * hash_fraction((8 * k + i) as u32 + 300);
        Vec3::new(sign(0) * part(0), sign(1) * part(1), sign(2) * part(2))
    };
    // Two triangles a face, each flat by itself.
    for (axis, side) in [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0), (2, 1)] {
        let (u, w) = ((axis + 1) % 3, (axis + 2) % 3);
        let at = |a: usize, b: usize| corner(side << axis | a << u | b << w);
        let [a, b, c, d] = [at(0, 0), at(1, 0), at(1, 1), at(0, 1)];
        let faces = if side == 1 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
        for [a, b, c] in faces {
            let normal = (b - a).cross(c - a).normalize();
            let corners = [a, b, c].map(|p| mesh.add_corner(p, normal, Vec3::ONE));
            mesh.triangles.push(corners);
        }
    }
    mesh
}

/// Builds a speck of dust, about 1 across.
pub(crate) fn speck_mesh() -> MeshBuilder {
    let v = Vec3::new;
    faceted_octahedron(&[
        v(0.5, 0.0, 0.0),
        v(-0.5, 0.0, 0.0),
        v(0.0, 0.5, 0.0),
        v(0.0, -0.5, 0.0),
        v(0.0, 0.0, 0.5),
        v(0.0, 0.0, -0.5),
    ])
}

/// Builds an octahedron with flat sides over corners at the ends of x, y and z.
fn faceted_octahedron([xp, xn, yp, yn, zp, zn]: &[Vec3; 6]) -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    let white = Vec3::ONE;
    for (x, sx) in [(xp, 1), (xn, -1)] {
        for (y, sy) in [(yp, 1), (yn, -1)] {
            for (z, sz) in [(zp, 1), (zn, -1)] {
                let [a, b, c] = if sx * sy * sz > 0 { [*x, *y, *z] } else { [*x, *z, *y] };
                let normal = (b - a).cross(c - a).normalize();
                let [a, b, c] = [a, b, c].map(|p| mesh.add_corner(p, normal, white));
                mesh.triangles.push([a, b, c]);
            }
        }
    }
    mesh
}
