//! Android's side of the shell: the activity's entry point and events, and what [`Platform`] needs.

mod replay;

// The unwinder that `std` links to. Android's own is part of the NDK only.
extern crate unwinding as _;

use std::ffi::CString;
use std::path::Path;
use std::time::Duration;

use android_activity::{AndroidApp, InputStatus, MainEvent, PollEvent, WindowManagerFlags};
use openxr as xr;
use paros_core::limits::INTERVALS;
use paros_core::volume::{Grid, Size};
use paros_shell::headset::package::{self, OPENXR_LOADER};
use paros_shell::headset::visit::BootId;
use paros_shell::settings::{self, LoadedSettings, SettingsLayer};
use paros_shell::sizes::GRID_SIDES;
use paros_shell::statics::Resident;
use paros_shell::with_size;

use crate::boot_clock;
use crate::device::{self, AndroidDevice, DeviceMonitor, ManagedEntry};
use crate::error::Error;
use crate::options::ShellOptions;
use crate::platform::{Platform, PlatformStatus};
use crate::runtime;
use crate::runtime::{AndroidContext, LinkedCalls, PARTITIONS};
use crate::shell::run_shell;

#[unsafe(no_mangle)]
fn android_main(app: AndroidApp) {
    app.set_window_flags(WindowManagerFlags::KEEP_SCREEN_ON, WindowManagerFlags::empty());
    // What is written to standard error goes to the device's log.
    if let Err(why) = run_app(app) {
        eprintln!("paros-quest: {}", why.message_with_remedy());
    }
}

fn run_app(app: AndroidApp) -> Result<(), Error> {
    let unavailable = |error: device::JavaError| Error::Unavailable(error.to_string());
    // SAFETY: the activity glue holds the machine and the activity until `android_main` returns.
    let device = unsafe { AndroidDevice::from_raw(app.vm_as_ptr(), app.activity_as_ptr()) };
    let device = device.map_err(unavailable)?;
    let folder = device.find_storage_folder().map_err(unavailable)?;
    let name = device.read_manufacturer_and_model().map_err(unavailable)?;
    eprintln!("paros-quest: {name}, API level {}, {}", device.api_level(), folder.display());
    let own_figures = read_own_figure_names(&app);
    let managed = device.read_managed_configuration().unwrap_or_else(|why| {
        eprintln!("paros-quest: {why}; the managed configuration is left out");
        Vec::new()
    });
    let loaded = load_settings(&app, &folder, &managed, &own_figures);
    for line in loaded.log_lines() {
        eprintln!("paros-quest: {line}");
    }
    let size = loaded.settings.size.unwrap_or(GRID_SIDES[0]);
    let options =
        ShellOptions { folder: Some(folder), ..ShellOptions::from_settings(&loaded.settings) };
    let platform =
        AndroidPlatform { app, monitor: DeviceMonitor::start_polling(device), destroyed: false };
    with_size!(size, N => run_with_size::<N>(platform, &options, &own_figures))
}

/// Loads the settings: the package's, those of a file in the folder of the sessions, and the managed ones.
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

/// The names of the operator's own figures in the package. A list that is none counts for nothing.
fn read_own_figure_names(app: &AndroidApp) -> Vec<String> {
    package::read_own_figure_names(|name| open_asset(app, name)).unwrap_or_else(|why| {
        eprintln!("paros-quest: {why}; there are no figures of one's own");
        Vec::new()
    })
}

/// The bytes of an asset of the package.
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

/// Loads the start volumes and the operator's own figures from the package's assets. Start volumes that are missing
/// are computed; without figures of their own, sessions of these don't start.
fn load_start_volumes<const N: usize>(app: &AndroidApp, own_figures: &[String])
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let open = |name: &str| open_asset(app, name);
    let mut volumes = Grid::<N>::lock_start_volumes();
    if let Err(why) = package::load_start_volumes(&mut volumes, open) {
        eprintln!("paros-quest: {why}; the volumes are made");
    }
    if let Err(why) = package::load_own_figures(own_figures, &mut volumes, open) {
        eprintln!("paros-quest: {why}; there are no figures of one's own");
    }
}

/// The platform of a `NativeActivity`.
struct AndroidPlatform {
    app: AndroidApp,
    monitor: DeviceMonitor,
    destroyed: bool,
}

impl AndroidPlatform {
    fn platform_info(&self) -> xr::AndroidPlatformInfo {
        // SAFETY: the activity glue holds both until `android_main` returns, and so after this.
        unsafe { xr::AndroidPlatformInfo::new(self.app.vm_as_ptr(), self.app.activity_as_ptr()) }
    }
}

impl Platform for AndroidPlatform {
    fn load_openxr(&mut self) -> Result<xr::Entry, Error> {
        let (vm, activity) = (self.app.vm_as_ptr(), self.app.activity_as_ptr());
        // SAFETY: the activity glue holds both until `android_main` returns. The loader comes with the
        // package; brokers and manifest files are part of the system, or were installed in its place.
        let mut calls = unsafe { LinkedCalls::new(Some(AndroidContext { vm, activity })) };
        let query = |table: &str, columns: &[&str]| {
            self.monitor.device().query_first_content_rows(table, columns)
        };
        let candidates = runtime::list_candidates(Path::new(OPENXR_LOADER), query, &PARTITIONS);
        let found = runtime::find_runtime_once(&mut calls, candidates);
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
            eprintln!("paros-quest: {why}");
            None
        });
        // The kernel's own ID is no documented interface of Android's.
        count.map(BootId::from_count).or_else(boot_clock::read_boot_id)
    }

    fn poll_status(&mut self) -> PlatformStatus {
        let destroyed = &mut self.destroyed;
        self.app.poll_events(Some(Duration::ZERO), |event| {
            *destroyed |= matches!(event, PollEvent::Main(MainEvent::Destroy));
        });
        drain_input(&self.app);
        PlatformStatus { health: self.monitor.latest(), quit_requested: self.destroyed }
    }
}

/// Drains the activity's input queue. Input comes through OpenXR; but Android ends a process that leaves a
/// volume key unread for five seconds.
fn drain_input(app: &AndroidApp) {
    if let Ok(mut events) = app.input_events_iter() {
        while events.next(|_| InputStatus::Unhandled) {}
    }
}
