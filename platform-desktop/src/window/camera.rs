//! Orbit camera around the sculpture.

use glam::{Quat, Vec3};
use paros_core::internals::{BOX_SIDE, RoomPose, STOOL_TOP};
use paros_shaders::Ray;
use paros_shaders::gpu::{Eye, Fov};
use paros_visit::WindowView;

/// The eye's position in spherical coordinates around the middle of the sculpture's box.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct OrbitCamera {
    /// Azimuth in radians; 0 looks at the front, growing to the visitor's right.
    pub(super) azimuth: f32,
    /// Elevation above the horizon, in radians.
    pub(super) elevation: f32,
    /// Distance from the middle, in metres.
    pub(super) distance: f32,
    /// Fraction of the picture's height that the tool bar covers at its bottom. The view's centre lies above
    /// it.
    covered: f32,
    /// Offset of the view's centre to the right, in halves of the picture's width. Makes room for a panel on
    /// the left.
    aside: f32,
}

/// Offset beside a panel (see [`OrbitCamera::move_aside`]), and the largest change of the offset in a tick:
/// the whole way takes a third of a second.
const BESIDE_PANEL: f32 = 0.5;
const ASIDE_SPEED: f32 = 0.02;

/// Half the vertical angle of view above the covered part, in radians.
const HALF_ANGLE: f32 = 0.36;

/// Fraction of the picture's height at its bottom that shows only the stool's leg in the initial view: a tool
/// bar may cover it.
const UNNEEDED: f32 = 0.15;

/// The largest covered fraction of a picture's height that the view makes room for.
const MAX_COVERED: f32 = 0.5;

impl Default for OrbitCamera {
    fn default() -> Self {
        OrbitCamera { azimuth: 0.28, elevation: 0.3, distance: 1.12, covered: 0.0, aside: 0.0 }
    }
}

/// A point of the room, projected into the picture.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct ProjectedPoint {
    /// Pixel, counted from the upper left; may be outside the picture.
    pub(super) pixel: [f32; 2],
    /// Scale at the point's depth.
    pub(super) pixels_per_metre: f32,
}

impl OrbitCamera {
    /// Orbits by a drag to the right and down, in pixels, in a picture `height_pixels` high.
    pub(super) fn rotate_by_drag(&mut self, drag_pixels: [f32; 2], height_pixels: u32) {
        let [x, y] = drag_pixels;
        let radians = 2.6 / height_pixels.max(1) as f32;
        self.azimuth = (self.azimuth - x * radians).rem_euclid(core::f32::consts::TAU);
        self.elevation = (self.elevation + y * radians).clamp(-0.35, 1.5);
    }

    /// Zooms in by wheel notches, or out if they are negative.
    pub(super) fn zoom_in(&mut self, notches: f32) {
        self.distance = (self.distance * (-0.12 * notches).exp()).clamp(0.28, 2.6);
    }

    /// Resets the camera to the initial view. The offsets for panels are kept.
    pub(super) fn reset_pose(&mut self) {
        let OrbitCamera { covered, aside, .. } = *self;
        *self = OrbitCamera { covered, aside, ..OrbitCamera::default() };
    }

    /// Keeps the view's centre above a tool bar that covers `part` of the picture's height.
    pub(super) fn set_covered_part(&mut self, part: f32) {
        self.covered = ((part - UNNEEDED) / (1.0 - UNNEEDED)).clamp(0.0, MAX_COVERED);
    }

    /// Moves the view's centre by a tick: to the right if a panel needs the left of the picture, else back to
    /// the middle.
    pub(super) fn move_aside(&mut self, for_panel: bool) {
        let aim = if for_panel { BESIDE_PANEL } else { 0.0 };
        self.aside += (aim - self.aside).clamp(-ASIDE_SPEED, ASIDE_SPEED);
    }

    /// Returns the pixel column of the view's centre, in a picture `across` pixels wide.
    fn middle_column(&self, across: f32) -> f32 {
        0.5 * across * (1.0 + self.aside)
    }

    /// Returns the tangent of the angle of view for each pixel of a picture of `height` pixels.
    fn tangent_per_pixel(&self, height: f32) -> f32 {
        2.0 * HALF_ANGLE.tan() / ((1.0 - self.covered) * height)
    }

    /// Returns the eye's position in the room, in metres, and its rotation. The eye looks along its -z.
    #[must_use]
    pub(super) fn pose(&self) -> RoomPose {
        let middle = STOOL_TOP + Vec3::Y * (0.46 * BOX_SIDE);
        let rotation = Quat::from_rotation_y(self.azimuth) * Quat::from_rotation_x(-self.elevation);
        (middle + rotation * Vec3::Z * self.distance, rotation)
    }

    /// Returns the eye for a picture of `picture_size` pixels.
    #[must_use]
    pub(super) fn eye(&self, picture_size: [u32; 2]) -> Eye {
        let (position, rotation) = self.pose();
        let [across, down] = picture_size.map(|pixels| pixels.max(1) as f32);
        let per_pixel = self.tangent_per_pixel(down);
        let middle = self.middle_column(across);
        let left = (-middle * per_pixel).atan();
        let right = ((across - middle) * per_pixel).atan();
        let below = (HALF_ANGLE.tan() - down * per_pixel).atan();
        let fov = Fov { left, right, up: HALF_ANGLE, down: below };
        Eye { position, rotation, fov }
    }

