//! Hand tracking, for when the controllers are put down.

use openxr as xr;
use paros_shell::headset::hand_sample::{HandJoints, HandSample};

use super::{Runtime, convert_pose};
use crate::error::{CallContext, Error};

/// The trackers of both hands.
pub(crate) struct HandTrackers {
    trackers: [xr::HandTracker; 2],
}

/// The joints that pinch and fist are read from.
const PALM: xr::HandJoint = xr::HandJoint::PALM;
const PINCH_TIPS: [xr::HandJoint; 2] = [xr::HandJoint::THUMB_TIP, xr::HandJoint::INDEX_TIP];
const FIST_TIPS: [xr::HandJoint; 3] =
    [xr::HandJoint::MIDDLE_TIP, xr::HandJoint::RING_TIP, xr::HandJoint::LITTLE_TIP];

impl HandTrackers {
    /// Creates the trackers, where the system supports hand tracking.
    pub(crate) fn create(runtime: &Runtime, session: &xr::Session<xr::Vulkan>) -> Option<Self> {
        let has = runtime.extensions.ext_hand_tracking
            && runtime.instance.supports_hand_tracking(runtime.system).unwrap_or(false);
        if !has {
            return None;
        }
        let left = session.create_hand_tracker(xr::Hand::LEFT).ok()?;
        let right = session.create_hand_tracker(xr::Hand::RIGHT).ok()?;
        Some(HandTrackers { trackers: [left, right] })
    }

    /// Samples a bare hand at a time; none while it isn't tracked.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn sample_hand(
        &self,
        room: &xr::Space,
        hand: usize,
        time: xr::Time,
    ) -> Result<Option<HandSample>, Error> {
        let joints =
            room.locate_hand_joints(&self.trackers[hand], time).could_not("find the fingers")?;
        let Some(joints) = joints else { return Ok(None) };
        let valid =
            xr::SpaceLocationFlags::POSITION_VALID | xr::SpaceLocationFlags::ORIENTATION_VALID;
        let pose = |joint: xr::HandJoint| convert_pose(joints[joint.into_raw() as usize].pose);
        let seen = |joint: &xr::HandJoint| {
            joints[joint.into_raw() as usize].location_flags.contains(valid)
        };
        let all = || [PALM].iter().chain(&PINCH_TIPS).chain(&FIST_TIPS).all(seen);
        Ok(all().then(|| {
            HandSample::from_joints(&HandJoints {
                palm: pose(PALM),
                pinch_tips: PINCH_TIPS.map(|joint| pose(joint).0),
                fist_tips: FIST_TIPS.map(|joint| pose(joint).0),
            })
        }))
    }
}
