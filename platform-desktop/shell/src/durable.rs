//! Atomic file replacement: a file is written under a temporary name beside its target, synced to disk and
//! renamed over it; then its folder is synced. So a file is either whole or absent.
//!
//! If a storage can't sync folders, as on some Android devices, the file is kept, with a warning: see
//! [`take_storage_warnings`].

mod names;
mod warnings;

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

pub use names::temporary_name;
use names::{MAX_TEMPORARY_AGE, is_temporary_name};
pub use warnings::{StorageLimit, StorageWarning, take_storage_warnings};

/// The reason why a file could not be written. The target is unchanged.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot {action}: {source}", path.display())]
pub struct WriteError {
    /// The path of the target.
    pub path: PathBuf,
    /// The action that failed: "create", "write", ...
    pub action: &'static str,
    /// The system's reason.
    pub source: io::Error,
}

/// Opens a regular file for reading. Other files are rejected: a pipe or a device may never end.
///
/// # Errors
/// Returns the system's error, or an error if it is not a regular file.
pub fn open_regular_file(path: &Path) -> io::Result<File> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    File::open(path)
}

/// Reads a whole regular file.
///
/// # Errors
/// Returns the system's error, or an error if it is not a regular file.
pub fn read_regular_file(path: &Path) -> io::Result<Vec<u8>> {
    read_regular_file_up_to(path, u64::MAX)
}

/// Reads a whole regular file of at most `most` bytes.
///
/// # Errors
/// Returns the system's error, or an error if it is not a regular file or has more than `most` bytes.
pub fn read_regular_file_up_to(path: &Path, most: u64) -> io::Result<Vec<u8>> {
    let file = open_regular_file(path)?;
    let length = file.metadata()?.len();
    if length > most {
        return Err(io::Error::other(format!("it has {length} bytes; expected at most {most}")));
    }
    let mut bytes = Vec::new();
    // The file may grow while it is read.
    file.take(most).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Creates a folder and its parents if they don't exist.
///
/// # Errors
/// Returns the system's error, also if a file has that name.
pub fn make_folder(path: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(path).map_err(|source| write_error(path, "make the folder", source))
}

/// Removes the temporary files that killed processes left in a folder: those older than an hour. The process
/// number in the name is no criterion, as it may be in use again, or on another machine.
pub fn remove_stale_temporaries(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_ours = entry.file_name().to_str().is_some_and(is_temporary_name);
        let modified = entry.metadata().and_then(|found| found.modified());
        let age = modified.ok().and_then(|modified| modified.elapsed().ok());
        if is_ours && age.is_some_and(|age| age > MAX_TEMPORARY_AGE) {
            // A file that can't be removed does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// The modes of new files: subject to the process's umask, or only for the owner.
const SHARED_MODE: u32 = 0o666;
const PRIVATE_MODE: u32 = 0o600;

/// Writes a file atomically.
///
/// # Errors
/// Returns the errors of [`WriteTarget::resolve`] and [`WriteTarget::write_file`].
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    WriteTarget::resolve(path)?.write_file(bytes)
}

/// Writes a file that only its owner may read (mode 0600), atomically.
///
/// # Errors
/// Returns the errors of [`WriteTarget::resolve`] and [`WriteTarget::write_file`].
pub fn write_private_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    WriteTarget::resolve(path)?.write_temporary_of(PRIVATE_MODE, bytes)?.rename_over_target()
}

/// Writes several files, each atomically. All are on the disk before the first is renamed, so that a full
/// disk leaves none of them.
///
/// # Errors
/// Returns the first error, which names a file. The files before it have been written.
pub fn write_files(files: &[(WriteTarget, &[u8])]) -> Result<(), WriteError> {
    let temporaries: Result<Vec<_>, _> =
        files.iter().map(|(target, bytes)| target.write_temporary(bytes)).collect();
    temporaries?.into_iter().try_for_each(TemporaryFile::rename_over_target)
}

/// Creates several new files, all or none. Never replaces an existing file, even if other processes create
/// files of the same names at the same time.
///
/// # Errors
/// Returns the first error, with `AlreadyExists` if a name is taken. None of the files exists then.
pub fn create_new_files(files: &[(WriteTarget, &[u8])]) -> Result<(), WriteError> {
    let temporaries: Result<Vec<_>, _> =
        files.iter().map(|(target, bytes)| target.write_temporary(bytes)).collect();
    let mut created = Vec::new();
    for temporary in temporaries? {
        let file = &temporary.target.file;
        if let Err(error) = temporary.link_if_target_is_absent() {
            for file in created {
                // Only the first error is reported.
                let _ = fs::remove_file(file);
            }
            return Err(error);
        }
        created.push(file);
    }
    Ok(())
}

/// Removes a file if it exists, and syncs its folder.
///
/// # Errors
/// Returns the system's error.
pub fn remove_file(path: &Path) -> Result<(), WriteError> {
    match fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => {
            Err(write_error(path, "remove", source))
        }
        _ => {
            sync_folder_or_warn(path);
            Ok(())
        }
    }
}

