//! The plane of a float: the plane of its flat face when it begins to work.

use glam::Vec3;

use crate::edit::contact::Contact;
use crate::edit::grid_bit::{GridBit, GridShape};
use crate::edit::half_space::HalfSpace;
use crate::edit::pose::Pose;

/// The axis across a float's flat faces.
const FACE_AXIS: usize = 1;

/// Returns the half-space that a float at a pose removes: everything above the flat face that is turned to
/// the stone, according to the contact there, or above its underside if there is no contact.
pub(crate) fn half_space_above_float(bit: &GridBit, pose: &Pose, contact: &Contact) -> HalfSpace {
    let GridShape::Box(half_extents) = bit.shape else { return HalfSpace::NOTHING };
    let is_turned_over = contact.normal.dot(pose.rotation * Vec3::Y) < 0.0;
    let distance = -half_extents.to_array()[FACE_AXIS];
    HalfSpace::beyond_plane_of_bit(pose, FACE_AXIS, is_turned_over, distance)
}

/// Converts the half-space for mirrored edits, which need the plane in the lower half of x: for a float in
/// the upper half, returns the mirror image of its plane.
pub(crate) fn half_space_in_lower_half(above: HalfSpace, pose: &Pose, side: usize) -> HalfSpace {
    if 2.0 * pose.position.x > side as f32 { above.mirrored(side) } else { above }
}
