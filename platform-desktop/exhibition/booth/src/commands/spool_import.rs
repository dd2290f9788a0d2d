//! Import of parcels that were copied by hand from a headset that is broken or can't reach the booth.

use std::fmt::Write as _;
use std::fs;
use std::io::{self, Write as _};
use std::path::Path;

use paros_booth_rules::{Booth, Expected, ImportOutcome, Refusal};
use paros_protocol::limits::MAX_PARCEL_FILE_BYTES;
use paros_protocol::{SculptureId, UploadStatus, parse_parcel_name};
use paros_shell::durable::read_regular_file_up_to;
use serde::Serialize;

use crate::clock::booth_time;
use crate::error::Error;
use crate::models::parcel_decode::check_parcel;

/// The outcomes of a folder's parcels, as `--json` prints them.
#[derive(Default, Serialize)]
struct ImportReport {
    taken: Vec<String>,
    known: Vec<String>,
    deleted: Vec<String>,
    refused: Vec<RefusedFile>,
}

/// A file that the booth refused.
#[derive(Serialize)]
struct RefusedFile {
    file: String,
    why: String,
}

/// Returns the sculpture of a parcel's file in an outbox, by the file's name.
///
/// # Errors
/// [`Expected::ParcelName`] for any other name, and for that of a damaged parcel.
pub(crate) fn read_parcel_name(name: &str) -> Result<SculptureId, Refusal> {
    let named = parse_parcel_name(name).filter(|(_, status)| *status != UploadStatus::Lost);
    named.map(|(id, _)| id).ok_or(Refusal::Unfit(Expected::ParcelName))
}

/// Imports the parcels in a folder as if the headset of this number had sent them. Doesn't change the folder.
/// Returns the outcomes, as text or as JSON.
///
/// # Errors
/// [`Error::Input`] if the folder has no parcels, no headset has the number, or files were refused; in the
/// last case the outcomes are printed first. An error of disk or store ends the import.
pub(crate) fn import_spool(
    booth: &Booth,
    folder: &Path,
    headset: u32,
    is_json: bool,
    account: &str,
) -> Result<String, Error> {
    booth.check_headset(headset).map_err(|refusal| match refusal {
        Refusal::NotFound(_) => Error::Input(format!("--headset {headset}: {refusal}")),
        refusal => refusal.into(),
    })?;
    let mut report = ImportReport::default();
    for (name, id) in list_parcels(folder)? {
        match import_file(booth, &folder.join(&name), headset, id, account) {
            Ok(ImportOutcome::Taken) => report.taken.push(name),
            Ok(ImportOutcome::Known) => report.known.push(name),
            Ok(ImportOutcome::Deleted) => report.deleted.push(name),
            Err(refusal) if refusal.is_failure() => return Err(refusal.into()),
            Err(refusal) => {
                report.refused.push(RefusedFile { file: name, why: refusal.to_string() });
            }
        }
    }
    let text = if is_json { report.to_json() } else { report.to_text() };
    if report.refused.is_empty() {
        return Ok(text);
    }
    // Standard output may be closed.
    let _ = io::stdout().write_all(text.as_bytes());
    let count = report.refused.len();
    Err(Error::Input(format!("{}: {count} files were not taken", folder.display())))
}

/// Lists the names of the parcels in a folder, sorted, with their sculptures.
fn list_parcels(folder: &Path) -> Result<Vec<(String, SculptureId)>, Error> {
    let bad = |why: &dyn std::fmt::Display| Error::Input(format!("{}: {why}", folder.display()));
    let entries = fs::read_dir(folder).and_then(Iterator::collect::<io::Result<Vec<_>>>);
    let names = entries.map_err(|error| bad(&error))?.into_iter();
    let names = names.filter_map(|entry| entry.file_name().into_string().ok());
    let named = |name: String| read_parcel_name(&name).ok().map(|id| (name, id));
    let mut parcels: Vec<_> = names.filter_map(named).collect();
    if parcels.is_empty() {
        return Err(bad(&"expected the folder of an outbox, with files ID.parcel or ID.sent"));
    }
    parcels.sort_by(|(a, _), (b, _)| a.cmp(b));
    Ok(parcels)
}

fn import_file(
    booth: &Booth,
    path: &Path,
    headset: u32,
    id: SculptureId,
    account: &str,
) -> Result<ImportOutcome, Refusal> {
    let file = read_regular_file_up_to(path, MAX_PARCEL_FILE_BYTES);
    // The copy can't be read. This isn't an error of the booth's own disk.
    let file = file.map_err(|error| Refusal::BadRequest(error.to_string()))?;
    booth.import_parcel(headset, (id, &file), &check_parcel, account, booth_time())
}

impl ImportReport {
    fn to_json(&self) -> String {
        // Serialising lists of text doesn't fail.
        serde_json::to_string(self).unwrap_or_default() + "\n"
    }

    /// Writes a line for each file that the booth didn't keep, and a summary.
    fn to_text(&self) -> String {
        let ImportReport { taken, known, deleted, refused } = self;
        let mut text = String::new();
        // Writing to a String doesn't fail.
        for RefusedFile { file, why } in refused {
            let _ = writeln!(text, "{file}: not taken: {why}");
        }
        for file in deleted {
            let _ = writeln!(text, "{file}: was deleted at the booth");
        }
        let [taken, known, deleted, refused] =
            [taken.len(), known.len(), deleted.len(), refused.len()];
        let _ = writeln!(
            text,
            "{taken} taken, {known} there already, {deleted} deleted before, {refused} not taken"
        );
        text
    }
}
