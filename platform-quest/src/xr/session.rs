//! A session: its reference spaces and actions, its display refresh rate and performance levels.

use ash::vk::Handle;
use glam::{Quat, Vec3};
use openxr as xr;
use paros_core::internals::RoomPose;
use paros_headset::room_placement::RoomTransform;
use paros_shaders::gpu::{Eye, Fov, Gpu};
use paros_shell::headset::hand_reader::{HandProfile, HandReport, HandSource};
use paros_shell::headset::hand_sample::HandSample;

use super::{
    ControllerActions, HandTrackers, NO_PROFILE, Runtime, VIEW_CONFIGURATION, convert_location,
    convert_pose, pose_of,
};
use crate::error::{CallContext, Error};

/// An OpenXR session, its frame loop, spaces and input.
pub(crate) struct HeadsetSession {
    pub(crate) raw: xr::Session<xr::Vulkan>,
    pub(crate) waiter: xr::FrameWaiter,
    pub(crate) stream: xr::FrameStream<xr::Vulkan>,
    /// The room: a reference space with its origin on the floor, whose -z is ahead of the visitor. Poses are
    /// located in it, and layers are submitted in it.
    pub(crate) room: xr::Space,
    pub(crate) room_type: xr::ReferenceSpaceType,
    head: xr::Space,
    pub(crate) actions: ControllerActions,
    pub(crate) hand_trackers: Option<HandTrackers>,
}

/// An eye at one time: for the renderer, and as a view for the projection layer.
pub(crate) struct LocatedEye {
    pub(crate) eye: Eye,
    pub(crate) view: xr::sys::View,
}

/// The assumed height of the eyes above the floor, in metres, if the runtime doesn't know the floor.
const EYE_HEIGHT: f32 = 1.6;

/// The difference in hertz up to which two refresh rates count as equal: displays report 71.9 for 72.
const RATE_TOLERANCE: f32 = 0.5;

impl HeadsetSession {
    /// Creates a session for images that a Vulkan device draws.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if there is no input to sculpt with, or a call that failed.
    pub(crate) fn create(runtime: &Runtime, gpu: &Gpu) -> Result<Self, Error> {
        let (raw, waiter, stream) = create_raw_session(runtime, gpu)?;
        let (room, room_type) = create_local_floor_or_fallback(&raw)?;
        let space = |kind| raw.create_reference_space(kind, xr::Posef::IDENTITY);
        let head = space(xr::ReferenceSpaceType::VIEW).could_not("make a space")?;
        let actions = ControllerActions::create(&runtime.instance, &raw, &runtime.extensions)?;
        let hand_trackers = HandTrackers::create(runtime, &raw);
        if actions.profiles.accepted == 0 && hand_trackers.is_none() {
            let why = format!("{NO_PROFILE}, and tracks no bare hands: choose another runtime");
            return Err(Error::Unavailable(why));
        }
        Ok(HeadsetSession { raw, waiter, stream, room, room_type, head, actions, hand_trackers })
    }

