//! The calls of OpenXR: instance, session, spaces, actions, hand tracking, swapchains, and the Vulkan device
//! that is created through them. They take handles and times, and return poses, samples and images to draw
//! into. They know nothing of ticks, visits or files, and make no decisions.

mod actions;
mod eyes;
mod hand_tracking;
mod instance;
mod notice_layer;
mod profiles;
mod session;
mod swapchain;

pub(crate) use actions::ControllerActions;
pub(crate) use eyes::{EyeImages, EyeTargets, FrameCapture};
pub(crate) use hand_tracking::HandTrackers;
pub(crate) use instance::Runtime;
pub(crate) use notice_layer::{FrameCalls, NoticeLayer};
pub(crate) use profiles::NO_PROFILE;
pub(crate) use session::{HeadsetSession, create_raw_session};

use glam::{Quat, Vec3};
use openxr as xr;
use paros_core::internals::RoomPose;
use paros_shell::headset::hand_sample::{ReportedPose, Tracking};

/// The view configuration: two eyes.
pub(crate) const VIEW_CONFIGURATION: xr::ViewConfigurationType =
    xr::ViewConfigurationType::PRIMARY_STEREO;

/// Converts a pose from OpenXR's type.
pub(crate) fn convert_pose(pose: xr::Posef) -> RoomPose {
    let xr::Posef { position: p, orientation: q } = pose;
    (Vec3::new(p.x, p.y, p.z), Quat::from_xyzw(q.x, q.y, q.z, q.w))
}

/// Converts a pose to OpenXR's type.
pub(crate) fn pose_of((position, rotation): RoomPose) -> xr::Posef {
    let (Vec3 { x, y, z }, Quat { x: i, y: j, z: k, w }) = (position, rotation);
    xr::Posef {
        position: xr::Vector3f { x, y, z },
        orientation: xr::Quaternionf { x: i, y: j, z: k, w },
    }
}

/// Converts a location to its pose and the tracking quality that its flags report.
pub(crate) fn convert_location(flags: xr::SpaceLocationFlags, pose: xr::Posef) -> ReportedPose {
    let valid = xr::SpaceLocationFlags::POSITION_VALID | xr::SpaceLocationFlags::ORIENTATION_VALID;
    let tracking = match flags.contains(valid) {
        true if flags.contains(xr::SpaceLocationFlags::POSITION_TRACKED) => Tracking::Tracked,
        true => Tracking::Inferred,
        false => Tracking::Unknown,
    };
    ReportedPose { pose: convert_pose(pose), tracking }
}
