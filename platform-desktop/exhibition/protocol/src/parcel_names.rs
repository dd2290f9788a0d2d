//! The file names of parcels in a headset's spool.

use crate::{SculptureId, UploadStatus};

/// Returns the file extension for a status; `None` if the status has no file.
const fn extension(status: UploadStatus) -> Option<&'static str> {
    match status {
        UploadStatus::Kept => Some("parcel"),
        UploadStatus::Refused => Some("refused"),
        UploadStatus::Sent => Some("sent"),
        UploadStatus::Lost => Some("damaged"),
        UploadStatus::Making | UploadStatus::Waiting => None,
    }
}

/// Returns the file name of a sculpture; empty for a status without a file.
#[must_use]
pub fn parcel_name(id: SculptureId, status: UploadStatus) -> String {
    extension(status).map(|extension| format!("{id}.{extension}")).unwrap_or_default()
}

/// Parses a file name into sculpture and status. Returns `None` for any other name.
#[must_use]
pub fn parse_parcel_name(name: &str) -> Option<(SculptureId, UploadStatus)> {
    let (id, end) = name.split_once('.')?;
    let is_it = |status: &UploadStatus| extension(*status) == Some(end);
    let status = UploadStatus::ALL.into_iter().find(is_it)?;
    let id = SculptureId::parse_hex(id).filter(|known| known.to_string() == id)?;
    Some((id, status))
}
