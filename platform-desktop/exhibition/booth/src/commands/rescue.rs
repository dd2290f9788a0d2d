//! Rescue: builds a new booth from the files of a booth whose database is lost.

use std::fs;
use std::path::Path;
use std::time::SystemTime;

use paros_booth_rules::{Booth, BoothPlan, BoothTime, KeptName, KeptPart, Refusal};
use paros_protocol::{Parcel, UploadFacts};
use paros_shell::durable::read_regular_file;

use crate::clock::{booth_time, booth_time_of};
use crate::commands::own_headset::enrol_own_headset;
use crate::commands::restore::{NewBooth, read_log};
use crate::commands::shared::SharedOptions;
use crate::error::Error;
use crate::models::parcel_decode::{check_parcel, unpack_volume};
use crate::server::app::OpenBooth;
use crate::store::disk_files::{kept_file_name, parse_kept_name};

/// The name of the headset that rescued sculptures are listed under: their files don't name the headset.
const HEADSET_NAME: &str = "Rescued";

/// Builds a booth in a new folder from the sculptures in the folder `lost`, which may lack its database and
/// keys. Doesn't change `lost`. Returns the report.
///
/// # Errors
/// [`Error::Input`] if the new folder isn't empty or no sculpture can be read; an I/O or database error. Then
/// the new folder isn't made.
pub(crate) fn rescue(lost: &Path, folder: &Path, plan: BoothPlan) -> Result<String, Error> {
    let files = list_sculptures(lost)?;
    let new = NewBooth::begin(folder)?;
    let deletions = read_log(lost)?;
    let shared = SharedOptions::default();
    let OpenBooth { booth, .. } = OpenBooth::open_or_make(new.path(), &shared, plan, u64::MAX)?;
    let headset = enrol_own_headset(&booth, (HEADSET_NAME, "rescue"), booth_time())?.headset;
    let (mut taken, mut report) = (0, String::new());
    for file in files {
        match take_file(&booth, headset, &lost.join("sculptures"), &file) {
            Ok(()) => taken += 1,
            Err(refusal) if refusal.is_failure() => return Err(refusal.into()),
            Err(refusal) => {
                let name = kept_file_name(&file.name);
                report += &format!("{name}: left out: {refusal}\n");
            }
        }
    }
    if taken == 0 {
        return Err(Error::Input(format!("{report}{}: no sculpture can be read", lost.display())));
    }
    // No badge is leased until all badges that may have been leased have rested.
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

/// The file of a sculpture in the folder of the lost booth.
struct SculptureFile {
    name: KeptName,
    /// The time at which the sculpture arrived.
    written_at: BoothTime,
}

/// Lists the files of sculptures in a booth's folder, sorted by name.
fn list_sculptures(lost: &Path) -> Result<Vec<SculptureFile>, Error> {
    let folder = lost.join("sculptures");
    let fail = |error| Error::Input(format!("{}: {error}", folder.display()));
    let mut files = Vec::new();
    for entry in fs::read_dir(&folder).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        let named = entry.file_name().to_str().and_then(parse_kept_name);
        let Some(name) = named.filter(|name| name.part == KeptPart::Sculpture) else { continue };
        let written = entry.metadata().and_then(|file| file.modified()).map_err(fail)?;
        let written_at = booth_time_of(written.min(SystemTime::now()));
        files.push(SculptureFile { name, written_at });
    }
    files.sort_by_key(|file| file.name);
    Ok(files)
}

/// Imports the parcel of a sculpture's file, without its trace if the trace file is missing.
fn take_file(
    booth: &Booth,
    headset: u32,
    folder: &Path,
    file: &SculptureFile,
) -> Result<(), Refusal> {
    let KeptName { id, hash, .. } = file.name;
    let read = |part| {
        let bytes = read_regular_file(&folder.join(kept_file_name(&KeptName { id, hash, part })));
        bytes.map_err(|error| Refusal::BadRequest(error.to_string()))
    };
    let sculpture = read(KeptPart::Sculpture)?;
    let bad = |fault: String| Refusal::Undecodable(fault);
    let (facts, packed) =
        UploadFacts::split_head(&sculpture).map_err(|fault| bad(fault.to_string()))?;
    let trace = match facts.trace_bytes {
        0 => Some(Vec::new()),
        _ => read(KeptPart::Trace).ok(),
    };
    let parcel = match trace {
        Some(trace) => [&sculpture[..], &trace, &hash.0].concat(),
        None => {
            let volume = unpack_volume(&facts, packed).map_err(bad)?;
            let parcel = Parcel::pack(&facts, &volume, None);
            parcel.map_err(|fault| bad(fault.to_string()))?.into_file()
        }
    };
    booth.take_parcel(headset, id, &parcel, &check_parcel, file.written_at).map(drop)
}
