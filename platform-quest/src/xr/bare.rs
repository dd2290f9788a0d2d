//! Bare hands, for when the controllers are put down.

use openxr as xr;

use super::{Runtime, room_pose};
use crate::error::{Doing, Error};
use crate::sample::{HandSample, Joints};

/// Trackers of both hands.
pub(crate) struct BareHands {
    trackers: [xr::HandTracker; 2],
}

/// The joints that say what a hand does.
const PALM: xr::HandJoint = xr::HandJoint::PALM;
const PINCHING: [xr::HandJoint; 2] = [xr::HandJoint::THUMB_TIP, xr::HandJoint::INDEX_TIP];
const OTHERS: [xr::HandJoint; 3] =
    [xr::HandJoint::MIDDLE_TIP, xr::HandJoint::RING_TIP, xr::HandJoint::LITTLE_TIP];

impl BareHands {
    /// Trackers, where the headset has any.
    pub(crate) fn new(runtime: &Runtime, session: &xr::Session<xr::Vulkan>) -> Option<Self> {
        let has = runtime.extensions.ext_hand_tracking
            && runtime.instance.supports_hand_tracking(runtime.system).unwrap_or(false);
        if !has {
            return None;
        }
        let left = session.create_hand_tracker(xr::Hand::LEFT).ok()?;
        let right = session.create_hand_tracker(xr::Hand::RIGHT).ok()?;
        Some(BareHands { trackers: [left, right] })
    }

    /// A bare hand at a time; none while it isn't seen.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn sample(
        &self,
        room: &xr::Space,
        hand: usize,
        at: xr::Time,
    ) -> Result<Option<HandSample>, Error> {
        let joints = room.locate_hand_joints(&self.trackers[hand], at).doing("find the fingers")?;
        let Some(joints) = joints else { return Ok(None) };
        let valid =
            xr::SpaceLocationFlags::POSITION_VALID | xr::SpaceLocationFlags::ORIENTATION_VALID;
        let pose = |joint: xr::HandJoint| room_pose(joints[joint.into_raw() as usize].pose);
        let seen = |joint: &xr::HandJoint| {
            joints[joint.into_raw() as usize].location_flags.contains(valid)
        };
        let all = || [PALM].iter().chain(&PINCHING).chain(&OTHERS).all(seen);
        Ok(all().then(|| {
            HandSample::bare(&Joints {
                palm: pose(PALM),
                pinching: PINCHING.map(|joint| pose(joint).0),
                others: OTHERS.map(|joint| pose(joint).0),
            })
        }))
    }
}
