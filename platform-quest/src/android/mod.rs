//! Android's side of the shell: the activity's entry point and events, and the implementation of
//! [`Platform`].

mod booth;
mod replay;

// The unwinder that `std` links to. Android's own is part of the NDK only.
extern crate unwinding as _;

use std::ffi::CString;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use android_activity::{AndroidApp, InputStatus, MainEvent, PollEvent, WindowManagerFlags};
use openxr as xr;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_headset::runtime::{PARTITIONS, list_candidates};
use paros_headset::start_up::{StartUp, may_leave_destroyed};
use paros_shell::headset::package::{self, OPENXR_LOADER};
use paros_shell::last_use::BootId;
use paros_shell::settings::{self, FLEET_FILE_KEY, LoadedSettings, SettingsLayer};
use paros_shell::sizes::GRID_SIDES;
use paros_shell::statics::Resident;
use paros_shell::studio_paths::StudioPaths;
use paros_shell::with_size;
use paros_upload::courier::CourierLink;
use paros_upload::enrolment::Enrolment;

use crate::device::{self, AndroidDevice, DeviceMonitor, ManagedEntry};
use crate::error::Error;
use crate::fleet::FleetSources;
use crate::log::{open_log_file, write_log_line};
use crate::options::ShellOptions;
use crate::platform::{Platform, PlatformStatus};
use crate::runtime::{AndroidContext, LinkedCalls, find_runtime_once};
use crate::shell::{run_shell, show_failed_start};
use booth::BoothWay;

/// The interval at which the end of the shell is checked while no event arrives.
const POLL_TIMEOUT: Duration = Duration::from_millis(50);

/// The application of the first activity, which was passed to the OpenXR runtime.
static KEPT_APP: OnceLock<AndroidApp> = OnceLock::new();

/// The activity's main function. It only polls the activity's events, as Java's callbacks wait for it.
/// Anything slow (files, a driver, a runtime) runs on the shell's thread.
#[unsafe(no_mangle)]
fn android_main(app: AndroidApp) {
    app.set_window_flags(WindowManagerFlags::KEEP_SCREEN_ON, WindowManagerFlags::empty());
    let activity = Arc::new(ActivityState::default());
    let (its_app, its_activity) = (app.clone(), Arc::clone(&activity));
    let shell = thread::Builder::new().name("shell".into()).spawn(move || {
        let waker = its_app.create_waker();
        // Standard error goes to the device's log.
        if let Err(why) = run_app(its_app, its_activity) {
            write_log_line(format_args!("{}", why.message_with_remedy()));
        }
        waker.wake();
    });
    match shell {
        Ok(shell) => activity.poll_until_over(&app, &shell),
        Err(why) => write_log_line(format_args!("no thread for the shell: {why}")),
    }
}

/// The state shared by the activity's thread and the shell's.
#[derive(Default)]
struct ActivityState {
    is_destroyed: AtomicBool,
    /// `true` while there is a studio that must be saved before the activity ends.
    has_studio: AtomicBool,
}

impl ActivityState {
    /// Polls the activity's events until the shell has ended, or the activity is destroyed and there is
    /// nothing to save. The shell may then run for as long as a driver call takes; the shell of the next
    /// activity waits for it.
    fn poll_until_over(&self, app: &AndroidApp, shell: &JoinHandle<()>) {
        let mut destroyed_at: Option<Instant> = None;
        loop {
            app.poll_events(Some(POLL_TIMEOUT), |event| {
                if matches!(event, PollEvent::Main(MainEvent::Destroy)) {
                    destroyed_at.get_or_insert_with(Instant::now);
                    self.is_destroyed.store(true, Ordering::Release);
                }
            });
            drain_input(app);
            let (has_studio, has_ended) =
                (self.has_studio.load(Ordering::Acquire), shell.is_finished());
            let may_leave =
                destroyed_at.map(|at| may_leave_destroyed(at.elapsed(), has_studio, has_ended));
            if may_leave.unwrap_or(has_ended) {
                return;
            }
        }
    }
}

