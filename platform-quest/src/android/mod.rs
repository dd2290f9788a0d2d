//! Android's side of the shell: the activity's entry point and events, and what [`Host`] asks for.

mod replay;

// What `std` unwinds with. Android's own is in the NDK alone.
extern crate unwinding as _;

use std::ffi::CString;
use std::path::Path;
use std::time::Duration;

use android_activity::{AndroidApp, InputStatus, MainEvent, PollEvent, WindowManagerFlags};
use openxr as xr;
use paros_core::size::{Grid, Size};
use paros_shell::statics::Resident;

use crate::device::{self, Device, Watch};
use crate::error::Error;
use crate::host::{Host, Told};
use crate::options::Options;
use crate::{runtime, settings, shell, starts};

#[unsafe(no_mangle)]
fn android_main(app: AndroidApp) {
    app.set_window_flags(WindowManagerFlags::KEEP_SCREEN_ON, WindowManagerFlags::empty());
    // What is written to standard error goes to the device's log.
    if let Err(why) = sculpt(app) {
        eprintln!("paros-quest: {}", why.with_remedy());
    }
}

fn sculpt(app: AndroidApp) -> Result<(), Error> {
    let unavailable = |error: device::Error| Error::Unavailable(error.to_string());
    // SAFETY: the activity glue holds the machine and the activity until `android_main` returns.
    let device = unsafe { Device::new(app.vm_as_ptr(), app.activity_as_ptr()) };
    let device = device.map_err(unavailable)?;
    let folder = device.storage().map_err(unavailable)?;
    let name = device.name().map_err(unavailable)?;
    eprintln!("paros-quest: {name}, API level {}, {}", device.level(), folder.display());
    let (settings, line) = settings::read(&folder);
    if let Some(line) = line {
        eprintln!("paros-quest: {line}");
    }
    let headset = Headset { app, watch: Watch::new(device), leave: false };
    match settings.size {
        256 => run::<256>(headset, &settings.options),
        _ => run::<128>(headset, &settings.options),
    }
}

fn run<const N: usize>(mut headset: Headset, options: &Options) -> Result<(), Error>
where
    Grid<N>: Size + Resident<N>,
{
    take_starts::<N>(&headset.app);
    shell::run::<N>(&mut headset, options).map(drop)
}

/// Takes the start volumes out of the package. If they are not in it, they are made.
fn take_starts<const N: usize>(app: &AndroidApp)
where
    Grid<N>: Size + Resident<N>,
{
    let assets = app.asset_manager();
    let open = |name: &str| {
        let mut asset = assets.open(&CString::new(name).ok()?)?;
        Some(asset.buffer().ok()?.to_vec())
    };
    if let Err(why) = starts::load(&mut Grid::<N>::start_volumes(), open) {
        eprintln!("paros-quest: {why}; the volumes are made");
    }
}

/// The headset, by its activity.
struct Headset {
    app: AndroidApp,
    watch: Watch,
    leave: bool,
}

impl Headset {
    fn platform(&self) -> xr::AndroidPlatformInfo {
        // SAFETY: the activity glue holds both until `android_main` returns, and so after this.
        unsafe { xr::AndroidPlatformInfo::new(self.app.vm_as_ptr(), self.app.activity_as_ptr()) }
    }
}

impl Host for Headset {
    fn entry(&mut self) -> Result<xr::Entry, Error> {
        let broker = || runtime::ask(|table, columns| self.watch.device().query(table, columns));
        // SAFETY: the loader comes with the package; the broker is part of the system, or was
        // installed in its place.
        let found = unsafe { runtime::find(Path::new(runtime::LOADER), &self.platform(), broker) };
        found.map_err(|error| Error::Unavailable(error.to_string()))
    }

    fn instance(
        &mut self,
        entry: &xr::Entry,
        application: &xr::ApplicationInfo<'_>,
        mut extensions: xr::ExtensionSet,
    ) -> xr::Result<xr::Instance> {
        extensions.khr_android_create_instance = true;
        entry.create_instance(application, &extensions, &[], &self.platform())
    }

    fn told(&mut self) -> Told {
        let leave = &mut self.leave;
        self.app.poll_events(Some(Duration::ZERO), |event| {
            *leave |= matches!(event, PollEvent::Main(MainEvent::Destroy));
        });
        drain(&self.app);
        Told { strain: self.watch.strain(), leave: self.leave }
    }
}

/// Reads the activity's input queue empty. The hands come through OpenXR; but a volume key that
/// nobody reads ends the process after five seconds.
fn drain(app: &AndroidApp) {
    if let Ok(mut events) = app.input_events_iter() {
        while events.next(|_| InputStatus::Unhandled) {}
    }
}
