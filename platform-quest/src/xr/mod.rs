//! The calls of OpenXR, and the Vulkan device that comes by way of them. Nothing is decided here.

mod actions;
mod bare;
mod chain;
mod eyes;
mod instance;
mod session;

pub(crate) use actions::{Actions, NO_PROFILE};
pub(crate) use bare::BareHands;
pub(crate) use eyes::{Eyes, Images, Shot};
pub(crate) use instance::Runtime;
pub(crate) use session::Session;

use glam::{Quat, Vec3};
use openxr as xr;
use paros_core::hand::RoomPose;

/// The two eyes.
pub(crate) const VIEWS: xr::ViewConfigurationType = xr::ViewConfigurationType::PRIMARY_STEREO;

/// A pose of the runtime's.
pub(crate) fn room_pose(pose: xr::Posef) -> RoomPose {
    let xr::Posef { position: p, orientation: q } = pose;
    (Vec3::new(p.x, p.y, p.z), Quat::from_xyzw(q.x, q.y, q.z, q.w))
}

/// A pose that is tracked, not guessed.
pub(crate) fn tracked(flags: xr::SpaceLocationFlags, pose: xr::Posef) -> Option<RoomPose> {
    let wanted = xr::SpaceLocationFlags::POSITION_VALID
        | xr::SpaceLocationFlags::ORIENTATION_VALID
        | xr::SpaceLocationFlags::POSITION_TRACKED;
    flags.contains(wanted).then(|| room_pose(pose))
}