    /// Moves the room within the runtime's reference space, from now on.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn move_room(&mut self, room: RoomTransform) -> Result<(), Error> {
        self.room = create_room(&self.raw, self.room_type, room)?;
        Ok(())
    }

    /// Requests the display refresh rate nearest to `wanted_hz`, if the runtime offers any. Returns a log
    /// line. A refusal is not an error: the pictures are the same.
    pub(crate) fn request_refresh_rate_and_describe(
        &self,
        runtime: &Runtime,
        wanted_hz: f32,
    ) -> String {
        if !runtime.extensions.fb_display_refresh_rate {
            let name = &runtime.name;
            return format!(
                "{name} has no XR_FB_display_refresh_rate: {}",
                describe_no_request(wanted_hz)
            );
        }
        let rates = self.raw.enumerate_display_refresh_rates().unwrap_or_default();
        let Some(rate) = nearest_rate(&rates, wanted_hz) else {
            return format!("the display offers no rates: {}", describe_no_request(wanted_hz));
        };
        let asked = match self.raw.request_display_refresh_rate(rate) {
            Ok(()) => format!("is asked for {rate} Hz"),
            Err(result) => format!("was asked for {rate} Hz, and refused: {result:?}"),
        };
        if (rate - wanted_hz).abs() < RATE_TOLERANCE {
            return format!("the display {asked}");
        }
        let offered: Vec<String> = rates.iter().map(ToString::to_string).collect();
        format!("the display has no {wanted_hz} Hz, only {} Hz: it {asked}", offered.join(", "))
    }

    /// Requests the performance level SUSTAINED_HIGH for CPU and GPU, if the runtime has performance
    /// settings. Call it after each begin of the session, as Meta's runtime resets it at the end. Returns a
    /// log line for each refusal, which is not an error.
    pub(crate) fn request_performance_levels(&self, runtime: &Runtime) -> Vec<String> {
        let Some(settings) = &runtime.instance.exts().ext_performance_settings else {
            return Vec::new();
        };
        let level = xr::PerfSettingsLevelEXT::SUSTAINED_HIGH;
        let domains =
            [("CPU", xr::PerfSettingsDomainEXT::CPU), ("GPU", xr::PerfSettingsDomainEXT::GPU)];
        let refused = domains.map(|(name, domain)| {
            // SAFETY: the session is alive, and the extension is enabled.
            let result = unsafe {
                (settings.perf_settings_set_performance_level)(self.raw.as_raw(), domain, level)
            };
            let is_refused = result.into_raw() < 0;
            is_refused.then(|| format!("no sustained high performance of the {name}: {result:?}"))
        });
        refused.into_iter().flatten().collect()
    }

    /// Returns the log line for a runtime without a LOCAL_FLOOR space.
    pub(crate) fn describe_missing_local_floor(&self) -> Option<String> {
        match self.room_type {
            xr::ReferenceSpaceType::LOCAL_FLOOR => None,
            xr::ReferenceSpaceType::STAGE => {
                Some("has no LOCAL_FLOOR: the floor is the stage's".into())
            }
            _ => Some(format!(
                "has no LOCAL_FLOOR and no STAGE: the floor is held to be {EYE_HEIGHT} m below where the \
                 eyes began"
            )),
        }
    }

    /// Marks the calling thread as the application's and the renderer's main thread, if the runtime has
    /// Android's thread settings. A refusal is not an error.
    pub(crate) fn set_thread_types(&self, runtime: &Runtime) {
        if let (Some(set_type), Some(thread)) = (runtime.set_thread_type, current_thread_id()) {
            for kind in [
                xr::AndroidThreadTypeKHR::APPLICATION_MAIN,
                xr::AndroidThreadTypeKHR::RENDERER_MAIN,
            ] {
                // SAFETY: the session is alive, and the extension is enabled.
                let _ = unsafe { set_type(self.raw.as_raw(), kind, thread) };
            }
        }
    }

    /// Reports everything known of a hand at a time; its actions are those of the last sync.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn report_hand(
        &self,
        hand: usize,
        profile: HandProfile,
        time: xr::Time,
    ) -> Result<HandReport, Error> {
        let actions = self.actions.sample_hand(&self.raw, &self.room, hand, time)?;
        Ok(HandReport { profile, actions, joints: self.sample_joints(hand, time)? })
    }

    /// Locates a hand's grip at a time, from the hand's input source.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn locate_grip(
        &self,
        hand: usize,
        source: HandSource,
        time: xr::Time,
    ) -> Result<Option<RoomPose>, Error> {
        match source {
            HandSource::None => Ok(None),
            HandSource::Controller | HandSource::HandInteraction => {
                self.actions.locate_grip(&self.room, hand, time)
            }
            HandSource::Joints => {
                Ok(self.sample_joints(hand, time)?.and_then(|sample| sample.grip))
            }
        }
    }

    fn sample_joints(&self, hand: usize, time: xr::Time) -> Result<Option<HandSample>, Error> {
        let trackers = self.hand_trackers.as_ref();
        trackers.map_or(Ok(None), |trackers| trackers.sample_hand(&self.room, hand, time))
    }

    /// Locates the head at a time.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn locate_head(&self, time: xr::Time) -> Result<Option<RoomPose>, Error> {
        let location = self.head.locate(&self.room, time).could_not("find the head")?;
        Ok(convert_location(location.location_flags, location.pose).if_tracked())
    }

    /// Locates the left and the right eye at a time. Unlike the `openxr` crate's own call, it doesn't
    /// allocate.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn locate_eyes(&self, time: xr::Time) -> Result<[LocatedEye; 2], Error> {
        let info = xr::sys::ViewLocateInfo {
            ty: xr::sys::ViewLocateInfo::TYPE,
            next: core::ptr::null(),
            view_configuration_type: VIEW_CONFIGURATION,
            display_time: time,
            space: self.room.as_raw(),
        };
        let mut state = xr::sys::ViewState {
            ty: xr::sys::ViewState::TYPE,
            next: core::ptr::null_mut(),
            view_state_flags: xr::ViewStateFlags::EMPTY,
        };
        let view = xr::sys::View {
            ty: xr::sys::View::TYPE,
            next: core::ptr::null_mut(),
            pose: xr::Posef::IDENTITY,
            fov: xr::Fovf::default(),
        };
        let (mut views, mut count) = ([view; 2], 0);
        let locate = self.raw.instance().fp().locate_views;
        // SAFETY: the session and the space are alive, and there is room for two views.
        let result = unsafe {
            locate(self.raw.as_raw(), &info, &mut state, 2, &mut count, views.as_mut_ptr())
        };
        if result.into_raw() < 0 {
            return Err(Error::Call { action: "find the eyes", result });
        }
        let known = xr::ViewStateFlags::POSITION_VALID | xr::ViewStateFlags::ORIENTATION_VALID;
        if !state.view_state_flags.contains(known) {
            // The poses are undefined, but are submitted to the runtime: replace them.
            let position = xr::Vector3f { x: 0.0, y: EYE_HEIGHT, z: 0.0 };
            for view in &mut views {
                view.pose = xr::Posef { position, ..xr::Posef::IDENTITY };
            }
        }
        Ok(views.map(|view| LocatedEye { eye: eye_from_view(&view), view }))
    }
}

