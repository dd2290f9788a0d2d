//! A session: its spaces, and what is asked of the display and the processors.

use ash::vk::Handle;
use glam::{Quat, Vec3};
use openxr as xr;
use paros_core::hand::RoomPose;
use paros_shaders::gpu::{Eye, Fov, Gpu};

use super::{Actions, BareHands, NO_PROFILE, Runtime, VIEWS, room_pose, tracked};
use crate::error::{Doing, Error};

/// A session that was made, not yet begun.
pub(crate) struct Session {
    pub(crate) raw: xr::Session<xr::Vulkan>,
    pub(crate) waiter: xr::FrameWaiter,
    pub(crate) stream: xr::FrameStream<xr::Vulkan>,
    /// The room: its origin is on the floor, its -z was ahead when it was made or recentred.
    pub(crate) room: xr::Space,
    pub(crate) room_kind: xr::ReferenceSpaceType,
    head: xr::Space,
    pub(crate) actions: Actions,
    pub(crate) bare: Option<BareHands>,
}

/// How high a room's origin is held to be over the floor where the runtime doesn't know the floor.
const EYES: f32 = 1.6;

/// Hertz by which a rate may differ and be called the same: displays have 71.9 for 72.
const SAME: f32 = 0.5;

impl Session {
    /// A session of a headset that shows what a device draws.
    ///
    /// # Errors
    /// [`Error::Unavailable`] where there is nothing to sculpt by, or a call that failed.
    pub(crate) fn new(runtime: &Runtime, gpu: &Gpu) -> Result<Self, Error> {
        let info = xr::vulkan::SessionCreateInfo {
            instance: gpu.instance.raw.handle().as_raw() as _,
            physical_device: gpu.physical.as_raw() as _,
            device: gpu.device.handle().as_raw() as _,
            queue_family_index: gpu.family,
            queue_index: 0,
        };
        // SAFETY: the device was made by way of this runtime, and outlives the session.
        let made = unsafe { runtime.instance.create_session::<xr::Vulkan>(runtime.system, &info) };
        let (raw, waiter, stream) = made.doing("make a session")?;
        let (room, room_kind) = room(&raw)?;
        let space = |kind| raw.create_reference_space(kind, xr::Posef::IDENTITY);
        let head = space(xr::ReferenceSpaceType::VIEW).doing("make a space")?;
        let actions = Actions::new(&runtime.instance, &raw, &runtime.extensions)?;
        let bare = BareHands::new(runtime, &raw);
        if actions.profiles == 0 && bare.is_none() {
            let why = format!("{NO_PROFILE}, and tracks no bare hands: choose another runtime");
            return Err(Error::Unavailable(why));
        }
        Ok(Session { raw, waiter, stream, room, room_kind, head, actions, bare })
    }

    /// Asks for the display's rate, where one can: what has become of it. What is refused is no
    /// failure: the pictures are the same.
    pub(crate) fn ask_rate(&self, runtime: &Runtime, wanted: f32) -> String {
        if !runtime.extensions.fb_display_refresh_rate {
            let name = &runtime.name;
            return format!("{name} has no XR_FB_display_refresh_rate: {}", unasked(wanted));
        }
        let rates = self.raw.enumerate_display_refresh_rates().unwrap_or_default();
        let Some(rate) = nearest_rate(&rates, wanted) else {
            return format!("the display offers no rates: {}", unasked(wanted));
        };
        let asked = match self.raw.request_display_refresh_rate(rate) {
            Ok(()) => format!("is asked for {rate} Hz"),
            Err(result) => format!("was asked for {rate} Hz, and refused: {result:?}"),
        };
        if (rate - wanted).abs() < SAME {
            return format!("the display {asked}");
        }
        let offered: Vec<String> = rates.iter().map(ToString::to_string).collect();
        format!("the display has no {wanted} Hz, only {} Hz: it {asked}", offered.join(", "))
    }

    /// Asks for the processors' pace, where one can. What is refused is no failure.
    pub(crate) fn ask_pace(&self, runtime: &Runtime) {
        if let Some(settings) = &runtime.instance.exts().ext_performance_settings {
            let level = xr::PerfSettingsLevelEXT::SUSTAINED_HIGH;
            for domain in [xr::PerfSettingsDomainEXT::CPU, xr::PerfSettingsDomainEXT::GPU] {
                // SAFETY: the session is alive, and the extension is enabled.
                let _ = unsafe {
                    (settings.perf_settings_set_performance_level)(self.raw.as_raw(), domain, level)
                };
            }
        }
    }

