//! `paros enrol`: enrols this machine as one of a booth's headsets.

use std::fs;
use std::path::{Path, PathBuf};

use paros_headless::Error;
use paros_protocol::{DeviceHint, DeviceName};
use paros_shell::durable::{self, WriteTarget};
use paros_shell::studio_paths::StudioPaths;
use paros_upload::enrolment::{
    EnrolError, Enrolment, FleetFile, NewDevice, enrol_by_fleet, enrolment_file, hint_of_device,
};
use paros_upload_https::HttpsCaller;

/// The arguments of `paros enrol`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// Fleet file, as printed by `paros-booth fleet-file`.
    #[arg(long, value_name = "FILE")]
    fleet_file: PathBuf,
    /// Name of this machine on the booth's page, up to 32 bytes. By default the host name.
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// File for the enrolment, instead of `enrolment.toml` beside the saved sessions (setting
    /// `booth_enrolment`).
    #[arg(long, value_name = "FILE")]
    file: Option<PathBuf>,
    /// Enrol again, and replace an existing enrolment.
    #[arg(long)]
    again: bool,
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    let file = args.file.clone();
    let file = file.unwrap_or_else(|| enrolment_file(&StudioPaths::for_user(None).sessions));
    refuse_second_enrolment(&file, args.again)?;
    let name = args.name.clone().unwrap_or_else(read_host_name);
    let name = DeviceName::new(&name)
        .ok_or_else(|| Error::Input("--name: expected a name without control characters".into()))?;
    let device = NewDevice::draw(read_machine_hint(), name).map_err(|error| to_error(&error))?;
    // Check before the request: if the enrolment couldn't be stored, the booth would keep a headset that
    // doesn't exist.
    if let Some(folder) = file.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        durable::make_folder(folder)?;
    }
    WriteTarget::resolve_and_check_writable(&file)?;
    let enrolment = enrol_with_file(&args.fleet_file, &device)?;
    enrolment.write(&file)?;
    let (headset, address) = (enrolment.owner.headset, &enrolment.address);
    Ok(format!("headset {headset} of {address}; kept in {}\n", file.display()))
}

fn refuse_second_enrolment(file: &Path, again: bool) -> Result<(), Error> {
    // An enrolment that can't be read isn't overwritten without `--again` either.
    let found = if again { Ok(None) } else { Enrolment::read(file) };
    let Some(found) = found.map_err(|error| to_error(&error))? else { return Ok(()) };
    let (file, headset, address) = (file.display(), found.owner.headset, found.address);
    Err(Error::Input(format!(
        "{file}: this machine is headset {headset} of {address}; --again enrols it anew"
    )))
}

fn enrol_with_file(fleet: &Path, device: &NewDevice) -> Result<Enrolment, Error> {
    let fleet = FleetFile::read(fleet).map_err(|error| to_error(&error))?;
    let mut link = HttpsCaller::new(&fleet.address, &fleet.ca);
    enrol_by_fleet(&mut link, &fleet, device)
        .map_err(|error| Error::Failure(format!("{}: {error}", fleet.address)))
}

fn to_error(error: &EnrolError) -> Error {
    let text = error.to_string();
    if error.is_input() { Error::Input(text) } else { Error::Failure(text) }
}

fn read_host_name() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    name.trim().to_owned()
}

/// Returns a hint by which this machine recognises itself, without revealing its id.
fn read_machine_hint() -> Option<DeviceHint> {
    let id = fs::read_to_string("/etc/machine-id").ok().filter(|id| !id.trim().is_empty())?;
    Some(hint_of_device(id.trim()))
}