/// A session without spaces or input, with its frame waiter and frame stream.
pub(crate) type RawSession =
    (xr::Session<xr::Vulkan>, xr::FrameWaiter, xr::FrameStream<xr::Vulkan>);

/// Creates a session without spaces or input, for images that a Vulkan device draws.
///
/// # Errors
/// A call that failed.
pub(crate) fn create_raw_session(runtime: &Runtime, gpu: &Gpu) -> Result<RawSession, Error> {
    let info = xr::vulkan::SessionCreateInfo {
        instance: gpu.instance.raw.handle().as_raw() as _,
        physical_device: gpu.physical_device.as_raw() as _,
        device: gpu.device.handle().as_raw() as _,
        queue_family_index: gpu.queue_family,
        queue_index: 0,
    };
    // SAFETY: the device was made by way of this runtime, and outlives the session.
    let made = unsafe { runtime.instance.create_session::<xr::Vulkan>(runtime.system, &info) };
    made.could_not("make a session")
}

/// Returns the kernel's ID of the calling thread, if the kernel is Linux.
fn current_thread_id() -> Option<u32> {
    std::fs::read_link("/proc/thread-self").ok()?.file_name()?.to_str()?.parse().ok()
}

fn describe_no_request(wanted_hz: f32) -> String {
    format!("it is asked for none, {wanted_hz} Hz or another")
}

/// Returns the refresh rate nearest to `wanted_hz`.
fn nearest_rate(rates_hz: &[f32], wanted_hz: f32) -> Option<f32> {
    let away = |rate: &&f32| (**rate - wanted_hz).abs();
    rates_hz.iter().min_by(|a, b| away(a).total_cmp(&away(b))).copied()
}

/// Creates the room's space: LOCAL_FLOOR, otherwise STAGE, otherwise LOCAL lowered by the height of the eyes.
fn create_local_floor_or_fallback(
    session: &xr::Session<xr::Vulkan>,
) -> Result<(xr::Space, xr::ReferenceSpaceType), Error> {
    let kinds = session.enumerate_reference_spaces().could_not("list spaces")?;
    let wanted = [xr::ReferenceSpaceType::LOCAL_FLOOR, xr::ReferenceSpaceType::STAGE];
    let found = wanted.into_iter().find(|kind| kinds.contains(kind));
    let kind = found.unwrap_or(xr::ReferenceSpaceType::LOCAL);
    Ok((create_room(session, kind, RoomTransform::default())?, kind))
}

/// Creates the room's space on the floor of a reference space, or a height step above or below the floor.
fn create_room(
    session: &xr::Session<xr::Vulkan>,
    kind: xr::ReferenceSpaceType,
    room: RoomTransform,
) -> Result<xr::Space, Error> {
    let eyes = if kind == xr::ReferenceSpaceType::LOCAL { EYE_HEIGHT } else { 0.0 };
    let pose = pose_of((room.translation() - Vec3::Y * eyes, room.rotation()));
    session.create_reference_space(kind, pose).could_not("make a space")
}

/// Returns the renderer's eye for a view. If the pose is unknown, the eye looks ahead from a head's height.
fn eye_from_view(view: &xr::sys::View) -> Eye {
    let (position, rotation) = convert_pose(view.pose);
    let known = rotation.is_finite() && rotation.length_squared() > 0.5 && position.is_finite();
    let (position, rotation) = if known {
        (position, rotation.normalize())
    } else {
        (Vec3::Y * EYE_HEIGHT, Quat::IDENTITY)
    };
    let xr::Fovf { angle_left: left, angle_right: right, angle_up: up, angle_down: down } =
        view.fov;
    Eye { position, rotation, fov: Fov { left, right, up, down } }
}

#[cfg(test)]
mod tests {
    use super::nearest_rate;

    #[test]
    fn the_nearest_rate_is_asked_for() {
        assert_eq!(nearest_rate(&[], 72.0), None);
        assert_eq!(nearest_rate(&[60.0, 72.0, 80.0, 90.0, 120.0], 72.0), Some(72.0));
        assert_eq!(nearest_rate(&[60.0, 72.0, 80.0, 90.0, 120.0], 90.0), Some(90.0));
        assert_eq!(nearest_rate(&[60.0, 80.0, 120.0], 90.0), Some(80.0));
    }
}
