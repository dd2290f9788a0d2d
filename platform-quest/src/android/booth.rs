//! Android's connection to a booth. Token, certificate and parcels lie in the app's internal folder, which no
//! other app can read.

use std::path::{Path, PathBuf};
use std::time::Instant;

use paros_protocol::{DeviceName, LinkTimes};
use paros_upload::courier::CourierLink;
use paros_upload::enrolment::{Enrolment, FleetFile, enrolment_file, hint_of_device};

use crate::device::AndroidDevice;
use crate::fleet::{AgainClock, Enroller, FleetSources, HeadsetNames, follow_fleet_file};
use crate::log::write_log_line;

/// The folder of the booth's data, and the thread that enrols the headset, if one runs.
pub(super) struct BoothWay {
    /// `None` if Android reports no internal folder: then nothing is sent.
    folder: Option<PathBuf>,
    enroller: Option<Enroller>,
    /// The sources of fleet files for a re-enrolment; `name` is the device's name.
    sources: FleetSources,
    name: String,
    again: AgainClock,
}

impl BoothWay {
    /// Creates a value without a folder: nothing is sent.
    pub(super) fn none() -> Self {
        let (sources, name, again) = (FleetSources::default(), String::new(), AgainClock::new());
        BoothWay { folder: None, enroller: None, sources, name, again }
    }

    /// Applies the first fleet file that is found, for a device of this name, and starts to enrol if
    /// necessary. Errors are logged.
    pub(super) fn open(device: &AndroidDevice, sources: FleetSources, name: &str) -> Self {
        let private = device.find_private_folder();
        let private = private.map_err(|why| write_log_line(format_args!("{why}"))).ok();
        let fleet = sources.find(write_log_line);
        let enroller = private.as_ref().zip(fleet).and_then(|(private, fleet)| {
            let file = enrolment_file(private);
            let is_due = follow_fleet_file(&file, &fleet, write_log_line).unwrap_or_else(|why| {
                write_log_line(format_args!("{why}"));
                false
            });
            if is_due { start_enroller(device, &sources, &file, name) } else { None }
        });
        let (name, again) = (name.to_owned(), AgainClock::new());
        BoothWay { folder: private, enroller, sources, name, again }
    }

    /// See [`Platform::enrol_again`](crate::platform::Platform::enrol_again).
    pub(super) fn enrol_again(&mut self, device: &AndroidDevice) {
        // A running thread finds a new file by itself.
        if let Some(private) = &self.folder
            && !self.enroller.as_ref().is_some_and(Enroller::is_asking)
            && self.again.take(Instant::now())
        {
            write_log_line(format_args!(
                "the booth has forgotten this headset: it enrols anew, by a fleet's file"
            ));
            self.enroller =
                start_enroller(device, &self.sources, &enrolment_file(private), &self.name);
        }
    }

    /// See [`Platform::poll_enrolled`](crate::platform::Platform::poll_enrolled).
    pub(super) fn poll_enrolled(&mut self) -> bool {
        self.enroller.as_mut().is_some_and(Enroller::poll_enrolled)
    }

    /// See [`Platform::booth_folder`](crate::platform::Platform::booth_folder).
    pub(super) fn folder(&self, sessions: &Path) -> PathBuf {
        self.folder.clone().unwrap_or_else(|| sessions.to_owned())
    }

    /// See [`Platform::open_booth_link`](crate::platform::Platform::open_booth_link).
    pub(super) fn open_link(
        &self,
        device: &AndroidDevice,
        enrolment: &Enrolment,
    ) -> Option<CourierLink> {
        self.folder.as_ref()?;
        let link = device.open_booth_link(&enrolment.booth_address(), LinkTimes::default());
        Some(Box::new(link.with_log(write_log_line)))
    }
}

fn start_enroller(
    device: &AndroidDevice,
    sources: &FleetSources,
    file: &Path,
    name: &str,
) -> Option<Enroller> {
    let id = device.read_android_id().unwrap_or_else(|why| {
        write_log_line(format_args!("{why}"));
        None
    });
    let names = HeadsetNames {
        hint: id.as_deref().map(hint_of_device),
        name: DeviceName::new(name).or_else(|| DeviceName::new("headset"))?,
    };
    let connect = device.booth_connector();
    let connect = move |fleet: &FleetFile| connect(&fleet.address, &fleet.ca);
    let enroller = Enroller::spawn(sources.clone(), connect, names, file.to_owned());
    enroller.map_err(|why| write_log_line(format_args!("{why}"))).ok()
}
