//! A panel's pose in the room, and where rays and fingers meet it.

use glam::{Quat, Vec2, Vec3};

/// A panel's pose: its middle and rotation, as of OpenXR's quads: x to the right, y up, z towards the
/// reader.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PanelPose {
    /// The middle, in metres of the room.
    pub middle: Vec3,
    /// Rotation of the panel's axes.
    pub rotation: Quat,
    /// Scale of the panel's millimetres: 1 in a room, less where the panel is held before the eye of a
    /// window.
    pub scale: f32,
}

/// A point of a panel that a ray or finger points at.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct PanelPoint {
    /// Millimetres from the panel's upper left corner, y down.
    pub at_mm: Vec2,
    /// Metres along a ray; for a finger, its height before the panel, negative behind it.
    pub distance: f32,
}

/// A rectangle of a panel, in millimetres from its upper left corner, y down.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct PanelRect {
    /// Left side.
    pub x: f32,
    /// Upper side.
    pub y: f32,
    /// Width, to the right.
    pub width: f32,
    /// Height, downwards.
    pub height: f32,
}

impl Default for PanelPose {
    /// Returns the pose at the room's origin, facing +z.
    fn default() -> Self {
        PanelPose { middle: Vec3::ZERO, rotation: Quat::IDENTITY, scale: 1.0 }
    }
}

impl PanelPose {
    /// Returns the pose of a panel at `middle` that faces `eyes`: turned and tilted towards them, with its
    /// lower side level.
    #[must_use]
    pub fn facing(middle: Vec3, eyes: Vec3) -> Self {
        let towards = eyes - middle;
        let turn = Quat::from_rotation_y(towards.x.atan2(towards.z));
        let level = (towards.x * towards.x + towards.z * towards.z).sqrt();
        let rotation = turn * Quat::from_rotation_x(-towards.y.atan2(level));
        PanelPose { middle, rotation, scale: 1.0 }
    }

    /// Returns the upper left corner of a panel of this size, and the vectors of a millimetre to the right
    /// and of a millimetre down, in metres.
    pub(crate) fn frame(&self, [width, height]: [f32; 2]) -> [Vec3; 3] {
        let right = self.rotation * Vec3::X * (1e-3 * self.scale);
        let down = self.rotation * Vec3::NEG_Y * (1e-3 * self.scale);
        [self.middle - right * (0.5 * width) - down * (0.5 * height), right, down]
    }

    /// Returns the point where a ray of the room meets the front of a panel of this size; `None` if the ray
    /// passes beside it, comes from behind, or points away.
    #[must_use]
    pub fn intersect_ray(
        &self,
        size_mm: [f32; 2],
        origin: Vec3,
        direction: Vec3,
    ) -> Option<PanelPoint> {
        let hit = self.intersect_plane(size_mm, origin, direction)?;
        let [width, height] = size_mm;
        PanelRect { x: 0.0, y: 0.0, width, height }.contains(hit.at_mm).then_some(hit)
    }

    /// Intersects a ray like [`PanelPose::intersect_ray`], but with the panel's whole plane.
    pub(crate) fn intersect_plane(
        &self,
        size_mm: [f32; 2],
        origin: Vec3,
        direction: Vec3,
    ) -> Option<PanelPoint> {
        let normal = self.rotation * Vec3::Z;
        let falling = -normal.dot(direction);
        let height = normal.dot(origin - self.middle);
        // A direction or origin with a NaN fails both comparisons.
        let meets = falling > 1e-6 && height >= 0.0;
        meets.then(|| {
            let along = height / falling;
            let at_mm = self.project_point(size_mm, origin + direction * along).at_mm;
            PanelPoint { at_mm, distance: along * direction.length() }
        })
    }

