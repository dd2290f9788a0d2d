//! Brushes voxel by voxel: whether a centre is inside, in wide integers, from the definitions.

use glam::{IVec3, Quat, Vec3};
use paros_core::pose::{Pose, SUB, UNIT};

use super::dense::Dense;

/// A voxel's centre in fixed point.
pub fn centre(voxel: [i32; 3]) -> [i128; 3] {
    voxel.map(|i| i128::from(i) * i128::from(SUB) + i128::from(SUB / 2))
}

/// The voxels whose centres are at most `radius` from the stretch between `a` and `b`.
pub fn capsule(n: usize, a: IVec3, b: IVec3, radius: i32) -> Dense {
    Dense::from_fn(n, |voxel| near_stretch(centre(voxel), wide(a), wide(b), radius.into()))
}

/// The voxels whose centres are in a box of half extents `half` about a pose.
pub fn oriented_box(n: usize, half: IVec3, pose: &Pose) -> Dense {
    Dense::from_fn(n, |voxel| in_moved_box(centre(voxel), half, pose, pose.fixed_position()))
}

/// The voxels whose centres are in a box turned as `pose`, at some time on its straight way from
/// `start` to the pose's position.
pub fn moved_box(n: usize, half: IVec3, pose: &Pose, start: IVec3) -> Dense {
    Dense::from_fn(n, |voxel| in_moved_box(centre(voxel), half, pose, start))
}

/// The square of the greatest way, in voxels, that a corner of the box makes between two turns.
pub fn corner_way(half: IVec3, from: Quat, to: Quat) -> f32 {
    let half = half.as_vec3() / SUB as f32;
    let mut greatest = 0.0f32;
    for k in 0..8 {
        let sign = |bit: i32| if k & bit == 0 { -1.0 } else { 1.0 };
        let corner = half * Vec3::new(sign(1), sign(2), sign(4));
        greatest = greatest.max((from * corner - to * corner).length());
    }
    greatest
}

fn wide(v: IVec3) -> [i128; 3] {
    v.to_array().map(i128::from)
}

fn dot(a: [i128; 3], b: [i128; 3]) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Between the two end planes of the path, the distance is that to its line: a parallelogram's
/// area over its base. Beyond them it is that to an end.
fn near_stretch(p: [i128; 3], a: [i128; 3], b: [i128; 3], radius: i128) -> bool {
    let (path, from_a, from_b) = (minus(b, a), minus(p, a), minus(p, b));
    if dot(from_a, path) > 0 && dot(from_b, path) < 0 {
        let area = cross(from_a, path);
        return dot(area, area) <= radius * radius * dot(path, path);
    }
    [from_a, from_b].iter().any(|&d| dot(d, d) <= radius * radius)
}

fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Whether some t in -1..=1 has |axis . (2p - middle) - t w| <= 2 half along all three axes of the
/// box, `w` being the path in the box's frame. A box that moves is half a unit wider, so that
/// rounding the path loses nothing.
fn in_moved_box(p: [i128; 3], half: IVec3, pose: &Pose, start: IVec3) -> bool {
    let end = pose.fixed_position();
    let path = minus(wide(end), wide(start));
    let middle = [0, 1, 2].map(|i| wide(start)[i] + wide(end)[i]);
    let d = minus(p.map(|i| 2 * i), middle);
    let unit = i128::from(UNIT);
    let wider = i128::from(start != end);
    // The times allowed so far, as fractions with positive denominators.
    let (mut from, mut to) = ((-1, 1), (1, 1));
    for (axis, half) in pose.fixed_axes().into_iter().zip(half.to_array()) {
        let at = dot(wide(axis), d);
        let w = nearest(dot(wide(axis), path), unit) * unit;
        let extent = (2 * i128::from(half) + wider) * unit;
        if w == 0 {
            if at.abs() > extent {
                return false;
            }
            continue;
        }
        let (at, w) = (at * w.signum(), w.abs());
        let (enters, leaves) = ((at - extent, w), (at + extent, w));
        if enters.0 * from.1 > from.0 * enters.1 {
            from = enters;
        }
        if leaves.0 * to.1 < to.0 * leaves.1 {
            to = leaves;
        }
    }
    from.0 * to.1 <= to.0 * from.1
}

/// `a / b` rounded to nearest, halves up.
fn nearest(a: i128, b: i128) -> i128 {
    (2 * a + b).div_euclid(2 * b)
}
