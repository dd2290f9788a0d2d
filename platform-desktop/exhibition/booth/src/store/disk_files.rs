//! Sculptures' files in a folder. All file names are made of hexadecimal digits.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use paros_booth_rules::{BoothTime, Deletion, KeptName, KeptPart, ParcelFiles};
use paros_protocol::{ContentHash, SculptureId};
use paros_shell::durable;
use rustix::fs::statvfs;

use crate::store::deletion_log::DeletionLog;
use crate::store::files::Files;
use crate::store::own_file::check_folder;

/// Files in a folder.
pub struct DiskFiles {
    /// The folder of kept files: one to three for each sculpture.
    kept: PathBuf,
    quota_bytes: u64,
    /// The bytes of all kept files.
    used_bytes: AtomicU64,
    deletions: DeletionLog,
}

impl DiskFiles {
    /// Opens the files in a folder, and makes it if there is none. Kept files may take up to `quota_bytes`.
    ///
    /// # Errors
    /// An I/O error.
    pub fn open(folder: &Path, quota_bytes: u64) -> io::Result<Self> {
        let kept = folder.join("sculptures");
        durable::make_folder(&kept).map_err(io::Error::other)?;
        // Syncs the folder's entries before any file in it is acknowledged.
        File::open(folder)?.sync_all()?;
        durable::remove_stale_temporaries(&kept);
        let mut used_bytes = 0;
        for entry in fs::read_dir(&kept)? {
            used_bytes += entry?.metadata()?.len();
        }
        Ok(DiskFiles {
            kept,
            quota_bytes,
            used_bytes: AtomicU64::new(used_bytes),
            deletions: DeletionLog::open(folder)?,
        })
    }

    fn check_quota(&self, more: u64) -> io::Result<()> {
        if self.used_bytes().saturating_add(more) <= self.quota_bytes {
            return Ok(());
        }
        let why = "as many bytes of sculptures are kept as may be";
        Err(io::Error::new(io::ErrorKind::StorageFull, why))
    }

    fn kept_path(&self, name: &KeptName) -> PathBuf {
        self.kept.join(kept_file_name(name))
    }
}

impl ParcelFiles for DiskFiles {
    fn keep(&self, name: &KeptName, bytes: &[u8]) -> io::Result<()> {
        self.check_quota(bytes.len() as u64)?;
        let path = self.kept_path(name);
        let before = fs::metadata(&path).map_or(0, |found| found.len());
        durable::write_file(&path, bytes).map_err(io::Error::other)?;
        self.used_bytes.fetch_add(bytes.len() as u64, Ordering::Relaxed);
        self.used_bytes.fetch_sub(before, Ordering::Relaxed);
        Ok(())
    }

    fn read_kept(&self, name: &KeptName) -> io::Result<Vec<u8>> {
        durable::read_regular_file(&self.kept_path(name))
    }

    fn remove_kept(&self, name: &KeptName) -> io::Result<()> {
        let removed = remove_if_there(&self.kept_path(name))?;
        self.used_bytes.fetch_sub(removed, Ordering::Relaxed);
        Ok(())
    }

    fn log_deletions(&self, deletions: &[Deletion]) -> io::Result<()> {
        self.deletions.append(deletions)
    }

    fn forget_deletions_before(&self, time: BoothTime) -> io::Result<()> {
        self.deletions.forget_before(time)
    }
}

impl Files for DiskFiles {
    fn used_bytes(&self) -> u64 {
        self.used_bytes.load(Ordering::Relaxed)
    }

    fn room_bytes(&self) -> u64 {
        let on_disk =
            statvfs(&self.kept).map_or(0, |disk| disk.f_bavail.saturating_mul(disk.f_frsize));
        self.quota_bytes.saturating_sub(self.used_bytes()).min(on_disk)
    }

    fn check_writes(&self) -> io::Result<()> {
        check_folder(&self.kept)
    }
}

/// Returns the name of a kept file, in a folder or a bucket.
pub(crate) fn kept_file_name(name: &KeptName) -> String {
    format!("{}-{}.{}", name.id, name.hash, ending_of(name.part))
}

/// Parses the name of a kept file; `None` for any other name.
pub(crate) fn parse_kept_name(name: &str) -> Option<KeptName> {
    let (names, ending) = name.split_once('.')?;
    let (id, hash) = names.split_once('-')?;
    let part = KeptPart::ALL.into_iter().find(|part| ending_of(*part) == ending)?;
    Some(KeptName { id: SculptureId::parse_hex(id)?, hash: ContentHash::parse_hex(hash)?, part })
}

/// Returns the extension of a kept file's name.
pub(crate) const fn ending_of(part: KeptPart) -> &'static str {
    match part {
        KeptPart::Sculpture => "sculpture",
        KeptPart::Trace => "trace",
        KeptPart::Picture => "png",
    }
}

/// Removes a file if it exists. Returns its length, or 0.
fn remove_if_there(path: &Path) -> io::Result<u64> {
    let length = fs::metadata(path).map_or(0, |found| found.len());
    match fs::remove_file(path) {
        Ok(()) => Ok(length),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(0),
        Err(error) => Err(error),
    }
}