    /// Projects a point of the room onto the plane of a panel of this size. The distance is the point's
    /// height before the panel.
    #[must_use]
    pub fn project_point(&self, size_mm: [f32; 2], point: Vec3) -> PanelPoint {
        let local = self.rotation.inverse() * (point - self.middle);
        let per_metre = 1e3 / self.scale;
        let at_mm = Vec2::new(local.x, -local.y) * per_metre + Vec2::from_array(size_mm) * 0.5;
        PanelPoint { at_mm, distance: local.z }
    }
}

impl PanelRect {
    /// Creates a rectangle from its left side, upper side, width and height.
    #[must_use]
    pub const fn new(x: f32, y: f32, width: f32, height: f32) -> Self {
        PanelRect { x, y, width, height }
    }

    /// Returns `true` if a point is inside or on the edge.
    #[must_use]
    pub fn contains(&self, at_mm: Vec2) -> bool {
        let Vec2 { x, y } = at_mm - Vec2::new(self.x, self.y);
        (0.0..=self.width).contains(&x) && (0.0..=self.height).contains(&y)
    }

    /// Returns the middle.
    #[must_use]
    pub fn middle(&self) -> Vec2 {
        Vec2::new(self.x + 0.5 * self.width, self.y + 0.5 * self.height)
    }

    /// Returns the rectangle, grown by `by` on every side.
    #[must_use]
    pub fn grown(&self, by: f32) -> Self {
        let PanelRect { x, y, width, height } = *self;
        PanelRect::new(x - by, y - by, width + 2.0 * by, height + 2.0 * by)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [f32; 2] = [1000.0, 600.0];

    fn tilted() -> PanelPose {
        PanelPose::facing(Vec3::new(0.4, 1.2, -0.9), Vec3::new(-0.3, 1.7, 0.2))
    }

    #[test]
    fn a_panel_faces_the_eyes() {
        let (eyes, pose) = (Vec3::new(-0.3, 1.7, 0.2), tilted());
        let towards = (eyes - pose.middle).normalize();
        assert!((pose.rotation * Vec3::Z).distance(towards) < 1e-5);
        assert!((pose.rotation * Vec3::X).y.abs() < 1e-6, "its lower side is level");
        assert!((pose.rotation * Vec3::Y).y > 0.0);
    }

    #[test]
    fn a_ray_meets_the_millimetre_that_it_points_at() {
        [tilted(), PanelPose { scale: 0.3, ..tilted() }].into_iter().for_each(check_rays);
    }

    fn check_rays(pose: PanelPose) {
        let [corner, right, down] = pose.frame(SIZE);
        let eye = Vec3::new(-0.2, 1.5, 0.3);
        for (x, y) in [(1.0, 1.0), (250.0, 30.0), (999.0, 599.0), (500.0, 300.0)] {
            let point = corner + right * x + down * y;
            let hit = pose.intersect_ray(SIZE, eye, (point - eye) * 0.7).expect("a hit");
            assert!(hit.at_mm.distance(Vec2::new(x, y)) < 0.01, "{hit:?}");
            assert!((hit.distance - eye.distance(point)).abs() < 1e-4);
            let touched = pose.project_point(SIZE, point + pose.rotation * Vec3::Z * 0.02);
            assert!(touched.at_mm.distance(Vec2::new(x, y)) < 0.01, "{touched:?}");
            assert!((touched.distance - 0.02).abs() < 1e-5);
        }
    }

    #[test]
    fn a_ray_beside_behind_or_away_meets_nothing() {
        let pose = tilted();
        let [corner, right, down] = pose.frame(SIZE);
        let front = pose.middle + pose.rotation * Vec3::Z;
        let back = pose.middle - pose.rotation * Vec3::Z;
        let beside = corner + right * 1002.0 + down * 10.0;
        let misses = [
            (front, beside - front),
            (back, pose.middle - back),
            (front, front - pose.middle),
            (front, right),
            (front, Vec3::splat(f32::NAN)),
            (Vec3::splat(f32::NAN), pose.middle - front),
        ];
        for (origin, direction) in misses {
            assert_eq!(pose.intersect_ray(SIZE, origin, direction), None, "{origin} {direction}");
        }
    }
}
