//! The faces of the block that hands work on: its sides, each turned to the visitor by the stool, and its
//! top.

use glam::Vec3;

use super::direction_at_azimuth;

/// The distance of the sides' origins from the block's axis, clear of its edges, and of the top's origin from
/// the ground.
const CLEAR: f32 = 98.0;
const ABOVE: f32 = 144.0;

/// A face, in units of 1/128 of the block's edge. Hands stroke along it in parallel strips.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// The origin, clear of the block: in front of the middle of the face's foot, or over the middle of the
    /// top.
    origin: Vec3,
    /// The direction into the stone.
    pub(super) inward: Vec3,
    /// The direction along the strips.
    pub(super) along: Vec3,
    /// The direction from one strip to the next.
    pub(super) aside: Vec3,
    /// The start and end of strips along the face.
    pub(super) strip: [f32; 2],
    /// The greatest depth from the origin to which the stone is worked where there is no figure.
    pub(super) deepest: f32,
}

impl Face {
    /// Returns the side at an azimuth, from +z to +x, worked from its upper edge down.
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

    /// Returns the top, worked from left to right.
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

    /// Returns a point in the face's plane.
    pub(super) fn point(&self, along: f32, aside: f32) -> Vec3 {
        self.origin + self.along * along + self.aside * aside
    }
}