/// Renames a file within its folder, replacing a file of that name, and syncs the folder.
///
/// # Errors
/// Returns the system's error, also if there is no such file.
pub fn rename_file(path: &Path, name: &str) -> Result<(), WriteError> {
    let renamed = fs::rename(path, path.with_file_name(name));
    renamed.map_err(|source| write_error(path, "rename", source))?;
    sync_folder_or_warn(path);
    Ok(())
}

/// A resolved path for a file. Nothing exists there until the file is written.
#[derive(Clone, Debug)]
pub struct WriteTarget {
    /// The path as given.
    path: PathBuf,
    /// The path with symbolic links resolved; the file itself need not exist yet.
    file: PathBuf,
}

impl WriteTarget {
    /// Resolves a path. A symbolic link is followed to its target.
    ///
    /// # Errors
    /// Returns an error if the path is something other than a regular file, a dangling link, or no valid file
    /// name.
    pub fn resolve(path: &Path) -> Result<Self, WriteError> {
        let refuse = |action, why| {
            Err(write_error(path, action, io::Error::new(io::ErrorKind::InvalidInput, why)))
        };
        let is_link = || fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink());
        let at = |file| WriteTarget { path: path.to_owned(), file };
        match fs::canonicalize(path) {
            Ok(existing) if existing.is_file() => Ok(at(existing)),
            Ok(_) => refuse("replace", "it is not a regular file"),
            Err(_) if is_link() => refuse("replace", "it is a link that leads nowhere"),
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                Err(write_error(path, "create", source))
            }
            Err(_) => match path.file_name().filter(|_| !ends_in_separator(path)) {
                None => refuse("create", "no file name"),
                Some(name) => fs::canonicalize(parent_folder(path))
                    .map(|folder| at(folder.join(name)))
                    .map_err(|source| write_error(path, "create", source)),
            },
        }
    }

    /// Resolves a path, and checks that its folder is writable by creating and removing a temporary file.
    ///
    /// # Errors
    /// Returns the errors of [`WriteTarget::resolve`], and an error if the folder is not writable.
    pub fn resolve_and_check_writable(path: &Path) -> Result<Self, WriteError> {
        let target = Self::resolve(path)?;
        drop(target.write_temporary(&[])?);
        Ok(target)
    }

    /// Writes the file atomically.
    ///
    /// # Errors
    /// Returns an error if the folder or the disk fails; then nothing has changed.
    pub fn write_file(&self, bytes: &[u8]) -> Result<(), WriteError> {
        self.write_temporary(bytes)?.rename_over_target()
    }

    /// Returns the path as it was given.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Returns `true` if both are the same file, even if their paths differ.
    #[must_use]
    pub fn is_same_file(&self, other: &Self) -> bool {
        self.file == other.file
    }

    fn write_temporary<'a>(&'a self, bytes: &[u8]) -> Result<TemporaryFile<'a>, WriteError> {
        self.write_temporary_of(SHARED_MODE, bytes)
    }

    fn write_temporary_of<'a>(
        &'a self,
        mode: u32,
        bytes: &[u8],
    ) -> Result<TemporaryFile<'a>, WriteError> {
        let fail = |action| move |source| write_error(&self.path, action, source);
        let temporary = self.file.with_file_name(temporary_name());
        let mut options = OpenOptions::new();
        set_mode(&mut options, mode);
        let opened = options.write(true).create_new(true).open(&temporary);
        let mut file = opened.map_err(fail("create"))?;
        let temporary = TemporaryFile { target: self, path: Some(temporary) };
        if !bytes.is_empty() {
            file.write_all(bytes).map_err(fail("write"))?;
        }
        file.sync_all().map_err(fail("sync"))?;
        Ok(temporary)
    }
}

