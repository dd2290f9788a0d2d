//! Primitive shapes, in metres. All but the sheet are closed, with smooth normals where they are round.

use core::f32::consts::{PI, TAU};

use glam::{Affine3A, Quat, Vec3};

use super::MeshBuilder;

/// Builds a box with bevelled edges about the origin.
pub(crate) fn bevelled_box(half_size: Vec3, bevel: f32, colour: Vec3) -> MeshBuilder {
    divided_box(half_size, bevel, [1; 3], |_| colour)
}

/// Builds a box with bevelled edges about the origin. Each side is divided into `parts` along x, y and z,
/// so that baked light can vary over it. Normals bend over the bevels, so that these look round.
pub(crate) fn divided_box(
    half_size: Vec3,
    bevel: f32,
    parts: [usize; 3],
    colour: impl Fn(Vec3) -> Vec3,
) -> MeshBuilder {
    let half = half_size;
    let mut mesh = MeshBuilder::default();
    let inner = half - Vec3::splat(bevel);
    // For each side, the numbers of its corners, row by row.
    let mut sides: Vec<Vec<u32>> = Vec::new();
    for side in 0..6 {
        let (axis, sign) = (side / 2, if side % 2 == 0 { -1.0 } else { 1.0 });
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        let mut numbers = Vec::new();
        for j in 0..=parts[v] {
            for i in 0..=parts[u] {
                let mut p = Vec3::ZERO;
                p[axis] = half[axis] * sign;
                p[u] = inner[u] * (2.0 * i as f32 / parts[u] as f32 - 1.0);
                p[v] = inner[v] * (2.0 * j as f32 / parts[v] as f32 - 1.0);
                numbers.push(mesh.add_corner(p, Vec3::AXES[axis] * sign, colour(p)));
            }
        }
        let stride = parts[u] + 1;
        for j in 0..parts[v] {
            for i in 0..parts[u] {
                let at = j * stride + i;
                let mut ring = [at, at + 1, at + stride + 1, at + stride].map(|k| numbers[k]);
                if sign < 0.0 {
                    ring.reverse();
                }
                mesh.add_quad(ring);
            }
        }
        sides.push(numbers);
    }
    add_bevels(&mut mesh, &sides, parts);
    mesh
}

/// Builds a flat sheet, open at the back: two edges u and v span it from a corner, each divided into
/// `parts`, and it faces along u x v.
pub(crate) fn flat_sheet(
    corner: Vec3,
    edges: [Vec3; 2],
    parts: [usize; 2],
    colour: impl Fn(Vec3) -> Vec3,
) -> MeshBuilder {
    let [u, v] = edges;
    let mut mesh = MeshBuilder::default();
    let normal = u.cross(v).normalize();
    for j in 0..=parts[1] {
        for i in 0..=parts[0] {
            let p = corner + u * (i as f32 / parts[0] as f32) + v * (j as f32 / parts[1] as f32);
            mesh.add_corner(p, normal, colour(p));
        }
    }
    let stride = parts[0] + 1;
    for j in 0..parts[1] {
        for i in 0..parts[0] {
            let at = j * stride + i;
            mesh.add_quad([at, at + 1, at + stride + 1, at + stride].map(|k| k as u32));
        }
    }
    mesh
}

