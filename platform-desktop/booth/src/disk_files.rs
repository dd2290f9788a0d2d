//! Parcels and kept files in folders. All names are made of numbers and hexadecimal digits.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, SystemTime};

use paros_booth_rules::{BoothTime, Deletion, KeptName, KeptPart, ParcelFiles, ParcelName};
use paros_shell::durable;

use crate::deletion_log::DeletionLog;
use crate::files::Files;

/// Locks by which pieces of a parcel come one after the other; two parcels seldom share one.
const PARCEL_LOCKS: usize = 64;

/// Files in a folder.
pub struct DiskFiles {
    /// A folder a headset, a file a parcel.
    parcels: PathBuf,
    /// A file or two a sculpture.
    kept: PathBuf,
    quota_bytes: u64,
    /// Of kept files.
    used_bytes: AtomicU64,
    locks: [Mutex<()>; PARCEL_LOCKS],
    deletions: DeletionLog,
}

impl DiskFiles {
    /// The files of a folder, which is made where there is none. Kept files take up to `quota_bytes`.
    ///
    /// # Errors
    /// What the disk says.
    pub fn open(folder: &Path, quota_bytes: u64) -> io::Result<Self> {
        let (parcels, kept) = (folder.join("parcels"), folder.join("sculptures"));
        for folder in [&parcels, &kept] {
            durable::make_folder(folder).map_err(io::Error::other)?;
        }
        // Their names are on the disk before anything in them is promised.
        File::open(folder)?.sync_all()?;
        durable::remove_stale_temporaries(&kept);
        let mut used_bytes = 0;
        for entry in fs::read_dir(&kept)? {
            used_bytes += entry?.metadata()?.len();
        }
        Ok(DiskFiles {
            parcels,
            kept,
            quota_bytes,
            used_bytes: AtomicU64::new(used_bytes),
            locks: std::array::from_fn(|_| Mutex::new(())),
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

    fn folder_of(&self, headset: u32) -> PathBuf {
        self.parcels.join(headset.to_string())
    }

    fn parcel_path(&self, parcel: &ParcelName) -> PathBuf {
        self.folder_of(parcel.headset).join(format!("{}-{}", parcel.id, parcel.hash))
    }

    fn kept_path(&self, name: &KeptName) -> PathBuf {
        self.kept.join(kept_file_name(name))
    }

    fn lock_parcel(&self, parcel: &ParcelName) -> MutexGuard<'_, ()> {
        let lock = &self.locks[usize::from(parcel.hash.0[0]) % PARCEL_LOCKS];
        lock.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl ParcelFiles for DiskFiles {
    fn held_bytes(&self, parcel: &ParcelName) -> io::Result<u64> {
        match fs::metadata(self.parcel_path(parcel)) {
            Ok(found) => Ok(found.len()),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(0),
            Err(error) => Err(error),
        }
    }

    fn append(&self, parcel: &ParcelName, offset: u64, bytes: &[u8]) -> io::Result<u64> {
        self.check_quota(offset + bytes.len() as u64)?;
        let _one_at_a_time = self.lock_parcel(parcel);
        let path = self.parcel_path(parcel);
        fs::create_dir_all(self.folder_of(parcel.headset))?;
        let mut file = OpenOptions::new().append(true).create(true).open(path)?;
        let held = file.metadata()?.len();
        if held != offset {
            return Ok(held);
        }
        file.write_all(bytes)?;
        Ok(offset + bytes.len() as u64)
    }

    fn read_parcel(&self, parcel: &ParcelName) -> io::Result<Vec<u8>> {
        durable::read_regular_file(&self.parcel_path(parcel))
    }

    fn drop_parcel(&self, parcel: &ParcelName) -> io::Result<()> {
        let _one_at_a_time = self.lock_parcel(parcel);
        remove_if_there(&self.parcel_path(parcel)).map(drop)
    }

    fn make_room(&self, headset: u32, most: usize) -> io::Result<()> {
        let entries = match fs::read_dir(self.folder_of(headset)) {
            Ok(entries) => entries,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(error),
        };
        let mut by_age = Vec::new();
        for entry in entries {
            let entry = entry?;
            by_age.push((entry.metadata()?.modified()?, entry.path()));
        }
        by_age.sort_unstable();
        let too_many = (by_age.len() + 1).saturating_sub(most);
        for (_, path) in by_age.into_iter().take(too_many) {
            remove_if_there(&path)?;
        }
        Ok(())
    }

    fn drop_parcels_before(&self, time: BoothTime) -> io::Result<()> {
        let before = SystemTime::UNIX_EPOCH + Duration::from_millis(time.0);
        for folder in fs::read_dir(&self.parcels)? {
            for entry in fs::read_dir(folder?.path())? {
                let entry = entry?;
                if entry.metadata()?.modified()? < before {
                    remove_if_there(&entry.path())?;
                }
            }
        }
        Ok(())
    }

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
}

/// The name of a kept file, wherever it is.
pub(crate) fn kept_file_name(name: &KeptName) -> String {
    let part = match name.part {
        KeptPart::Sculpture => "sculpture",
        KeptPart::Trace => "trace",
        KeptPart::Picture => "png",
    };
    format!("{}-{}.{part}", name.id, name.hash)
}

/// Removes a file, if there is one. Returns how many bytes it had.
fn remove_if_there(path: &Path) -> io::Result<u64> {
    let length = fs::metadata(path).map_or(0, |found| found.len());
    match fs::remove_file(path) {
        Ok(()) => Ok(length),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(0),
        Err(error) => Err(error),
    }
}