/// A file synced to disk under a temporary name. Dropping it removes the file unless it was renamed.
struct TemporaryFile<'a> {
    target: &'a WriteTarget,
    /// The temporary path; `None` once it is renamed.
    path: Option<PathBuf>,
}

impl TemporaryFile<'_> {
    fn rename_over_target(mut self) -> Result<(), WriteError> {
        let WriteTarget { path, file } = self.target;
        if let Some(temporary) = &self.path {
            fs::rename(temporary, file).map_err(|source| write_error(path, "rename", source))?;
        }
        self.path = None;
        sync_folder_or_warn(file);
        Ok(())
    }

    /// Gives the file its own name by a hard link, which unlike a rename replaces nothing. If the file system
    /// has no hard links (FAT, Android's shared storage), checks that there is no such file and renames.
    fn link_if_target_is_absent(mut self) -> Result<(), WriteError> {
        let WriteTarget { path, file } = self.target;
        let Some(temporary) = &self.path else { return Ok(()) };
        let taken = |source| Err(write_error(path, "create", source));
        match fs::hard_link(temporary, file) {
            // Dropping `self` removes the temporary name.
            Ok(()) => {}
            Err(source) if source.kind() == io::ErrorKind::AlreadyExists => return taken(source),
            Err(_) if file.symlink_metadata().is_ok() => {
                return taken(io::ErrorKind::AlreadyExists.into());
            }
            Err(refusal) => {
                fs::rename(temporary, file)
                    .map_err(|source| write_error(path, "rename", source))?;
                self.path = None;
                warnings::note(StorageLimit::NoLinks, parent_folder(file), refusal);
            }
        }
        sync_folder_or_warn(file);
        Ok(())
    }
}

impl Drop for TemporaryFile<'_> {
    fn drop(&mut self) {
        if let Some(temporary) = &self.path {
            // An error is ignored: the stray file's name shows that it is temporary.
            let _ = fs::remove_file(temporary);
        }
    }
}

fn write_error(path: &Path, action: &'static str, source: io::Error) -> WriteError {
    WriteError { path: path.to_owned(), action, source }
}

fn ends_in_separator(path: &Path) -> bool {
    path.as_os_str().as_encoded_bytes().last().is_some_and(|&byte| byte == b'/')
}

fn parent_folder(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Syncs the folder of a renamed file. A failure only causes a warning: the file is whole, and is neither
/// removed nor written again.
fn sync_folder_or_warn(file: &Path) {
    let folder = parent_folder(file);
    if let Err(refusal) = sync_folder(folder) {
        warnings::note(StorageLimit::UnsyncedFolder, folder, refusal);
    }
}

#[cfg(unix)]
fn set_mode(options: &mut OpenOptions, mode: u32) {
    std::os::unix::fs::OpenOptionsExt::mode(options, mode);
}

/// Does nothing: other systems have no file modes.
#[cfg(not(unix))]
fn set_mode(_options: &mut OpenOptions, _mode: u32) {}

#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(folder)?.sync_all()
}

/// Does nothing: on other systems a folder can't be opened and synced.
#[cfg(not(unix))]
fn sync_folder(_folder: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};
    use std::time::SystemTime;

    use super::{MAX_TEMPORARY_AGE, remove_stale_temporaries, temporary_name};

    #[test]
    fn only_what_was_left_long_ago_is_swept() {
        let folder = std::env::temp_dir().join(format!("paros-sweep-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("room on the disk");
        let (left, under_way) = (temporary_name(), temporary_name());
        let others =
            ["session-128.save", ".paros-1.part", ".paros-1-x.part", ".paros-1-2.part.rmap"];
        for name in [&*left, &under_way].into_iter().chain(others) {
            let file = File::create(folder.join(name)).expect("room on the disk");
            let age = if name == under_way { MAX_TEMPORARY_AGE / 2 } else { MAX_TEMPORARY_AGE * 2 };
            file.set_modified(SystemTime::now() - age).expect("it is ours");
        }
        remove_stale_temporaries(&folder);
        assert!(!folder.join(&left).exists());
        assert!(folder.join(&under_way).exists());
        assert!(others.iter().all(|name| folder.join(name).exists()));
        remove_stale_temporaries(&folder.join("none"));
        fs::remove_dir_all(&folder).expect("it is ours");
    }
}
