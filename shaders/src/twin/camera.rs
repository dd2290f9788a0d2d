//! A pinhole camera on a ring around the stool.

use glam::Vec3;

use super::march::Ray;

/// An orbit camera. The camera and the lights stand still and the stool turns, so that every side
/// of the sculpture is lit alike.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Camera {
    /// The side of the sculpture that is seen, in radians: 0 looks at +z, growing towards +x.
    pub azimuth: f32,
    /// Height above the horizon, in radians.
    pub elevation: f32,
    /// Distance from the target, in sides of the cube.
    pub distance: f32,
    /// The point looked at: height above the stool, in sides of the cube.
    pub height: f32,
    /// Vertical angle of view, in radians.
    pub angle: f32,
}

impl Camera {
    /// Creates a camera at a distance from which it sees the whole cube.
    #[must_use]
    pub fn orbiting(azimuth_radians: f32, elevation_radians: f32) -> Self {
        let (azimuth, elevation) = (azimuth_radians, elevation_radians);
        Camera { azimuth, elevation, distance: 3.2, height: 0.43, angle: 0.41 }
    }

    /// Returns the studio ray through a point of the picture, in half heights from its middle: x from
    /// -aspect to aspect, y from -1 to 1, growing to the right and up.
    #[must_use]
    pub fn ray_through(&self, right_half_heights: f32, up_half_heights: f32) -> Ray {
        let (x, y) = (right_half_heights, up_half_heights);
        let (sin, cos) = self.elevation.sin_cos();
        let back = Vec3::new(0.0, sin, cos);
        let up = Vec3::new(0.0, cos, -sin);
        let scale = (self.angle * 0.5).tan();
        Ray {
            origin: back * self.distance + Vec3::Y * self.height,
            direction: (Vec3::X * (x * scale) + up * (y * scale) - back).normalize(),
        }
    }
}
