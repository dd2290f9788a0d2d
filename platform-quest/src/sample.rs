//! A hand as the runtime gives it, as the core takes it.

use glam::Vec3;
use paros_core::hand::RoomPose;
use paros_core::input::{HandInput, RawPose};

/// A controller or a bare hand at one time.
#[derive(Clone, Copy, PartialEq, Default, Debug)]
pub struct HandSample {
    /// Where it points, in metres; none while that is not tracked.
    pub aim: Option<RoomPose>,
    /// Where its palm is.
    pub grip: Option<RoomPose>,
    /// 0 to 1.
    pub trigger: f32,
    /// 0 to 1.
    pub squeeze: f32,
    /// To the right and forward, -1 to 1.
    pub stick: [f32; 2],
    /// Of [`paros_core::input::buttons`].
    pub buttons: u8,
}

/// The joints of a bare hand that say what it does, in metres.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Joints {
    /// The palm: it faces along -y, the fingers point along -z.
    pub palm: RoomPose,
    /// The tips of the thumb and the index finger.
    pub pinching: [Vec3; 2],
    /// The tips of the three other fingers.
    pub others: [Vec3; 3],
}

impl HandSample {
    /// What the core is told.
    #[must_use]
    pub fn input(&self) -> HandInput {
        let raw = |pose: Option<RoomPose>| {
            pose.map_or(RawPose::default(), |(position, rotation)| RawPose::new(position, rotation))
        };
        HandInput {
            aim: raw(self.aim),
            grip: raw(self.grip),
            trigger: unsigned(self.trigger),
            squeeze: unsigned(self.squeeze),
            stick: self.stick.map(signed),
            buttons: self.buttons,
            tracked: self.grip.is_some(),
        }
    }

    /// A bare hand: a pinch pulls the trigger, and the other fingers' fist squeezes.
    #[must_use]
    pub fn bare(joints: &Joints) -> Self {
        let [thumb, index] = joints.pinching;
        let mean: f32 = joints.others.iter().map(|tip| tip.distance(joints.palm.0)).sum::<f32>();
        HandSample {
            aim: Some(joints.palm),
            grip: Some(joints.palm),
            trigger: between(thumb.distance(index), PINCH),
            squeeze: between(mean / 3.0, FIST),
            ..HandSample::default()
        }
    }
}

/// Metres between the tips of thumb and index finger: apart, and together.
const PINCH: [f32; 2] = [0.05, 0.015];

/// Metres from the palm to the other fingers' tips: open, and closed.
const FIST: [f32; 2] = [0.085, 0.045];

fn between(value: f32, [none, all]: [f32; 2]) -> f32 {
    ((none - value) / (none - all)).clamp(0.0, 1.0)
}

/// NaN becomes 0.
fn unsigned(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}

/// NaN becomes 0.
fn signed(value: f32) -> i8 {
    (value.clamp(-1.0, 1.0) * 127.0).round() as i8
}

#[cfg(test)]
mod tests {
    use glam::{Quat, Vec3};
    use paros_core::input::{HandInput, METRE};

    use super::{HandSample, Joints};

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
        let input = sample.input();
        assert_eq!(input.grip.position, [METRE / 2, METRE, -METRE / 4]);
        assert_eq!(input.grip.rotation, [0, 0, 0, i16::MAX]);
        assert_eq!((input.trigger, input.squeeze, input.stick), (128, 255, [-127, 32]));
        assert!(input.tracked && input.buttons == 3);
        // The aim is not known: a pose that the core passes over.
        assert!(input.aim.metres().is_none());
    }

    #[test]
    fn what_is_not_tracked_or_no_number_is_nothing() {
        assert_eq!(HandSample::default().input(), HandInput::default());
        let sample = HandSample { trigger: f32::NAN, stick: [f32::NAN; 2], ..Default::default() };
        assert_eq!(sample.input(), HandInput::default());
        let lost = Some((Vec3::splat(f32::NAN), Quat::IDENTITY));
        let input = HandSample { grip: lost, ..Default::default() }.input();
        assert!(input.grip.metres().is_none());
    }

    #[test]
    fn a_pinch_is_the_trigger_and_a_fist_the_squeeze() {
        let hand = |gap: f32, reach: f32| {
            let palm = (Vec3::Y, Quat::IDENTITY);
            let tip = Vec3::Y + Vec3::NEG_Z * reach;
            let thumb = Vec3::new(0.04, 1.0, -0.06);
            let pinching = [thumb, thumb + Vec3::X * gap];
            HandSample::bare(&Joints { palm, pinching, others: [tip; 3] })
        };
        let open = hand(0.08, 0.1);
        assert_eq!((open.trigger, open.squeeze), (0.0, 0.0));
        assert!(open.input().tracked);
        let pinch = hand(0.01, 0.1);
        assert_eq!((pinch.trigger, pinch.squeeze), (1.0, 0.0));
        let fist = hand(0.08, 0.03);
        assert_eq!((fist.trigger, fist.squeeze), (0.0, 1.0));
        let half = hand(0.0325, 0.1).trigger;
        assert!((half - 0.5).abs() < 0.01, "{half}");
    }
}
