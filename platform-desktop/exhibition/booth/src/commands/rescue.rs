//! A booth made of the files of another one whose database is lost.

use std::ffi::OsStr;
use std::fs;
use std::path::Path;
use std::time::SystemTime;

use paros_booth_rules::{Booth, BoothPlan, BoothTime, Refusal};
use paros_protocol::{
    ContentHash, DeviceHint, DeviceName, DeviceToken, EnrolmentToken, FleetEnrolment, Parcel,
    SculptureId, UploadFacts,
};
use paros_shell::durable::read_regular_file;

use crate::clock::{booth_time, booth_time_of};
use crate::commands::restore::{NewBooth, read_log};
use crate::commands::shared::SharedOptions;
use crate::error::Error;
use crate::models::parcel_decode::{check_parcel, unpack_volume};
use crate::random::random_bytes;
use crate::server::app::OpenBooth;

/// The name of the headset that rescued sculptures are listed under: their files don't name the headset.
const HEADSET_NAME: &str = "Rescued";

/// Makes a booth in a new folder of the sculptures in another booth's folder, which may lack its database and keys. Changes
/// nothing there. Returns the report.
///
/// # Errors
/// [`Error::Input`] if the new folder isn't empty or no sculpture can be read; an I/O or database error. Then there is no
/// new folder.
pub(crate) fn rescue(lost: &Path, folder: &Path, plan: BoothPlan) -> Result<String, Error> {
    let files = list_sculptures(lost)?;
    let new = NewBooth::begin(folder)?;
    let deletions = read_log(lost)?;
    let shared = SharedOptions::default();
    let OpenBooth { booth, .. } = OpenBooth::open_or_make(new.path(), &shared, plan, u64::MAX)?;
    let headset = add_headset(&booth)?;
    let (mut taken, mut report) = (0, String::new());
    for file in files {
        match take_file(&booth, headset, &lost.join("sculptures"), &file) {
            Ok(()) => taken += 1,
            Err(refusal) if refusal.is_failure() => return Err(refusal.into()),
            Err(refusal) => report += &format!("{}: left out: {refusal}\n", file.name),
        }
    }
    if taken == 0 {
        return Err(Error::Input(format!("{report}{}: no sculpture can be read", lost.display())));
    }
    // No badge is leased until all that may have been leased has rested.
    let restored = booth.make_restored(&deletions, BoothTime(0), booth_time())?;
    drop(booth);
    new.finish()?;
    let kept = taken - restored.deleted;
    let folder = folder.display();
    Ok(format!(
        "{report}{folder}: {kept} sculptures\n\
         This is a new site: make a fleet's file (paros-booth fleet-file --folder {folder}), and give it to all headsets.\n\
         Badges are drawn at random, in black, for ten days. Sculptures are found by their badges as before.\n"
    ))
}

/// The file of a sculpture in a booth's folder.
struct SculptureFile {
    name: String,
    id: SculptureId,
    hash: ContentHash,
    /// The time at which the sculpture arrived.
    written_at: BoothTime,
}

/// Lists the sculptures' files of a booth's folder, sorted by name.
fn list_sculptures(lost: &Path) -> Result<Vec<SculptureFile>, Error> {
    let folder = lost.join("sculptures");
    let fail = |error| Error::Input(format!("{}: {error}", folder.display()));
    let mut files = Vec::new();
    for entry in fs::read_dir(&folder).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        let named = entry.file_name().to_str().and_then(parse_name);
        let Some((name, id, hash)) = named else { continue };
        let written = entry.metadata().and_then(|file| file.modified()).map_err(fail)?;
        let written_at = booth_time_of(written.min(SystemTime::now()));
        files.push(SculptureFile { name, id, hash, written_at });
    }
    files.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(files)
}

/// Reads the name of a sculpture's file: `ID-HASH.sculpture`.
fn parse_name(name: &str) -> Option<(String, SculptureId, ContentHash)> {
    let (id, hash) = name.strip_suffix(".sculpture")?.split_once('-')?;
    Some((name.to_owned(), SculptureId::parse_hex(id)?, ContentHash::parse_hex(hash)?))
}

fn add_headset(booth: &Booth) -> Result<u32, Refusal> {
    let (fleet, token) = (EnrolmentToken(random_bytes()?), DeviceToken(random_bytes()?));
    let now = booth_time();
    booth.add_enrol_token(
        &fleet,
        (1, BoothTime(now.0.saturating_add(60_000))),
        "rescue",
        None,
        now,
    )?;
    let enrolment = FleetEnrolment {
        enrolment_token: fleet,
        token_hash: ContentHash::of(&token.0),
        hint: DeviceHint(random_bytes()?),
        name: DeviceName::new(HEADSET_NAME)
            .ok_or_else(|| Refusal::BadRequest("expected a headset's name".into()))?,
    };
    Ok(booth.enrol_fleet(&enrolment, now)?.headset)
}

/// Takes the parcel that a sculpture came in; without its trace if that is gone.
fn take_file(
    booth: &Booth,
    headset: u32,
    folder: &Path,
    file: &SculptureFile,
) -> Result<(), Refusal> {
    let read = |name: &OsStr| {
        let bytes = read_regular_file(&folder.join(name));
        bytes.map_err(|error| Refusal::BadRequest(error.to_string()))
    };
    let sculpture = read(file.name.as_ref())?;
    let bad = |fault: String| Refusal::Undecodable(fault);
    let (facts, packed) =
        UploadFacts::split_head(&sculpture).map_err(|fault| bad(fault.to_string()))?;
    let trace = match facts.trace_bytes {
        0 => Some(Vec::new()),
        _ => read(Path::new(&file.name).with_extension("trace").as_os_str()).ok(),
    };
    let parcel = match trace {
        Some(trace) => [&sculpture[..], &trace, &file.hash.0].concat(),
        None => {
            let volume = unpack_volume(&facts, packed).map_err(bad)?;
            let parcel = Parcel::pack(&facts, &volume, None);
            parcel.map_err(|fault| bad(fault.to_string()))?.into_file()
        }
    };
    booth.take_parcel(headset, file.id, &parcel, &check_parcel, file.written_at).map(drop)
}