    /// Returns the view above the covered part of a picture of `picture_size` pixels, for panels before the
    /// eye.
    #[must_use]
    pub(super) fn panel_view(&self, picture_size: [u32; 2]) -> WindowView {
        let (position, rotation) = self.pose();
        let [across, down] = picture_size.map(|pixels| pixels.max(1) as f32);
        let per_pixel = self.tangent_per_pixel(down);
        let (middle, up) = (self.middle_column(across), HALF_ANGLE.tan());
        let [left, right] = [-middle, across - middle].map(|pixels| pixels * per_pixel);
        WindowView { position, rotation, left, right, up, down: -up }
    }

    /// Returns the ray in the room through a pixel counted from the upper left: origin in metres and unit
    /// direction.
    #[must_use]
    pub(super) fn room_ray_through_pixel(&self, [x, y]: [f32; 2], picture_size: [u32; 2]) -> Ray {
        let (position, rotation) = self.pose();
        let [across, down] = picture_size.map(|pixels| pixels.max(1) as f32);
        let per_pixel = self.tangent_per_pixel(down);
        let up = HALF_ANGLE.tan() - y * per_pixel;
        let direction = Vec3::new((x - self.middle_column(across)) * per_pixel, up, -1.0);
        Ray { origin: position, direction: (rotation * direction).normalize() }
    }

    /// Projects a point of the room, in metres. Returns `None` behind the eye.
    #[must_use]
    pub(super) fn project_point(
        &self,
        room_point: Vec3,
        picture_size: [u32; 2],
    ) -> Option<ProjectedPoint> {
        let (position, rotation) = self.pose();
        let seen = rotation.conjugate() * (room_point - position);
        let [across, down] = picture_size.map(|pixels| pixels as f32);
        let per_pixel = self.tangent_per_pixel(down);
        let pixels_per_metre = 1.0 / (per_pixel * -seen.z);
        let top = HALF_ANGLE.tan() / per_pixel;
        let pixel = [
            self.middle_column(across) + seen.x * pixels_per_metre,
            top - seen.y * pixels_per_metre,
        ];
        (seen.z < -0.04).then_some(ProjectedPoint { pixel, pixels_per_metre })
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use paros_core::internals::STOOL_TOP;

    use super::{OrbitCamera, Ray};

    #[test]
    fn a_ray_goes_through_the_pixel_that_shows_its_points() {
        let mut orbit = OrbitCamera { azimuth: 1.0, ..OrbitCamera::default() };
        orbit.rotate_by_drag([40.0, -10.0], 600);
        orbit.set_covered_part(0.4);
        (0..9).for_each(|_| orbit.move_aside(true));
        let picture_size = [800, 600];
        for pixel in [[400.0, 300.0], [13.0, 588.0], [799.0, 2.0]] {
            let Ray { origin, direction } = orbit.room_ray_through_pixel(pixel, picture_size);
            let shown = orbit.project_point(origin + direction * 0.7, picture_size);
            let shown = shown.expect("before the eye").pixel;
            assert!((shown[0] - pixel[0]).abs() < 0.02 && (shown[1] - pixel[1]).abs() < 0.02);
        }
        let Ray { origin, direction } = orbit.room_ray_through_pixel([400.0, 300.0], picture_size);
        assert_eq!(orbit.project_point(origin - direction, picture_size), None);
    }

    #[test]
    fn the_stone_goes_aside_for_a_panel_and_comes_back() {
        let mut orbit = OrbitCamera::default();
        let column = |orbit: &OrbitCamera| {
            let middle = STOOL_TOP + Vec3::Y * 0.1;
            orbit.project_point(middle, [800, 600]).expect("before the eye").pixel[0]
        };
        assert!((column(&orbit) - 400.0).abs() < 1.0);
        (0..25).for_each(|_| orbit.move_aside(true));
        assert!((column(&orbit) - 600.0).abs() < 1.0, "{}", column(&orbit));
        let view = orbit.panel_view([800, 600]);
        assert!((view.left + 3.0 * view.right).abs() < 1e-5, "{view:?}");
        orbit.reset_pose();
        assert!((column(&orbit) - 600.0).abs() < 1.0, "a panel is there still");
        (0..25).for_each(|_| orbit.move_aside(false));
        assert_eq!(orbit, OrbitCamera::default());
    }

    #[test]
    fn the_stool_is_seen_above_a_tool_bar_that_covers_much_of_a_small_window() {
        let mut orbit = OrbitCamera::default();
        let size = [640, 420];
        let front_of_stool = STOOL_TOP + Vec3::Z * 0.2;
        let row = |orbit: &OrbitCamera| {
            orbit.project_point(front_of_stool, size).expect("before the eye").pixel[1]
        };
        orbit.set_covered_part(0.1);
        assert_eq!(orbit, OrbitCamera::default(), "a bar over the stool's leg alone");
        assert!(row(&orbit) > 0.6 * 420.0);
        orbit.set_covered_part(0.4);
        assert!(row(&orbit) < 0.6 * 420.0, "{}", row(&orbit));
        // The rays through the picture's edges match the eye's angles of view.
        let fov = orbit.eye(size).fov;
        let Ray { direction, .. } = orbit.room_ray_through_pixel([640.0, 420.0], size);
        let seen = orbit.pose().1.conjugate() * direction;
        assert!((seen.y / -seen.z - fov.down.tan()).abs() < 1e-5);
        assert!((seen.x / -seen.z - fov.right.tan()).abs() < 1e-5);
    }
}