/// Adds the strips between the sides of a box, and the triangles at its eight corners.
fn add_bevels(mesh: &mut MeshBuilder, sides: &[Vec<u32>], parts: [usize; 3]) {
    let number = |side: usize, steps: [usize; 3]| {
        let axis = side / 2;
        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
        sides[side][steps[v] * (parts[u] + 1) + steps[u]]
    };
    for along in 0..3 {
        let (u, v) = ((along + 1) % 3, (along + 2) % 3);
        for (high_u, high_v) in [(0, 0), (1, 0), (1, 1), (0, 1)] {
            for i in 0..parts[along] {
                let mut near = [0; 3];
                (near[u], near[v]) = (high_u * parts[u], high_v * parts[v]);
                let mut far = near;
                (near[along], far[along]) = (i, i + 1);
                let (a, b) = (2 * u + high_u, 2 * v + high_v);
                let mut ring = [number(a, near), number(b, near), number(b, far), number(a, far)];
                if high_u != high_v {
                    ring.reverse();
                }
                mesh.add_quad(ring);
            }
        }
    }
    for corner in 0..8usize {
        let high = [corner & 1, corner >> 1 & 1, corner >> 2];
        let steps = [0, 1, 2].map(|k| high[k] * parts[k]);
        let [a, b, c] = [0, 1, 2].map(|k| number(2 * k + high[k], steps));
        let outward = (high[0] + high[1] + high[2]) % 2 == 1;
        mesh.add_quad(if outward { [a, b, c, a] } else { [a, c, b, a] });
    }
}

/// A profile point of a surface of revolution: radius, height, and the colour of the segment below.
pub(crate) type Ring = (f32, f32, Vec3);

/// The least cosine of a profile's bend at which the profile counts as round there.
const SMOOTH: f32 = 0.75;

/// Returns the normal of a profile's segment.
fn profile_normal(profile: &[Ring], segment: usize) -> Vec3 {
    let ((r0, y0, _), (r1, y1, _)) = (profile[segment], profile[segment + 1]);
    Vec3::new(y1 - y0, r0 - r1, 0.0).normalize()
}

/// Returns a profile with each of its longer segments divided into `parts`, rounded where it isn't bent
/// sharply (Catmull and Rom 1974).
pub(crate) fn round_profile(profile: &[Ring], parts: usize) -> Vec<Ring> {
    const SHORT: f32 = 0.012;
    let last = profile.len() - 2;
    let point = |i: usize| Vec3::new(profile[i].0, profile[i].1, 0.0);
    let is_round = |inner: usize| {
        profile_normal(profile, inner - 1).dot(profile_normal(profile, inner)) > SMOOTH
    };
    let mut rounded = vec![profile[0]];
    for i in 0..=last {
        let (from, to) = (point(i), point(i + 1));
        let before = if i > 0 && is_round(i) { point(i - 1) } else { from * 2.0 - to };
        let after = if i < last && is_round(i + 1) { point(i + 2) } else { to * 2.0 - from };
        let tangents = [(to - before) * 0.5, (after - from) * 0.5];
        let parts = if from.distance(to) < SHORT { 1 } else { parts };
        for part in 1..parts {
            let t = part as f32 / parts as f32;
            let (s, u) = (t * t * (3.0 - 2.0 * t), 1.0 - t);
            let at = from + (to - from) * s + tangents[0] * (t * u * u) - tangents[1] * (t * t * u);
            rounded.push((at.x.max(1e-4), at.y, profile[i + 1].2));
        }
        rounded.push(profile[i + 1]);
    }
    rounded
}

/// Builds a surface of revolution about y, its profile from the lower end to the upper one. Normals are
/// smooth where the profile is round.
pub(crate) fn lathe_about_y(profile: &[Ring], segments: usize) -> MeshBuilder {
    let mut mesh = MeshBuilder::default();
    let slope = |i: usize| profile_normal(profile, i);
    let last = profile.len() - 2;
    for i in 0..=last {
        let own = slope(i);
        // A pole's normal lies on the axis when the shape is round there.
        let end = |next: Option<usize>, pole: bool, up: f32| match next.map(slope) {
            Some(other) if own.dot(other) > SMOOTH => (own + other).normalize(),
            None if pole && own.y * up > SMOOTH => Vec3::Y * up,
            _ => own,
        };
        let low = end(i.checked_sub(1), profile[i].0 == 0.0, -1.0);
        let high = end((i < last).then_some(i + 1), profile[i + 1].0 == 0.0, 1.0);
        let colour = profile[i + 1].2;
        let rows = [(profile[i], low), (profile[i + 1], high)].map(|((r, y, _), normal)| {
            let numbers: Vec<u32> = (0..=segments)
                .map(|k| {
                    let turn = Quat::from_rotation_y(TAU * (k % segments) as f32 / segments as f32);
                    mesh.add_corner(
                        turn * Vec3::new(r, 0.0, 0.0) + Vec3::Y * y,
                        turn * normal,
                        colour,
                    )
                })
                .collect();
            numbers
        });
        for k in 0..segments {
            mesh.add_quad([rows[0][k], rows[0][k + 1], rows[1][k + 1], rows[1][k]]);
        }
    }
    mesh
}

