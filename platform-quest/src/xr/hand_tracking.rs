//! Hand tracking: the joints of bare hands.

use openxr as xr;
use paros_shell::headset::hand_sample::{HandJoints, HandSample};

use super::{Runtime, convert_location};
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
    /// Creates the trackers, if the system supports hand tracking.
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

    /// Samples a bare hand at a time; `None` while its joints are not tracked.
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
        Ok(joints.and_then(|joints| {
            let report = |joint: xr::HandJoint| {
                let xr::HandJointLocation { location_flags, pose, .. } =
                    joints[joint.into_raw() as usize];
                convert_location(location_flags, pose)
            };
            HandSample::from_joints(&HandJoints {
                hand,
                palm: report(PALM),
                palm_radius_m: joints[PALM.into_raw() as usize].radius,
                pinch_tips: PINCH_TIPS.map(report),
                fist_tips: FIST_TIPS.map(report),
            })
        }))
    }
}
