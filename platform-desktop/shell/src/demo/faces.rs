//! The faces of the block that hands work on: its sides, as the stool turns them to the visitor, and its top.

use glam::Vec3;

use super::direction_at_azimuth;

/// How far the sides' frames of reference are from the block's axis, clear of its edges, and the top's from the ground.
const CLEAR: f32 = 98.0;
const ABOVE: f32 = 144.0;

/// A face, in units of 1/128 of the block's edge. Hands stroke along it in parallel strips.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// A point clear of the block, before the middle of its foot, or over the middle of its top.
    origin: Vec3,
    /// Into the stone.
    pub(super) inward: Vec3,
    /// In which strips go.
    pub(super) along: Vec3,
    /// In which strips lie side by side.
    pub(super) aside: Vec3,
    /// Where strips begin and end along the face.
    pub(super) strip: [f32; 2],
    /// How far from the origin the stone is worked at most where no figure is.
    pub(super) deepest: f32,
}

impl Face {
    /// The side at an azimuth, from +z to +x, worked from its upper edge down.
    pub(super) fn side(degrees_from_z_to_x: f32) -> Face {
        let out = direction_at_azimuth(degrees_from_z_to_x);
        Face {
            origin: Vec3::new(64.0, 0.0, 64.0) + out * CLEAR,
            inward: -out,
            along: Vec3::NEG_Y,
            aside: Vec3::Y.cross(out),
            strip: [-126.0, 0.0],
            deepest: CLEAR,
        }
    }

    /// What is seen from above, worked from left to right.
    pub(super) fn top() -> Face {
        Face {
            origin: Vec3::new(64.0, ABOVE, 64.0),
            inward: Vec3::NEG_Y,
            along: Vec3::X,
            aside: Vec3::Z,
            strip: [-64.0, 64.0],
            deepest: ABOVE - 1.0,
        }
    }

    /// A place over the face.
    pub(super) fn point(&self, along: f32, aside: f32) -> Vec3 {
        self.origin + self.along * along + self.aside * aside
    }
}