fn run_app(app: AndroidApp, activity: Arc<ActivityState>) -> Result<(), Error> {
    let unavailable = |error: device::JavaError| Error::Unavailable(error.to_string());
    // SAFETY: the application holds the machine and its own reference to the activity.
    let device = unsafe { AndroidDevice::from_raw(app.vm_as_ptr(), app.activity_as_ptr()) };
    let device = device.map_err(unavailable)?;
    let folder = match device.find_storage_folder() {
        Ok(folder) => folder,
        Err(why) => {
            let error = unavailable(why);
            let monitor = DeviceMonitor::start_polling(device);
            let way = BoothWay::none();
            let mut platform = AndroidPlatform { app, monitor, activity, way };
            show_failed_start(&mut platform, &ShellOptions::default(), &error);
            return Err(error);
        }
    };
    open_log_file(&StudioPaths::inside_folder(&folder).log_file());
    let name = device.read_manufacturer_and_model().unwrap_or_else(|why| {
        write_log_line(format_args!("{why}"));
        "headset".into()
    });
    let level = device.api_level();
    write_log_line(format_args!("{name}, API level {level}, {}", folder.display()));
    let own_figures = read_own_figure_names(&app);
    let managed = device.read_managed_configuration().unwrap_or_else(|why| {
        write_log_line(format_args!("{why}; the managed configuration is left out"));
        Vec::new()
    });
    // The fleet file is not a setting.
    let (fleet, managed): (Vec<_>, Vec<_>) =
        managed.into_iter().partition(|entry| entry.key == FLEET_FILE_KEY);
    let loaded = load_settings(&app, &folder, &managed, &own_figures);
    for line in loaded.log_lines() {
        write_log_line(format_args!("{line}"));
    }
    let size = loaded.settings.size.unwrap_or(GRID_SIDES[0]);
    let sources = FleetSources {
        managed: fleet.into_iter().next().map(|entry| entry.value),
        folder: folder.clone(),
        baked: open_asset(&app, package::FLEET_ASSET),
    };
    let way = BoothWay::open(&device, sources, &name);
    let mut options =
        ShellOptions { folder: Some(folder), ..ShellOptions::from_settings(&loaded.settings) };
    // The token always lies in the internal folder, whatever a setting says.
    options.booth.enrolment = None;
    let monitor = DeviceMonitor::start_polling(device);
    let platform = AndroidPlatform { app, monitor, activity, way };
    with_size!(size, N => run_with_size::<N>(platform, &options, &own_figures))
}

/// Loads the settings from the package, from a file in the sessions' folder, and from the managed
/// configuration.
fn load_settings(
    app: &AndroidApp,
    folder: &Path,
    managed: &[ManagedEntry],
    own_figures: &[String],
) -> LoadedSettings {
    let baked = open_asset(app, package::SETTINGS_ASSET)
        .map(|bytes| SettingsLayer::parse_bytes("the package", &bytes, own_figures));
    let file = SettingsLayer::read_file(&folder.join(settings::FILE_NAME), own_figures);
    let managed = (!managed.is_empty()).then(|| {
        let texts = managed.iter().map(|entry| (&*entry.key, &*entry.value));
        SettingsLayer::from_texts("managed configuration", texts, own_figures)
    });
    let layers: Vec<_> = baked.into_iter().chain(file).chain(managed).collect();
    let mut loaded = LoadedSettings::merge(&layers);
    loaded.resolve_record(folder, own_figures);
    loaded
}

/// Reads the names of the operator's own figures in the package. An invalid list is logged and ignored.
fn read_own_figure_names(app: &AndroidApp) -> Vec<String> {
    package::read_own_figure_names(|name| open_asset(app, name)).unwrap_or_else(|why| {
        write_log_line(format_args!("{why}; there are no figures of one's own"));
        Vec::new()
    })
}

/// Reads an asset of the package; `None` if it is missing.
fn open_asset(app: &AndroidApp, name: &str) -> Option<Vec<u8>> {
    let mut asset = app.asset_manager().open(&CString::new(name).ok()?)?;
    Some(asset.buffer().ok()?.to_vec())
}

fn run_with_size<const N: usize>(
    mut platform: AndroidPlatform,
    options: &ShellOptions,
    own_figures: &[String],
) -> Result<(), Error>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    load_start_volumes::<N>(&platform.app, own_figures);
    run_shell::<N>(&mut platform, options).map(drop)
}

