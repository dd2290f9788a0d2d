//! What the work happens on: the bench, the stool and its turning top; and what the work leaves.

use core::f32::consts::TAU;

use glam::{Affine3A, Quat, Vec3};
use paros_core::frame::{BOX, STOOL};
use paros_core::tools::{Bit, Tool};
use paros_core::workbench::{BENCH_TOP, Item};

use super::bits::rack;
use super::paint::{BEECH, BRASS, CAST, CLAY, IRON, OAK, STONE, WALNUT, chance, vary};
use super::shapes::{Ring, beam, block, divided_block, lathe, post};
use super::{Mesh, to};

/// Bits that can be exchanged: the fixed ones are always on their tools.
const BITS: usize = 7;

/// The bench, in the room: what rests on it rests on `rest_height`'s rectangle of the core.
pub(crate) fn bench() -> Mesh {
    let mut mesh = Mesh::default();
    let v = Vec3::new;
    let (lo, hi) = (v(0.3, BENCH_TOP, -0.8), v(0.9, BENCH_TOP, 0.2));
    let middle = 0.5 * (lo + hi);
    for board in 0..4u32 {
        let x = lo.x + 0.15 * (board as f32 + 0.5);
        let half = v(0.0745, 0.024, 0.5 * (hi.z - lo.z));
        let colour = vary(BEECH, 0.08, board + 3);
        let made = divided_block(half, 0.003, [2, 1, 10], |_| colour);
        mesh.add(&made, to(x, BENCH_TOP - 0.024, middle.z));
    }
    for z in [lo.z + 0.07, hi.z - 0.07] {
        for x in [lo.x + 0.06, hi.x - 0.06] {
            let leg =
                divided_block(v(0.036, 0.5 * (BENCH_TOP - 0.05), 0.036), 0.005, [1, 4, 1], |_| OAK);
            mesh.add(&leg, to(x, 0.5 * (BENCH_TOP - 0.05), z));
        }
        mesh.add(&block(v(0.24, 0.04, 0.02), 0.004, OAK), to(middle.x, BENCH_TOP - 0.09, z));
        mesh.add(&block(v(0.24, 0.03, 0.02), 0.004, OAK), to(middle.x, 0.17, z));
    }
    for x in [lo.x + 0.06, hi.x - 0.06] {
        let apron = divided_block(v(0.016, 0.05, 0.43), 0.004, [1, 1, 6], |_| OAK);
        mesh.add(&apron, to(x, BENCH_TOP - 0.1, middle.z));
    }
    let board = divided_block(v(0.24, 0.012, 0.45), 0.004, [3, 1, 5], |_| BEECH * 0.85);
    mesh.add(&board, to(middle.x, 0.212, middle.z));
    on_bench(&mut mesh);
    mesh
}

fn on_bench(mesh: &mut Mesh) {
    let v = Vec3::new;
    // Two rests under each tool, which lies across the bench.
    for tool in Tool::ALL {
        let home = Item::Tool(tool).home();
        for (x, high) in [(-0.045, 0.018), (0.035, 0.018)] {
            for side in [-1.0, 1.0f32] {
                let wedge = block(v(0.007, high, 0.011), 0.003, WALNUT);
                let lean = Affine3A::from_rotation_x(-0.35 * side);
                mesh.add(
                    &wedge,
                    to(home.x + x, home.y + high - 0.002, home.z + 0.021 * side) * lean,
                );
            }
        }
    }
    let first = Item::Bit(Bit::SmallBall).home();
    let last = Item::Bit(Bit::ALL[BITS - 1]).home();
    let pitch = (last.z - first.z) / (BITS - 1) as f32;
    mesh.add(&rack(BITS, pitch), Affine3A::from_translation(0.5 * (first + last)));
    on_board(mesh);
    jar(mesh);
}

/// On the board below: spare stone, a bucket and a cast.
fn on_board(mesh: &mut Mesh) {
    let v = Vec3::new;
    let stone = |mesh: &mut Mesh, half: Vec3, x: f32, z: f32, turn: f32| {
        let at = Affine3A::from_rotation_translation(
            Quat::from_rotation_y(turn),
            v(x, 0.224 + half.y, z),
        );
        mesh.add(&block(half, 0.012, STONE), at);
    };
    stone(mesh, v(0.11, 0.075, 0.09), 0.6, -0.58, 0.2);
    stone(mesh, v(0.08, 0.05, 0.07), 0.52, -0.3, -0.4);
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
    mesh.add(&lathe(&bucket.map(|(r, y)| (r, y, IRON * 2.2)), 24), to(0.62, 0.224, -0.02));
}

/// Brushes in a jar.
fn jar(mesh: &mut Mesh) {
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
    let jar_at = v(0.8, BENCH_TOP, 0.1);
    mesh.add(&lathe(&jar.map(|(r, y)| (r, y, CLAY)), 20), Affine3A::from_translation(jar_at));
    for i in 0..5u32 {
        let angle = 1.25 * i as f32;
        let foot = jar_at + v(0.012 * angle.cos(), 0.03, 0.012 * angle.sin());
        let tip = jar_at + v(0.034 * angle.cos(), 0.2 + 0.05 * chance(i), 0.034 * angle.sin());
        mesh.add(&beam(foot, tip, [0.004, 0.004], 0.0015, vary(BEECH, 0.2, i)), Affine3A::IDENTITY);
        let top = Affine3A::from_scale_rotation_translation(
            v(0.007, 0.018, 0.004),
            Quat::from_rotation_y(angle),
            tip,
        );
        mesh.add(&super::shapes::ball(1.0, 6, [IRON, BRASS, CAST][i as usize % 3]), top);
    }
}

