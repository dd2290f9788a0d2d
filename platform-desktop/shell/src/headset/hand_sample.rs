//! Hand samples: the state of a tracked controller or a bare hand in SI units, quantised into the core's
//! input. Decides which of a runtime's poses count, and derives pinch and fist from joints.

use glam::{Mat3, Quat, Vec3};
use paros_core::HandInput;
use paros_core::internals::RoomPose;
use paros_core::session::RawPose;

/// The state of a controller or a bare hand at one time.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct HandSample {
    /// The aim pose, in metres; `None` while it is not tracked.
    pub aim: Option<RoomPose>,
    /// The grip pose, in metres; `None` while it is not tracked.
    pub grip: Option<RoomPose>,
    /// The trigger's pull, 0 to 1.
    pub trigger: f32,
    /// The squeeze of the grip, 0 to 1.
    pub squeeze: f32,
    /// The thumbstick to the right and forward, -1 to 1.
    pub stick: [f32; 2],
    /// The pressed buttons, as bits of [`paros_core::session::buttons`].
    pub buttons: u8,
    /// The tip of a bare hand's index finger, in metres; `None` if it is unknown.
    pub fingertip: Option<Vec3>,
}

/// The tracking quality of a pose, from the flags of `XrSpaceLocation`.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Tracking {
    /// The pose is not valid.
    #[default]
    Unknown,
    /// The pose is valid but not tracked: an estimate, or the last known pose.
    Inferred,
    /// The pose is valid, and its position is tracked.
    Tracked,
}

/// A pose in metres, and its tracking quality.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ReportedPose {
    /// The pose; meaningless if it is [`Tracking::Unknown`].
    pub pose: RoomPose,
    /// The tracking quality.
    pub tracking: Tracking,
}

impl ReportedPose {
    /// Returns the pose if it is tracked. A pose that is only valid doesn't count: runtimes leave a lost hand
    /// or controller where they last saw it, and a tool must not keep working there.
    #[must_use]
    pub fn if_tracked(self) -> Option<RoomPose> {
        (self.tracking == Tracking::Tracked).then_some(self.pose)
    }

    /// Returns the position if it is tracked or inferred.
    fn position_if_valid(self) -> Option<Vec3> {
        (self.tracking != Tracking::Unknown).then_some(self.pose.0)
    }
}

/// The reported joints of a hand from which pinch and fist are derived (`XR_EXT_hand_tracking`).
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct HandJoints {
    /// 0 is the left hand, 1 the right one.
    pub hand: usize,
    /// The palm joint. The palm faces along -y, and the fingers point along -z.
    pub palm: ReportedPose,
    /// The distance from the palm joint to the skin, in metres.
    pub palm_radius_m: f32,
    /// The tips of the thumb and the index finger.
    pub pinch_tips: [ReportedPose; 2],
    /// The tips of the middle, ring and little finger.
    pub fist_tips: [ReportedPose; 3],
}

impl HandSample {
    /// Returns the sample quantised into the core's input. An untracked pose becomes a pose that the core
    /// ignores.
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

    /// Returns the sample of a bare hand: pinching thumb and index finger pulls the trigger, and closing the
    /// other fingers squeezes. Returns `None` if the palm is not tracked or a tip is unknown; a tip may be
    /// inferred, as curled fingers hide behind the hand.
    #[must_use]
    pub fn from_joints(joints: &HandJoints) -> Option<Self> {
        let palm = joints.palm.if_tracked()?;
        let mut reaches = [0.0; 3];
        for (reach, tip) in reaches.iter_mut().zip(joints.fist_tips) {
            *reach = tip.position_if_valid()?.distance(palm.0);
        }
        let [thumb, index] = joints.pinch_tips;
        let (thumb, index) = (thumb.position_if_valid()?, index.position_if_valid()?);
        let pinch = closed_fraction(thumb.distance(index), PINCH_OPEN_CLOSED_M);
        // In a fist these tips meet too, but at the palm.
        let curled = closed_fraction(index.distance(palm.0), FIST_OPEN_CLOSED_M);
        Some(HandSample {
            aim: Some(palm),
            grip: Some(grip_from_palm(palm, joints.palm_radius_m, joints.hand)),
            trigger: pinch.min(1.0 - curled),
            squeeze: closed_fraction(reaches.iter().sum::<f32>() / 3.0, FIST_OPEN_CLOSED_M),
            fingertip: Some(index),
            ..HandSample::default()
        })
    }
}

/// Returns the grip pose of a bare hand, as OpenXR defines it ("Standard pose identifiers"): on the palm's
/// skin, -z from the little finger to the thumb, x normal to the palm, away from a left palm and into a right
/// one. So a held tool points as it does from a controller: across the fingers, not along them.
fn grip_from_palm((position, rotation): RoomPose, radius_m: f32, hand: usize) -> RoomPose {
    let side = if hand == 0 { -1.0 } else { 1.0 };
    let to_palm = Mat3::from_cols(Vec3::Y * side, Vec3::Z, Vec3::X * side);
    let grip = (rotation * Quat::from_mat3(&to_palm)).normalize();
    (position + rotation * Vec3::new(0.0, -radius_m, 0.0), grip)
}

/// Pinch thresholds: metres between the tips of thumb and index finger, open and closed.
const PINCH_OPEN_CLOSED_M: [f32; 2] = [0.05, 0.015];

