//! What the shell needs of the operating system beside the runtime: an OpenXR entry point, an instance,
//! the device's health, its time, a log.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use openxr as xr;
use paros_headset::start_up::StartUp;
use paros_shell::headset::device_health::DeviceHealth;
use paros_shell::last_use::BootId;
use paros_upload::courier::CourierLink;
use paros_upload::enrolment::Enrolment;

use crate::boot_clock;
use crate::error::Error;
use crate::log::write_log_line;

/// The operating system: Android, or anything else.
pub trait Platform {
    /// Loads the OpenXR loader or runtime. Called again after a session was lost; what may be called once in
    /// a process alone is then kept.
    ///
    /// # Errors
    /// [`Error::Unavailable`] where there is none.
    fn load_openxr(&mut self) -> Result<xr::Entry, Error>;

    /// Creates an instance with these extensions, and those that the operating system itself needs.
    ///
    /// # Errors
    /// The runtime's.
    fn create_instance(
        &mut self,
        entry: &xr::Entry,
        application: &xr::ApplicationInfo<'_>,
        extensions: xr::ExtensionSet,
    ) -> xr::Result<xr::Instance> {
        entry.create_instance(application, &extensions, &[], &())
    }

    /// Polls the operating system; called in every frame, and often while no frames are made.
    fn poll_status(&mut self) -> PlatformStatus {
        PlatformStatus::default()
    }

    /// The time since the device booted, sleep included.
    fn since_boot(&self) -> Duration {
        boot_clock::read_since_boot()
    }

    /// Which boot that was; none where it can't be told.
    fn boot_id(&self) -> Option<BootId> {
        BootId::read_from_kernel()
    }

    /// Runs a step of the world. A profiler reads its clock before and after.
    fn run_world_step(&mut self, step: &mut dyn FnMut()) {
        step();
    }

    /// What wraps the functions of a Vulkan device in a profiler's, if anything does.
    fn vulkan_device_wrapper(&self) -> Option<fn(ash::Device) -> ash::Device> {
        None
    }

    /// Told where the start stands, whenever that changes. Until it is ready, and again while a lost session is made
    /// anew, there is nothing to save.
    fn note_start_up(&mut self, _start: StartUp) {}

    /// Connects to the booth at which the device is enrolled; none where there is no way there.
    fn open_booth_link(&mut self, _enrolment: &Enrolment) -> Option<CourierLink> {
        None
    }

    /// The booth doesn't know the device any more: it enrols anew, where something lets it. Called as long as that is so.
    fn enrol_again(&mut self) {}

    /// Whether the device has become one of a booth's headsets since this was last asked.
    fn poll_enrolled(&mut self) -> bool {
        false
    }

    /// Where the enrolment and the outbox lie, which others must not read; `sessions` is the folder of saved sessions.
    fn booth_folder(&self, sessions: &Path) -> PathBuf {
        sessions.to_owned()
    }

    /// Writes a line to the log.
    fn log(&mut self, text: fmt::Arguments<'_>) {
        write_log_line(text);
    }
}

/// The operating system's state.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct PlatformStatus {
    /// Thermal state and battery.
    pub health: DeviceHealth,
    /// Whether the application is to quit.
    pub quit_requested: bool,
}

/// An operating system that reports nothing, with the loader among the system's libraries: Linux.
#[derive(Clone, Copy, Default, Debug)]
pub struct PlainPlatform;

impl Platform for PlainPlatform {
    fn load_openxr(&mut self) -> Result<xr::Entry, Error> {
        // SAFETY: the loader is the system's own; loading it runs its initialisers.
        unsafe { xr::Entry::load(&()) }.map_err(|error| {
            let mut why: &dyn std::error::Error = &error;
            while let Some(deeper) = why.source() {
                why = deeper;
            }
            Error::Unavailable(format!(
                "no OpenXR loader: {why}; install one (Debian: libopenxr-loader1)"
            ))
        })
    }

    #[cfg(not(target_os = "android"))]
    fn open_booth_link(&mut self, enrolment: &Enrolment) -> Option<CourierLink> {
        use paros_protocol::LinkTimes;
        use paros_upload_https::open_link;

        Some(Box::new(open_link(&enrolment.booth_address(), LinkTimes::default())))
    }
}