/// Thickness of the stool's top, in metres.
const TOP: f32 = 0.042;

/// The stool's foot, in the room: three splayed legs and an iron screw.
pub(crate) fn stool_base() -> Mesh {
    let mut mesh = Mesh::default();
    let at = |radius: f32, y: f32, i: u32, turn: f32| {
        let angle = TAU * i as f32 / 3.0 + 0.5 + turn;
        Vec3::new(STOOL.x + radius * angle.cos(), y, STOOL.z + radius * angle.sin())
    };
    for i in 0..3 {
        let leg = beam(at(0.3, 0.012, i, 0.0), at(0.085, 0.64, i, 0.0), [0.024, 0.03], 0.005, OAK);
        mesh.add(&leg, Affine3A::IDENTITY);
        mesh.add(
            &post(0.032, 0.016, 0.004, 20, IRON),
            Affine3A::from_translation(at(0.303, 0.0, i, 0.0)),
        );
        let bar =
            beam(at(0.225, 0.23, i, 0.0), at(0.225, 0.23, i + 1, 0.0), [0.015, 0.02], 0.004, OAK);
        mesh.add(&bar, Affine3A::IDENTITY);
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
        (0.165, STOOL.y - TOP - 0.006, BRASS),
        (0.0, STOOL.y - TOP - 0.006, BRASS),
    ];
    mesh.add(&lathe(&rings, 30), to(STOOL.x, 0.0, STOOL.z));
    mesh
}

/// The turning top about the middle of its upper side. It just carries the box's corners.
pub(crate) fn stool_top() -> Mesh {
    const WEDGES: u32 = 12;
    const PER_WEDGE: usize = 5;
    let radius = BOX * core::f32::consts::FRAC_1_SQRT_2 + 0.014;
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
    let mut mesh = lathe(&rim.map(|(r, y)| (r, y, BEECH)), segments);
    // Wedges of two woods, an inlaid ring, and a rim that is darker all round.
    let mut centre = vec![Vec3::ZERO; mesh.corners.len()];
    for triangle in &mut mesh.triangles {
        let middle: Vec3 =
            triangle.iter().map(|i| mesh.corners[*i as usize].position).sum::<Vec3>() / 3.0;
        for number in triangle {
            if centre[*number as usize] == Vec3::ZERO {
                centre[*number as usize] = middle;
            } else if wedge(centre[*number as usize], WEDGES) != wedge(middle, WEDGES) {
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
        corner.colour = match wedge(*middle, WEDGES) {
            _ if !on_top || far > 0.29 => WALNUT,
            number if number % 2 == 0 => vary(BEECH, 0.05, number),
            number => vary(BEECH * 0.82, 0.05, number),
        };
    }
    for i in 0..WEDGES {
        let turn = Affine3A::from_rotation_y(TAU * i as f32 / WEDGES as f32);
        let long = if i % 3 == 0 { 0.013 } else { 0.006 };
        mesh.add(
            &block(Vec3::new(0.0028, 0.0065, long), 0.0012, BRASS),
            turn * to(0.0, -0.0155, radius)
                * Affine3A::from_rotation_z(core::f32::consts::FRAC_PI_2),
        );
    }
    mesh
}

fn wedge(p: Vec3, count: u32) -> u32 {
    let turn = p.z.atan2(p.x) / TAU + 1.0;
    (turn * count as f32) as u32 % count
}

/// A small faceted splinter, about 1 across: scaled where it is drawn.
pub(crate) fn chip() -> Mesh {
    let v = Vec3::new;
    faceted(&[
        v(0.5, 0.05, 0.1),
        v(-0.45, 0.1, -0.1),
        v(0.05, 0.3, 0.08),
        v(0.0, -0.22, -0.05),
        v(0.1, 0.02, 0.42),
        v(-0.12, -0.05, -0.36),
    ])
}

/// A speck of dust, about 1 across.
pub(crate) fn speck() -> Mesh {
    let v = Vec3::new;
    faceted(&[
        v(0.5, 0.0, 0.0),
        v(-0.5, 0.0, 0.0),
        v(0.0, 0.5, 0.0),
        v(0.0, -0.5, 0.0),
        v(0.0, 0.0, 0.5),
        v(0.0, 0.0, -0.5),
    ])
}

/// An octahedron with flat sides over corners at the ends of x, y and z.
fn faceted([xp, xn, yp, yn, zp, zn]: &[Vec3; 6]) -> Mesh {
    let mut mesh = Mesh::default();
    let white = Vec3::ONE;
    for (x, sx) in [(xp, 1), (xn, -1)] {
        for (y, sy) in [(yp, 1), (yn, -1)] {
            for (z, sz) in [(zp, 1), (zn, -1)] {
                let [a, b, c] = if sx * sy * sz > 0 { [*x, *y, *z] } else { [*x, *z, *y] };
                let normal = (b - a).cross(c - a).normalize();
                let [a, b, c] = [a, b, c].map(|p| mesh.corner(p, normal, white));
                mesh.triangles.push([a, b, c]);
            }
        }
    }
    mesh
}
