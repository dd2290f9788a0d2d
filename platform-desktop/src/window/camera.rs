//! Orbit camera around the sculpture.

use glam::{Quat, Vec3};
use paros_core::internals::{BOX_SIDE, STOOL_TOP};
use paros_shaders::gpu::{Eye, Fov};

/// The eye's position, in spherical coordinates around the middle of the sculpture's box.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct OrbitCamera {
    /// Radians; 0 looks at the front, growing to the visitor's right.
    pub(super) azimuth: f32,
    /// Radians above the horizon.
    pub(super) elevation: f32,
    /// Metres from the middle.
    pub(super) distance: f32,
}

/// Half the vertical angle of view, in radians.
const HALF_ANGLE: f32 = 0.36;

impl Default for OrbitCamera {
    fn default() -> Self {
        OrbitCamera { azimuth: 0.28, elevation: 0.3, distance: 1.12 }
    }
}

impl OrbitCamera {
    /// Orbits by a drag of `[x, y]` pixels in a picture of `height` pixels.
    pub(super) fn rotate_by_drag(&mut self, [x, y]: [f32; 2], height: u32) {
        let radians = 2.6 / height.max(1) as f32;
        self.azimuth = (self.azimuth - x * radians).rem_euclid(core::f32::consts::TAU);
        self.elevation = (self.elevation + y * radians).clamp(-0.35, 1.5);
    }

    /// Moves nearer by wheel notches, or farther where `steps` is negative.
    pub(super) fn zoom(&mut self, steps: f32) {
        self.distance = (self.distance * (-0.12 * steps).exp()).clamp(0.28, 2.6);
    }

    /// The eye's position in the room, in metres, and its rotation; it looks along its -z.
    #[must_use]
    pub(super) fn pose(&self) -> (Vec3, Quat) {
        let middle = STOOL_TOP + Vec3::Y * (0.46 * BOX_SIDE);
        let rotation = Quat::from_rotation_y(self.azimuth) * Quat::from_rotation_x(-self.elevation);
        (middle + rotation * Vec3::Z * self.distance, rotation)
    }

    /// The eye for a picture of `size` pixels.
    #[must_use]
    pub(super) fn eye(&self, size: [u32; 2]) -> Eye {
        let (position, rotation) = self.pose();
        let across = (HALF_ANGLE.tan() * aspect_ratio(size)).atan();
        let fov = Fov { left: -across, right: across, up: HALF_ANGLE, down: -HALF_ANGLE };
        Eye { position, rotation, fov }
    }

    /// The ray through a pixel, counted from the upper left: origin in metres and unit direction, in
    /// the room.
    #[must_use]
    pub(super) fn ray_through_pixel(&self, [x, y]: [f32; 2], size: [u32; 2]) -> (Vec3, Vec3) {
        let (position, rotation) = self.pose();
        let [across, down] = size.map(|pixels| pixels.max(1) as f32);
        let up = HALF_ANGLE.tan();
        let right = (2.0 * x / across - 1.0) * up * aspect_ratio(size);
        let direction = Vec3::new(right, (1.0 - 2.0 * y / down) * up, -1.0);
        (position, (rotation * direction).normalize())
    }

    /// Projects a point of the room: its pixel, and the pixels of a metre at its depth. `None` behind
    /// the eye.
    #[must_use]
    pub(super) fn project_point(&self, point: Vec3, size: [u32; 2]) -> Option<([f32; 2], f32)> {
        let (position, rotation) = self.pose();
        let seen = rotation.conjugate() * (point - position);
        let [across, down] = size.map(|pixels| pixels as f32);
        let metre = 0.5 * down / (HALF_ANGLE.tan() * -seen.z);
        let at = [0.5 * across + seen.x * metre, 0.5 * down - seen.y * metre];
        (seen.z < -0.04).then_some((at, metre))
    }
}

fn aspect_ratio([across, down]: [u32; 2]) -> f32 {
    across.max(1) as f32 / down.max(1) as f32
}

#[cfg(test)]
mod tests {
    use super::OrbitCamera;

    #[test]
    fn a_ray_goes_through_the_pixel_that_shows_its_points() {
        let mut orbit = OrbitCamera { azimuth: 1.0, ..OrbitCamera::default() };
        orbit.rotate_by_drag([40.0, -10.0], 600);
        let size = [800, 600];
        for pixel in [[400.0, 300.0], [13.0, 588.0], [799.0, 2.0]] {
            let (origin, direction) = orbit.ray_through_pixel(pixel, size);
            let (shown, _) =
                orbit.project_point(origin + direction * 0.7, size).expect("before the eye");
            assert!((shown[0] - pixel[0]).abs() < 0.02 && (shown[1] - pixel[1]).abs() < 0.02);
        }
        let (origin, direction) = orbit.ray_through_pixel([400.0, 300.0], size);
        assert_eq!(orbit.project_point(origin - direction, size), None);
    }
}
