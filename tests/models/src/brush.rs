//! Model of brush rasterisation: point-in-capsule and point-in-swept-box tests of every voxel's centre, by
//! their naive definitions, in 128-bit integers.

use glam::{IVec3, Quat, Vec3};
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::FIXED_ONE;

use crate::dense::DenseVolume;

/// Returns a voxel's centre in fixed point: [`SUBUNITS_PER_VOXEL`] units a voxel.
pub fn voxel_centre_subunits(voxel: [i32; 3]) -> [i128; 3] {
    voxel.map(|i| {
        i128::from(i) * i128::from(SUBUNITS_PER_VOXEL) + i128::from(SUBUNITS_PER_VOXEL / 2)
    })
}

/// Returns the voxels whose centres are at most `radius_subunits` from a segment.
pub fn capsule_voxels(
    side: usize,
    start_subunits: IVec3,
    end_subunits: IVec3,
    radius_subunits: i32,
) -> DenseVolume {
    let (start, end) = (widen(start_subunits), widen(end_subunits));
    DenseVolume::from_fn(side, |voxel| {
        is_near_segment(voxel_centre_subunits(voxel), start, end, radius_subunits.into())
    })
}

/// Returns the voxels whose centres lie in an oriented box at a pose.
pub fn box_voxels(side: usize, half_extents_subunits: IVec3, pose: &Pose) -> DenseVolume {
    DenseVolume::from_fn(side, |voxel| {
        is_in_swept_box(
            voxel_centre_subunits(voxel),
            half_extents_subunits,
            pose,
            pose.clamped_position_subunits(),
        )
    })
}

/// Returns the voxels whose centres lie in the swept volume of a box that has the pose's rotation and moves
/// straight from `start_subunits` to the pose's position.
pub fn swept_box_voxels(
    side: usize,
    half_extents_subunits: IVec3,
    end_pose: &Pose,
    start_subunits: IVec3,
) -> DenseVolume {
    DenseVolume::from_fn(side, |voxel| {
        is_in_swept_box(
            voxel_centre_subunits(voxel),
            half_extents_subunits,
            end_pose,
            start_subunits,
        )
    })
}

/// Returns the voxels whose centres are within `radius_subunits` of the path of a disc from `start_subunits`
/// to the pose's position, and at most `half_thickness_subunits` off the disc's planes along that path.
pub fn swept_disc_voxels(
    side: usize,
    [radius_subunits, half_thickness_subunits]: [i32; 2],
    end_pose: &Pose,
    start_subunits: IVec3,
) -> DenseVolume {
    let (start, end) = (widen(start_subunits), widen(end_pose.clamped_position_subunits()));
    let normal = widen(end_pose.unit_axes_q14()[0]);
    let [low, high] = [start, end].map(|place| dot(normal, place));
    let half = i128::from(half_thickness_subunits) * i128::from(FIXED_ONE);
    DenseVolume::from_fn(side, |voxel| {
        let centre = voxel_centre_subunits(voxel);
        let height = dot(normal, centre);
        is_near_segment(centre, start, end, radius_subunits.into())
            && height >= low.min(high) - half
            && height <= low.max(high) + half
    })
}

/// Returns the greatest distance, in voxels, between a corner's positions under two rotations of the box.
pub fn longest_corner_chord_voxels(half_extents_subunits: IVec3, from: Quat, to: Quat) -> f32 {
    let half = half_extents_subunits.as_vec3() / SUBUNITS_PER_VOXEL as f32;
    let mut greatest = 0.0f32;
    for k in 0..8 {
        let sign = |bit: i32| if k & bit == 0 { -1.0 } else { 1.0 };
        let corner = half * Vec3::new(sign(1), sign(2), sign(4));
        greatest = greatest.max((from * corner - to * corner).length());
    }
    greatest
}

fn widen(v: IVec3) -> [i128; 3] {
    v.to_array().map(i128::from)
}

fn dot(a: [i128; 3], b: [i128; 3]) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn subtract(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Returns `true` if a point is at most `radius` from a segment. Between the segment's end planes, the
/// distance is that to its line: the area of a parallelogram over its base. Beyond them, it is that to an
/// end.
fn is_near_segment(p: [i128; 3], a: [i128; 3], b: [i128; 3], radius: i128) -> bool {
    let (path, from_a, from_b) = (subtract(b, a), subtract(p, a), subtract(p, b));
    if dot(from_a, path) > 0 && dot(from_b, path) < 0 {
        let area = cross(from_a, path);
        return dot(area, area) <= radius * radius * dot(path, path);
    }
    [from_a, from_b].iter().any(|&d| dot(d, d) <= radius * radius)
}

fn cross(a: [i128; 3], b: [i128; 3]) -> [i128; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Slab test of a point against a moving box. Returns `true` if some t in -1..=1 fulfils
/// `|axis . (2p - middle) - t w| <= 2 half` along all three axes of the box, where `w` is the path in the
/// box's frame. A moving box is half a unit wider, so that rounding the path loses nothing.
fn is_in_swept_box(p: [i128; 3], half: IVec3, pose: &Pose, start: IVec3) -> bool {
    let end = pose.clamped_position_subunits();
    let path = subtract(widen(end), widen(start));
    let middle = [0, 1, 2].map(|i| widen(start)[i] + widen(end)[i]);
    let d = subtract(p.map(|i| 2 * i), middle);
    let unit = i128::from(FIXED_ONE);
    let wider = i128::from(start != end);
    // The interval of t so far, as fractions with positive denominators.
    let (mut from, mut to) = ((-1, 1), (1, 1));
    for (axis, half) in pose.unit_axes_q14().into_iter().zip(half.to_array()) {
        let at = dot(widen(axis), d);
        let w = divide_rounding_half_up(dot(widen(axis), path), unit) * unit;
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

/// Returns `a / b` rounded to the nearest integer, halves up. `b` is positive.
fn divide_rounding_half_up(a: i128, b: i128) -> i128 {
    (2 * a + b).div_euclid(2 * b)
}
