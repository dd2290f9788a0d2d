//! Model of a bit's path: the poses from one pose to another.

use glam::Vec3;
use paros_core::edit::{Pose, SUBUNITS_PER_VOXEL};
use paros_core::internals::{GridBit, GridShape};

/// Steps of the walk a voxel of path length.
pub const STEPS_PER_VOXEL: f32 = 4.0;

/// Returns the poses of a path, in steps of a quarter voxel of translation and rotation together, without
/// `from` and with `to` as the last. Along its own plane a disc moves four times as far in a step.
pub fn path_poses(bit: &GridBit, from: &Pose, to: &Pose) -> impl Iterator<Item = Pose> + use<> {
    let (from, to) = (*from, *to);
    let turn = from.angle_radians_to(&to) * bit.circumscribed_radius_subunits() as f32
        / SUBUNITS_PER_VOXEL as f32;
    let way = to.position - from.position;
    let length = match bit.shape {
        GridShape::Ball(_) | GridShape::Box(_) => way.length(),
        GridShape::Disc { .. } => {
            let across = way.dot(from.rotation * Vec3::X).abs();
            way.length().min(across + way.length() * (0.25 + from.angle_radians_to(&to)))
        }
    } + turn;
    let steps = (length * STEPS_PER_VOXEL).ceil().max(1.0) as u32;
    (1..=steps).map(move |i| from.interpolate(&to, i as f32 / steps as f32))
}
