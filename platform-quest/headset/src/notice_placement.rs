//! The placement of a notice: upright, ahead of the head's first heading, at the head's height. It stays
//! there, so that the reader can look away and back, until the head has turned well away from it.

use glam::{Quat, Vec3};
use paros_core::internals::RoomPose;

/// The distance from the head, in metres: farther than arm's length, for the lenses' focus, and near enough
/// to be read.
const DISTANCE: f32 = 1.6;

/// The cosine of the angle by which the head may turn away (45 degrees) before the notice follows.
const SEEN_COSINE: f32 = 0.7;

/// The distance by which the head may move, in metres, before the notice follows.
const NEAR: f32 = 0.5;

/// Decides where a notice hangs.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct NoticePlacement {
    pose: RoomPose,
    /// The head's position when the notice was placed; `None` before a head was seen.
    head: Option<Vec3>,
}

impl Default for NoticePlacement {
    /// Returns a placement ahead along the space's own -z axis, until a head is seen.
    fn default() -> Self {
        NoticePlacement { pose: (Vec3::NEG_Z * DISTANCE, Quat::IDENTITY), head: None }
    }
}

impl NoticePlacement {
    /// Observes the head's pose, in a space whose y is up. Returns the pose of the notice's middle, whose z
    /// points to the reader.
    pub fn observe_head(&mut self, head: Option<RoomPose>) -> RoomPose {
        if let Some((position, rotation)) = head
            && !self.is_before(position, rotation)
        {
            let heading = find_heading(rotation);
            let yaw = libm::atan2f(-heading.x, -heading.z);
            self.pose = (position + heading * DISTANCE, Quat::from_rotation_y(yaw));
            self.head = Some(position);
        }
        self.pose
    }

    fn is_before(&self, position: Vec3, rotation: Quat) -> bool {
        let Some(head) = self.head else { return false };
        let gaze = rotation * Vec3::NEG_Z;
        // A reader who looks up or down finds the notice again by looking ahead.
        let level = |v: Vec3| Vec3::new(v.x, 0.0, v.z).normalize_or_zero();
        let ahead = level(self.pose.0 - position);
        let looked = level(gaze);
        let is_seen = looked == Vec3::ZERO || looked.dot(ahead) > SEEN_COSINE;
        is_seen && head.distance(position) < NEAR
    }
}

/// Returns the horizontal heading of a head. If the head looks almost straight down or up, its top gives the
/// heading.
fn find_heading(rotation: Quat) -> Vec3 {
    let [gaze, top] = [Vec3::NEG_Z, Vec3::Y].map(|axis| rotation * axis);
    let level = |v: Vec3| Vec3::new(v.x, 0.0, v.z);
    let of_top = if gaze.y < 0.0 { level(top) } else { -level(top) };
    let heading = if level(gaze).length() > 0.1 { level(gaze) } else { of_top };
    heading.try_normalize().unwrap_or(Vec3::NEG_Z)
}

#[cfg(test)]
mod tests {
    use core::f32::consts::{FRAC_PI_2, PI};

    use glam::{Quat, Vec3};

    use super::{DISTANCE, NoticePlacement};

    const HEAD: Vec3 = Vec3::new(1.0, 1.6, 2.0);

    fn turned(yaw: f32, pitch: f32) -> Option<(Vec3, Quat)> {
        Some((HEAD, Quat::from_rotation_y(yaw) * Quat::from_rotation_x(pitch)))
    }

    #[test]
    fn it_hangs_upright_ahead_of_the_head_and_faces_it() {
        for yaw in [0.0, 1.0, FRAC_PI_2, 3.0, -2.0] {
            for pitch in [0.0, 0.6, -0.9, -FRAC_PI_2, FRAC_PI_2] {
                let (at, rotation) = NoticePlacement::default().observe_head(turned(yaw, pitch));
                let ahead = Quat::from_rotation_y(yaw) * Vec3::NEG_Z;
                assert!(at.distance(HEAD + ahead * DISTANCE) < 1e-3, "{yaw} {pitch}: {at}");
                assert!((rotation * Vec3::Z).distance(-ahead) < 1e-3, "{yaw} {pitch}");
            }
        }
    }

    #[test]
    fn it_stays_while_it_is_seen_and_follows_a_head_that_turned_away() {
        let mut placement = NoticePlacement::default();
        let unseen = placement.observe_head(None);
        assert_eq!(unseen.0, Vec3::NEG_Z * DISTANCE);
        let first = placement.observe_head(turned(0.0, 0.0));
        for (yaw, pitch) in [(0.5, 0.0), (-0.5, 0.3), (0.0, -1.0), (0.0, -FRAC_PI_2)] {
            assert_eq!(placement.observe_head(turned(yaw, pitch)), first, "{yaw} {pitch}");
        }
        assert_eq!(placement.observe_head(None), first);
        let away = placement.observe_head(turned(PI, 0.0));
        assert!((away.0 - HEAD).z > 1.0, "{away:?}");
        let walked = placement.observe_head(Some((HEAD + Vec3::X, Quat::from_rotation_y(PI))));
        assert!((walked.0 - away.0).x > 0.9, "{walked:?}");
    }
}
