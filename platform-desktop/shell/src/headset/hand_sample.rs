//! Hand samples: a tracked controller or a bare hand in SI units, quantised into the core's input.

use glam::Vec3;
use paros_core::HandInput;
use paros_core::internals::RoomPose;
use paros_core::session::RawPose;

/// The state of a controller or a bare hand at one time.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct HandSample {
    /// The aim pose, in metres; none while it is not tracked.
    pub aim: Option<RoomPose>,
    /// The grip pose, in metres; none while it is not tracked.
    pub grip: Option<RoomPose>,
    /// How far the trigger is pulled, 0 to 1.
    pub trigger: f32,
    /// How far the grip is squeezed, 0 to 1.
    pub squeeze: f32,
    /// The thumbstick to the right and forward, -1 to 1.
    pub stick: [f32; 2],
    /// The pressed buttons, by [`paros_core::session::buttons`].
    pub buttons: u8,
}

/// The hand joints that pinch and fist are read from, in metres.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HandJoints {
    /// The palm joint: it faces along -y, the fingers point along -z.
    pub palm: RoomPose,
    /// The tips of the thumb and the index finger.
    pub pinch_tips: [Vec3; 2],
    /// The tips of the middle, ring and little finger.
    pub fist_tips: [Vec3; 3],
}

impl HandSample {
    /// The sample quantised into the core's input. A pose that is not tracked becomes one that the
    /// core passes over.
    #[must_use]
    pub fn to_hand_input(&self) -> HandInput {
        let quantize_pose = |pose: Option<RoomPose>| {
            pose.map_or(RawPose::default(), |(position, rotation)| {
                RawPose::quantise(position, rotation)
            })
        };
        HandInput {
            aim: quantize_pose(self.aim),
            grip: quantize_pose(self.grip),
            trigger: to_unorm8(self.trigger),
            squeeze: to_unorm8(self.squeeze),
            stick: self.stick.map(to_snorm8),
            buttons: self.buttons,
            tracked: self.grip.is_some(),
        }
    }

    /// A bare hand: pinching thumb and index finger pulls the trigger, closing the other fingers
    /// squeezes.
    #[must_use]
    pub fn from_joints(joints: &HandJoints) -> Self {
        let [thumb, index] = joints.pinch_tips;
        let mean: f32 = joints.fist_tips.iter().map(|tip| tip.distance(joints.palm.0)).sum::<f32>();
        HandSample {
            aim: Some(joints.palm),
            grip: Some(joints.palm),
            trigger: closed_fraction(thumb.distance(index), PINCH_OPEN_CLOSED_M),
            squeeze: closed_fraction(mean / 3.0, FIST_OPEN_CLOSED_M),
            ..HandSample::default()
        }
    }
}

/// Pinch thresholds: metres between the tips of thumb and index finger, open and closed.
const PINCH_OPEN_CLOSED_M: [f32; 2] = [0.05, 0.015];

/// Fist thresholds: metres from the palm to the other fingers' tips in the mean, open and closed.
const FIST_OPEN_CLOSED_M: [f32; 2] = [0.085, 0.045];

/// A linear ramp: 0 at `open_m` and beyond, 1 at `closed_m` and below.
fn closed_fraction(distance_m: f32, [open_m, closed_m]: [f32; 2]) -> f32 {
    ((open_m - distance_m) / (open_m - closed_m)).clamp(0.0, 1.0)
}

/// 0 to 1 as a byte; NaN becomes 0.
fn to_unorm8(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// -1 to 1 as a signed byte; NaN becomes 0.
fn to_snorm8(value: f32) -> i8 {
    (value.clamp(-1.0, 1.0) * 127.0).round() as i8
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};
    use paros_core::HandInput;
    use paros_core::internals::UNITS_PER_METRE;

    use super::{HandJoints, HandSample};

    #[test]
    fn poses_and_buttons_are_quantised() {
        let grip = Some((Vec3::new(0.5, 1.0, -0.25), Quat::IDENTITY));
        let sample = HandSample {
            grip,
            trigger: 0.5,
            squeeze: 1.5,
            stick: [-1.0, 0.25],
            buttons: 3,
            ..HandSample::default()
        };
        let input = sample.to_hand_input();
        assert_eq!(
            input.grip.position,
            [UNITS_PER_METRE / 2, UNITS_PER_METRE, -UNITS_PER_METRE / 4]
        );
        assert_eq!(input.grip.rotation, [0, 0, 0, i16::MAX]);
        assert_eq!((input.trigger, input.squeeze, input.stick), (128, 255, [-127, 32]));
        assert!(input.tracked && input.buttons == 3);
        // The aim is not known: a pose that the core passes over.
        assert!(input.aim.to_clamped_metres().is_none());
    }

    #[test]
    fn what_is_not_tracked_or_no_number_is_nothing() {
        assert_eq!(HandSample::default().to_hand_input(), HandInput::default());
        let sample = HandSample { trigger: f32::NAN, stick: [f32::NAN; 2], ..Default::default() };
        assert_eq!(sample.to_hand_input(), HandInput::default());
        let lost = Some((Vec3::splat(f32::NAN), Quat::IDENTITY));
        let input = HandSample { grip: lost, ..Default::default() }.to_hand_input();
        assert!(input.grip.to_clamped_metres().is_none());
    }

    #[test]
    fn a_pinch_is_the_trigger_and_a_fist_the_squeeze() {
        let hand = |gap: f32, reach: f32| {
            let palm = (Vec3::Y, Quat::IDENTITY);
            let tip = Vec3::Y + Vec3::NEG_Z * reach;
            let thumb = Vec3::new(0.04, 1.0, -0.06);
            let pinch_tips = [thumb, thumb + Vec3::X * gap];
            HandSample::from_joints(&HandJoints { palm, pinch_tips, fist_tips: [tip; 3] })
        };
        let open = hand(0.08, 0.1);
        assert_eq!((open.trigger, open.squeeze), (0.0, 0.0));
        assert!(open.to_hand_input().tracked);
        let pinch = hand(0.01, 0.1);
        assert_eq!((pinch.trigger, pinch.squeeze), (1.0, 0.0));
        let fist = hand(0.08, 0.03);
        assert_eq!((fist.trigger, fist.squeeze), (0.0, 1.0));
        let half = hand(0.0325, 0.1).trigger;
        assert!((half - 0.5).abs() < 0.01, "{half}");
    }
}
