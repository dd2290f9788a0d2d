//! The interface to the operating system: an OpenXR entry point, an instance, the device's health, its time
//! and a log.

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
    /// Loads the OpenXR loader or runtime. Called again after a session was lost; the results of calls that
    /// are allowed once in a process are then reused.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if there is no loader or runtime.
    fn load_openxr(&mut self) -> Result<xr::Entry, Error>;

    /// Creates an instance with these extensions and the ones that the operating system requires.
    ///
    /// # Errors
    /// The runtime's error.
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

    /// Returns the time since the device booted, sleep included.
    fn since_boot(&self) -> Duration {
        boot_clock::read_since_boot()
    }

    /// Returns the identifier of the current boot; `None` if it is unknown.
    fn boot_id(&self) -> Option<BootId> {
        BootId::read_from_kernel()
    }

    /// Runs a step of the world. A profiler measures the time around it.
    fn run_world_step(&mut self, step: &mut dyn FnMut()) {
        step();
    }

    /// Returns a function that wraps a Vulkan device for a profiler, if there is a profiler.
    fn vulkan_device_wrapper(&self) -> Option<fn(ash::Device) -> ash::Device> {
        None
    }

    /// Receives the state of the start whenever it changes. While the state isn't `Ready`, which includes the
    /// time in which a lost session is recreated, there is nothing to save.
    fn note_start_up(&mut self, _start: StartUp) {}

    /// Connects to the booth at which the device is enrolled; `None` if the booth can't be reached from this
    /// platform.
    fn open_booth_link(&mut self, _enrolment: &Enrolment) -> Option<CourierLink> {
        None
    }

    /// Re-enrols the device after the booth has forgotten it, if the platform can. Called repeatedly until
    /// the device is enrolled again.
    fn enrol_again(&mut self) {}

    /// Returns `true` once after the device has been enrolled.
    fn poll_enrolled(&mut self) -> bool {
        false
    }

    /// Returns the folder of the enrolment and the outbox, which others must not read. `sessions` is the
    /// folder of saved sessions.
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
    /// `true` if the application must quit.
    pub quit_requested: bool,
}

/// An operating system that reports no status and has the loader among its libraries: Linux.
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
