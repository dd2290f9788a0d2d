//! The names of parcels' files in a headset's spool.

use crate::{SculptureId, UploadStatus};

/// Returns the end of the name of a file in this status; `None` if there is no file.
const fn extension(status: UploadStatus) -> Option<&'static str> {
    match status {
        UploadStatus::Kept => Some("parcel"),
        UploadStatus::Refused => Some("refused"),
        UploadStatus::Sent => Some("sent"),
        UploadStatus::Lost => Some("damaged"),
        UploadStatus::Making | UploadStatus::Waiting => None,
    }
}

/// Returns the name of a sculpture's file; empty for a status without one.
#[must_use]
pub fn parcel_name(id: SculptureId, status: UploadStatus) -> String {
    extension(status).map(|extension| format!("{id}.{extension}")).unwrap_or_default()
}

/// Reads the sculpture and the status that a file's name has. Returns `None` for another name.
#[must_use]
pub fn parse_parcel_name(name: &str) -> Option<(SculptureId, UploadStatus)> {
    let (id, end) = name.split_once('.')?;
    let is_it = |status: &UploadStatus| extension(*status) == Some(end);
    let status = UploadStatus::ALL.into_iter().find(is_it)?;
    let id = SculptureId::parse_hex(id).filter(|known| known.to_string() == id)?;
    Some((id, status))
}