/// Returns the profile of a ball with this many segments from pole to pole.
pub(crate) fn ball_profile(radius: f32, segments: usize, colour: Vec3) -> Vec<Ring> {
    let point = |i: usize| match i {
        0 => (0.0, -radius, colour),
        i if i == segments => (0.0, radius, colour),
        i => {
            let angle = PI * i as f32 / segments as f32;
            (radius * angle.sin(), -radius * angle.cos(), colour)
        }
    };
    (0..=segments).map(point).collect()
}

/// Builds a ball about the origin.
pub(crate) fn ball(radius: f32, segments: usize, colour: Vec3) -> MeshBuilder {
    lathe_about_y(&ball_profile(radius, segments / 2, colour), segments)
}

/// Builds a rod from `a` to `b` with round ends.
pub(crate) fn round_ended_rod(
    a: Vec3,
    b: Vec3,
    radii: [f32; 2],
    segments: usize,
    colour: Vec3,
) -> MeshBuilder {
    let length = a.distance(b);
    let quarter = segments / 4;
    let mut profile = Vec::new();
    for (end, y) in [(0, 0.0), (1, length)] {
        for i in 0..=quarter {
            let angle = (0.5 * PI) * ((i + end * quarter) as f32 / quarter as f32);
            let pole = (i + end * quarter).is_multiple_of(2 * quarter);
            let r = if pole { 0.0 } else { radii[end] * angle.sin() };
            profile.push((r, y - radii[end] * angle.cos(), colour));
        }
    }
    profile.dedup_by(|b, a| (a.0 - b.0).abs() + (a.1 - b.1).abs() < 1e-6);
    lathe_about_y(&profile, segments).transformed(motion_of_y_axis_onto(a, b))
}

/// Builds an upright post about y with slightly rounded rims, from y = 0 up.
pub(crate) fn upright_rounded_post(
    radius: f32,
    height: f32,
    rim: f32,
    segments: usize,
    colour: Vec3,
) -> MeshBuilder {
    let inner = radius - rim;
    let profile = [
        (0.0, 0.0),
        (inner, 0.0),
        (inner + 0.7 * rim, 0.3 * rim),
        (radius, rim),
        (radius, height - rim),
        (inner + 0.7 * rim, height - 0.3 * rim),
        (inner, height),
        (0.0, height),
    ];
    lathe_about_y(&profile.map(|(r, y)| (r, y, colour)), segments)
}

/// Returns the rigid motion that takes the origin to `a` and the y axis to the direction from `a` to `b`.
pub(crate) fn motion_of_y_axis_onto(a: Vec3, b: Vec3) -> Affine3A {
    Affine3A::from_rotation_translation(Quat::from_rotation_arc(Vec3::Y, (b - a).normalize()), a)
}

/// Builds a bevelled beam from `a` to `b`; `half_section` are half the sides of its section.
pub(crate) fn bevelled_beam(
    a: Vec3,
    b: Vec3,
    half_section: [f32; 2],
    bevel: f32,
    colour: Vec3,
) -> MeshBuilder {
    let length = 0.5 * a.distance(b);
    bevelled_box(Vec3::new(half_section[0], length, half_section[1]), bevel, colour)
        .transformed(motion_of_y_axis_onto(a, b) * super::translation(0.0, length, 0.0))
}
