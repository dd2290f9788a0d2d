//! The mark of the last finished sculpture, by which a restart finds the id of a saved session's sculpture.

use std::path::{Path, PathBuf};

use paros_protocol::{ContentHash, SculptureId};
use paros_shell::durable;
use paros_shell::headset::sealed::{SEAL_BYTES, SealedFormat};

use super::orders::FinishedSculpture;

/// The file, beside the parcels.
const FILE: &str = "last-finished";

const FORMAT: SealedFormat =
    SealedFormat { magic: *b"PFIN", expected: "PFIN, the sculpture that was finished last" };

const BYTES: usize = SEAL_BYTES + SculptureId::BYTES + ContentHash::BYTES + 1;

pub(super) fn path_in(folder: &Path) -> PathBuf {
    folder.join(FILE)
}

/// Writes the mark. If that fails, a restart gives the saved sculpture a new id, and it may be sent twice.
pub(super) fn write(path: &Path, finished: &FinishedSculpture) -> Result<(), durable::WriteError> {
    let bytes: [u8; BYTES] = FORMAT.seal(|to| {
        to.bytes(&finished.id.0);
        to.bytes(&finished.volume_hash.0);
        to.u8(finished.is_kept.into());
    });
    durable::write_file(path, &bytes)
}

/// Reads the mark; `None` if it is missing or damaged.
pub(super) fn read(path: &Path) -> Option<FinishedSculpture> {
    let bytes = durable::read_regular_file_up_to(path, BYTES as u64).ok()?;
    let opened = FORMAT.open(&bytes, |from| {
        let (mut id, mut hash) = ([0; SculptureId::BYTES], [0; ContentHash::BYTES]);
        id.copy_from_slice(from.bytes(SculptureId::BYTES)?);
        hash.copy_from_slice(from.bytes(ContentHash::BYTES)?);
        let is_kept = from.u8()? != 0;
        Ok(FinishedSculpture { id: SculptureId(id), volume_hash: ContentHash(hash), is_kept })
    });
    opened.ok()
}
