//! `paros enrol`: this machine becomes one of a booth's headsets.

use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::{Duration, Instant};

use paros_core::badge::Language;
use paros_core::outbox::messages::{DeviceHint, DeviceName};
use paros_headless::Error;
use paros_outbox_link::{HttpsCaller, fetch_shown_authority};
use paros_shell::durable::{self, WriteTarget};
use paros_shell::outbox::enrolment::{
    ByHandState, ENROL_TIMEOUT, EnrolError, Enrolment, FleetFile, HandEnrolment, NewDevice,
    check_address, enrol_by_fleet, enrolment_file, hint_of_device,
};
use paros_shell::studio_paths::StudioPaths;

/// The arguments of `paros enrol`.
#[derive(Debug, clap::Args)]
pub(super) struct Args {
    /// The booth's address. The staff compares four pictograms, which are printed, with those of its page.
    #[arg(value_name = "https://ADDRESS:PORT", required_unless_present = "fleet_file")]
    address: Option<String>,
    /// A fleet's file instead, as `paros-booth fleet-file` prints it: nobody needs to compare anything.
    #[arg(long, value_name = "FILE", conflicts_with = "address")]
    fleet_file: Option<PathBuf>,
    /// What the booth's page calls this machine, in up to 32 bytes; its host name if not given.
    #[arg(long, value_name = "NAME")]
    name: Option<String>,
    /// Where the enrolment is kept, instead of `enrolment.toml` beside the saved sessions (`booth_enrolment` of the
    /// settings).
    #[arg(long, value_name = "FILE")]
    file: Option<PathBuf>,
    /// Enrol anew, where there is an enrolment already.
    #[arg(long)]
    again: bool,
}

/// How often the staff's word is asked for.
const POLL: Duration = Duration::from_secs(2);

/// How long a booth may be gone while the staff's word is waited for.
const PATIENCE: Duration = Duration::from_secs(60);

pub(super) fn run(args: &Args) -> Result<String, Error> {
    let file = args.file.clone();
    let file = file.unwrap_or_else(|| enrolment_file(&StudioPaths::for_user(None).sessions));
    refuse_second_enrolment(&file, args.again)?;
    let name = args.name.clone().unwrap_or_else(read_host_name);
    let name = DeviceName::new(&name)
        .ok_or_else(|| Error::Input("--name: expected a name without control characters".into()))?;
    let device = NewDevice::draw(read_machine_hint(), name).map_err(|error| to_error(&error))?;
    // Tried before anything is asked: an enrolment that can't be kept is a headset too many at the booth.
    if let Some(folder) = file.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        durable::make_folder(folder)?;
    }
    WriteTarget::resolve_and_check_writable(&file)?;
    let enrolment = match (&args.fleet_file, &args.address) {
        (Some(fleet), _) => enrol_with_file(fleet, &device)?,
        (None, Some(address)) => enrol_by_hand(address, &device)?,
        (None, None) => return Err(Error::Input("expected an address or --fleet-file".into())),
    };
    enrolment.write(&file)?;
    let (headset, address) = (enrolment.owner.headset, &enrolment.address);
    Ok(format!("headset {headset} of {address}; kept in {}\n", file.display()))
}

fn refuse_second_enrolment(file: &Path, again: bool) -> Result<(), Error> {
    // One that can't be read isn't overwritten unasked either.
    let found = if again { Ok(None) } else { Enrolment::read(file) };
    let Some(found) = found.map_err(|error| to_error(&error))? else { return Ok(()) };
    let (file, headset, address) = (file.display(), found.owner.headset, found.address);
    Err(Error::Input(format!(
        "{file}: this machine is headset {headset} of {address}; --again enrols it anew"
    )))
}

fn enrol_with_file(fleet: &Path, device: &NewDevice) -> Result<Enrolment, Error> {
    let fleet = FleetFile::read(fleet).map_err(|error| to_error(&error))?;
    let mut link = HttpsCaller::new(&fleet.address, &fleet.ca, ENROL_TIMEOUT);
    enrol_by_fleet(&mut link, &fleet, device)
        .map_err(|error| Error::Failure(format!("{}: {error}", fleet.address)))
}

fn enrol_by_hand(address: &str, device: &NewDevice) -> Result<Enrolment, Error> {
    let expected = || Error::Input(format!("{address}: expected https:// and an address"));
    let address = check_address(address).ok_or_else(expected)?;
    let at = |error: EnrolError| Error::Failure(format!("{address}: {error}"));
    let ca = fetch_shown_authority(&address).map_err(|fault| at(EnrolError::Link(fault)))?;
    let mut link = HttpsCaller::new(&address, &ca, ENROL_TIMEOUT);
    let begun = HandEnrolment::begin(&mut link, (&address, &ca), device).map_err(at)?;
    let shown = begun.pictograms().map(|pictogram| pictogram.name(Language::English));
    // Told at once; standard output may be closed.
    let _ = writeln!(
        io::stdout(),
        "pictograms: {}\nAccept on the booth's page, or by `paros-booth accept`, if it shows the same ones.",
        shown.join(", ")
    );
    let mut heard = Instant::now();
    loop {
        match begun.poll(&mut link) {
            Ok(ByHandState::Accepted(enrolment)) => return Ok(*enrolment),
            Ok(ByHandState::Waiting) => heard = Instant::now(),
            Err(EnrolError::Link(_)) if heard.elapsed() < PATIENCE => {}
            Err(error) => return Err(at(error)),
        }
        thread::sleep(POLL);
    }
}

fn to_error(error: &EnrolError) -> Error {
    let text = error.to_string();
    if error.is_input() { Error::Input(text) } else { Error::Failure(text) }
}

fn read_host_name() -> String {
    let name = fs::read_to_string("/proc/sys/kernel/hostname").unwrap_or_default();
    name.trim().to_owned()
}

/// What this machine remembers itself by, without telling what its id is.
fn read_machine_hint() -> Option<DeviceHint> {
    let id = fs::read_to_string("/etc/machine-id").ok().filter(|id| !id.trim().is_empty())?;
    Some(hint_of_device(id.trim()))
}