    /// What is told where the floor under the visitor isn't known.
    pub(crate) fn floor(&self) -> Option<String> {
        match self.room_kind {
            xr::ReferenceSpaceType::LOCAL_FLOOR => None,
            xr::ReferenceSpaceType::STAGE => {
                Some("has no LOCAL_FLOOR: the floor is the stage's".into())
            }
            _ => Some(format!(
                "has no LOCAL_FLOOR and no STAGE: the floor is held to be {EYES} m below where the \
                 eyes began"
            )),
        }
    }

    /// Tells the system that the calling thread is the one that ticks and draws, where it has an
    /// ear for that: Android. What is refused is no failure.
    pub(crate) fn name_threads(&self, runtime: &Runtime) {
        if let (Some(name), Some(thread)) = (runtime.thread_types, this_thread()) {
            for kind in [
                xr::AndroidThreadTypeKHR::APPLICATION_MAIN,
                xr::AndroidThreadTypeKHR::RENDERER_MAIN,
            ] {
                // SAFETY: the session is alive, and the extension is enabled.
                let _ = unsafe { name(self.raw.as_raw(), kind, thread) };
            }
        }
    }

    /// The head at a time.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn head(&self, at: xr::Time) -> Result<Option<RoomPose>, Error> {
        let location = self.head.locate(&self.room, at).doing("find the head")?;
        Ok(tracked(location.location_flags, location.pose))
    }

    /// The eyes at a time, and as the runtime wants them back. Takes no memory, unlike the crate's
    /// own way.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn eyes(&self, at: xr::Time) -> Result<[(Eye, xr::sys::View); 2], Error> {
        let info = xr::sys::ViewLocateInfo {
            ty: xr::sys::ViewLocateInfo::TYPE,
            next: core::ptr::null(),
            view_configuration_type: VIEWS,
            display_time: at,
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
            return Err(Error::Call { doing: "find the eyes", result });
        }
        let known = xr::ViewStateFlags::POSITION_VALID | xr::ViewStateFlags::ORIENTATION_VALID;
        if !state.view_state_flags.contains(known) {
            // What stands there may be no pose at all, and goes back to the runtime.
            let position = xr::Vector3f { x: 0.0, y: EYES, z: 0.0 };
            for view in &mut views {
                view.pose = xr::Posef { position, ..xr::Posef::IDENTITY };
            }
        }
        Ok(views.map(|view| (eye(&view), view)))
    }
}

/// The kernel's number of the calling thread, where there is a Linux kernel.
fn this_thread() -> Option<u32> {
    std::fs::read_link("/proc/thread-self").ok()?.file_name()?.to_str()?.parse().ok()
}

fn unasked(wanted: f32) -> String {
    format!("it is asked for none, {wanted} Hz or another")
}

/// The rate nearest to the one that is wanted: the tick's own, or 90 where that is asked for.
fn nearest_rate(rates: &[f32], wanted: f32) -> Option<f32> {
    let away = |rate: &&f32| (**rate - wanted).abs();
    rates.iter().min_by(|a, b| away(a).total_cmp(&away(b))).copied()
}

/// The room by its floor; by the stage where the floor under the visitor isn't known, and by the
/// eyes where neither is.
fn room(session: &xr::Session<xr::Vulkan>) -> Result<(xr::Space, xr::ReferenceSpaceType), Error> {
    let kinds = session.enumerate_reference_spaces().doing("list spaces")?;
    let wanted = [xr::ReferenceSpaceType::LOCAL_FLOOR, xr::ReferenceSpaceType::STAGE];
    let found = wanted.into_iter().find(|kind| kinds.contains(kind));
    let (kind, height) = found.map_or((xr::ReferenceSpaceType::LOCAL, EYES), |kind| (kind, 0.0));
    let position = xr::Vector3f { x: 0.0, y: -height, z: 0.0 };
    let pose = xr::Posef { position, ..xr::Posef::IDENTITY };
    let space = session.create_reference_space(kind, pose).doing("make a space")?;
    Ok((space, kind))
}

/// An eye whose pose is not known looks ahead from where a head would be.
fn eye(view: &xr::sys::View) -> Eye {
    let (position, rotation) = room_pose(view.pose);
    let known = rotation.is_finite() && rotation.length_squared() > 0.5 && position.is_finite();
    let (position, rotation) =
        if known { (position, rotation.normalize()) } else { (Vec3::Y * EYES, Quat::IDENTITY) };
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