/// Loads the start volumes and the operator's own figures from the package's assets. Missing start volumes
/// are computed. Without their figure, sessions of an own figure don't start.
fn load_start_volumes<const N: usize>(app: &AndroidApp, own_figures: &[String])
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let open = |name: &str| open_asset(app, name);
    let volumes = &mut Grid::<N>::lock_world().start_volumes;
    if volumes.has_volumes() {
        // An earlier activity of this process has loaded them.
        return;
    }
    if let Err(why) = package::load_start_volumes(volumes, open) {
        write_log_line(format_args!("{why}; the volumes are made"));
    }
    if let Err(why) = package::load_own_figures(own_figures, volumes, open) {
        write_log_line(format_args!("{why}; there are no figures of one's own"));
    }
}

/// The platform of a `NativeActivity`.
struct AndroidPlatform {
    app: AndroidApp,
    monitor: DeviceMonitor,
    activity: Arc<ActivityState>,
    way: BoothWay,
}

impl AndroidPlatform {
    fn platform_info(&self) -> xr::AndroidPlatformInfo {
        // SAFETY: the application holds both, and this holds the application.
        unsafe { xr::AndroidPlatformInfo::new(self.app.vm_as_ptr(), self.app.activity_as_ptr()) }
    }
}

impl Platform for AndroidPlatform {
    fn load_openxr(&mut self) -> Result<xr::Entry, Error> {
        // A runtime receives the activity once in a process, and may use it again later.
        let kept = KEPT_APP.get_or_init(|| self.app.clone());
        let (vm, activity) = (kept.vm_as_ptr(), kept.activity_as_ptr());
        // SAFETY: the application holds both, and is kept. The loader comes with the package; brokers and manifest files are part of the system, or were installed in its place.
        let mut calls = unsafe { LinkedCalls::new(Some(AndroidContext { vm, activity })) };
        let query = |table: &str, columns: &[&str]| {
            let rows = self.monitor.device().query_first_content_rows(table, columns);
            rows.map_err(|error| error.to_string())
        };
        let candidates = list_candidates(Path::new(OPENXR_LOADER), query, &PARTITIONS);
        let found = find_runtime_once(&mut calls, candidates);
        let found = found.map_err(|error| Error::Unavailable(error.to_string()))?;
        for tried in found.tried {
            self.log(format_args!("{tried}"));
        }
        Ok(found.entry)
    }

    fn create_instance(
        &mut self,
        entry: &xr::Entry,
        application: &xr::ApplicationInfo<'_>,
        mut extensions: xr::ExtensionSet,
    ) -> xr::Result<xr::Instance> {
        extensions.khr_android_create_instance = true;
        entry.create_instance(application, &extensions, &[], &self.platform_info())
    }

    fn boot_id(&self) -> Option<BootId> {
        let count = self.monitor.device().read_boot_count().unwrap_or_else(|why| {
            write_log_line(format_args!("{why}"));
            None
        });
        // The kernel's own boot ID is not a documented interface of Android.
        count.map(BootId::from_count).or_else(BootId::read_from_kernel)
    }

    fn poll_status(&mut self) -> PlatformStatus {
        let quit_requested = self.activity.is_destroyed.load(Ordering::Acquire);
        PlatformStatus { health: self.monitor.latest(), quit_requested }
    }

    fn open_booth_link(&mut self, enrolment: &Enrolment) -> Option<CourierLink> {
        self.way.open_link(self.monitor.device(), enrolment)
    }

    fn enrol_again(&mut self) {
        self.way.enrol_again(self.monitor.device());
    }

    fn poll_enrolled(&mut self) -> bool {
        self.way.poll_enrolled()
    }

    fn booth_folder(&self, sessions: &Path) -> PathBuf {
        self.way.folder(sessions)
    }

    fn note_start_up(&mut self, start: StartUp) {
        self.activity.has_studio.store(start == StartUp::Ready, Ordering::Release);
    }
}

/// Drains the activity's input queue. Input comes through OpenXR, but Android kills a process that leaves a
/// volume key unread for five seconds.
fn drain_input(app: &AndroidApp) {
    if let Ok(mut events) = app.input_events_iter() {
        while events.next(|_| InputStatus::Unhandled) {}
    }
}
