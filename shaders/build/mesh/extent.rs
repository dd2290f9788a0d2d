//! The room's inside, and boxes between two of its points.

use glam::{Affine3A, Vec3};

use super::MeshBuilder;
use super::shapes::bevelled_box;

/// The room's inside: walls, floor, and the ceiling's boards.
pub(crate) const LOW: Vec3 = Vec3::new(-2.4, 0.0, -3.0);
pub(crate) const HIGH: Vec3 = Vec3::new(2.6, 3.95, 2.8);

/// Adds a box between two corners.
pub(super) fn add_box_between(
    mesh: &mut MeshBuilder,
    low_corner: Vec3,
    high_corner: Vec3,
    bevel: f32,
    colour: Vec3,
) {
    mesh.append(
        &bevelled_box(0.5 * (high_corner - low_corner), bevel, colour),
        Affine3A::from_translation(0.5 * (low_corner + high_corner)),
    );
}