/// Fist thresholds: mean distance in metres from the palm to the other fingers' tips, open and closed.
const FIST_OPEN_CLOSED_M: [f32; 2] = [0.085, 0.045];

/// Returns a linear ramp: 0 at `open_m` and beyond, 1 at `closed_m` and below.
fn closed_fraction(distance_m: f32, [open_m, closed_m]: [f32; 2]) -> f32 {
    ((open_m - distance_m) / (open_m - closed_m)).clamp(0.0, 1.0)
}

/// Converts 0 to 1 to a byte; NaN becomes 0.
fn to_unorm8(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// Converts -1 to 1 to a signed byte; NaN becomes 0.
fn to_snorm8(value: f32) -> i8 {
    (value.clamp(-1.0, 1.0) * 127.0).round() as i8
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};
    use paros_core::HandInput;
    use paros_core::internals::UNITS_PER_METRE;

    use super::{HandJoints, HandSample, ReportedPose, Tracking};

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
        // The aim is unknown: a pose that the core ignores.
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

    const TRACKED: Tracking = Tracking::Tracked;

    /// Returns a hand at (0, 1, 0) with its palm down. `gap` is the distance between the tips of thumb and
    /// index finger, the other arguments are distances from the palm, in metres.
    fn hand_with(gap: f32, reach: f32, index_reach: f32) -> HandJoints {
        let at = |position| ReportedPose { pose: (position, Quat::IDENTITY), tracking: TRACKED };
        let index = Vec3::Y + Vec3::NEG_Z * index_reach;
        HandJoints {
            hand: 1,
            palm: at(Vec3::Y),
            palm_radius_m: 0.015,
            pinch_tips: [at(index + Vec3::X * gap), at(index)],
            fist_tips: [at(Vec3::Y + Vec3::NEG_Z * reach); 3],
        }
    }

    #[test]
    fn a_pinch_is_the_trigger_and_a_fist_the_squeeze() {
        let hand = |gap, reach, index_reach| {
            HandSample::from_joints(&hand_with(gap, reach, index_reach)).expect("it is tracked")
        };
        let open = hand(0.08, 0.1, 0.09);
        assert_eq!((open.trigger, open.squeeze), (0.0, 0.0));
        assert!(open.to_hand_input().tracked);
        assert_eq!(open.fingertip, Some(Vec3::new(0.0, 1.0, -0.09)));
        let pinch = hand(0.01, 0.1, 0.09);
        assert_eq!((pinch.trigger, pinch.squeeze), (1.0, 0.0));
        // Thumb and index finger meet in a fist.
        let fist = hand(0.01, 0.03, 0.03);
        assert_eq!((fist.trigger, fist.squeeze), (0.0, 1.0));
        // A tool in the fist, and a finger that reaches out of it to the thumb.
        let both = hand(0.01, 0.03, 0.09);
        assert_eq!((both.trigger, both.squeeze), (1.0, 1.0));
        let half = hand(0.0325, 0.1, 0.09).trigger;
        assert!((half - 0.5).abs() < 0.01, "{half}");
    }

    #[test]
    fn a_frozen_hand_is_none_and_a_hidden_fingertip_is_guessed() {
        let whole = hand_with(0.08, 0.03, 0.09);
        let sample = HandSample::from_joints(&whole);
        assert!(sample.is_some());
        for tracking in [Tracking::Inferred, Tracking::Unknown] {
            let palm = ReportedPose { tracking, ..whole.palm };
            assert_eq!(HandSample::from_joints(&HandJoints { palm, ..whole }), None);
            assert_eq!(palm.if_tracked(), None);
        }
        let mut hidden = whole;
        hidden.fist_tips[1].tracking = Tracking::Inferred;
        hidden.pinch_tips[0].tracking = Tracking::Inferred;
        assert_eq!(HandSample::from_joints(&hidden), sample);
        hidden.fist_tips[1].tracking = Tracking::Unknown;
        assert_eq!(HandSample::from_joints(&hidden), None);
        hidden = whole;
        hidden.pinch_tips[1].tracking = Tracking::Unknown;
        assert_eq!(HandSample::from_joints(&hidden), None);
    }

    #[test]
    fn a_bare_hands_grip_lies_across_its_fingers() {
        // Palms down, fingers ahead: both thumbs point inwards, and tools with them.
        for (hand, inwards) in [(0, Vec3::X), (1, Vec3::NEG_X)] {
            let joints = HandJoints { hand, ..hand_with(0.08, 0.1, 0.09) };
            let sample = HandSample::from_joints(&joints).expect("it is tracked");
            let (position, rotation) = sample.grip.expect("it is tracked");
            assert!(position.distance(Vec3::new(0.0, 0.985, 0.0)) < 1e-6, "on the skin");
            let near = |axis: Vec3, wanted: Vec3| {
                assert!((rotation * axis).distance(wanted) < 1e-5, "{hand}: {axis} to {wanted}");
            };
            near(Vec3::NEG_Z, inwards);
            near(Vec3::Y, Vec3::Z);
            // Away from the left palm, into the right one.
            near(Vec3::X, if hand == 0 { Vec3::NEG_Y } else { Vec3::Y });
            assert_eq!(sample.aim, Some(joints.palm.pose));
        }
    }
}
