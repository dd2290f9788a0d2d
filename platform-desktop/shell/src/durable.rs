//! Files that appear whole or not at all: written under a temporary name beside the target, synced
//! to disk, renamed over it, and the folder synced after.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::time::Duration;

/// Why a file could not be written. The target is as it was before; but where its folder could not
/// be synced, it may be the new file already, which then may not outlast a loss of power.
#[derive(Debug)]
pub struct Error {
    /// The file that was to be written.
    pub path: PathBuf,
    /// What failed: "create", "write", ...
    pub action: &'static str,
    /// The system's reason.
    pub source: io::Error,
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: cannot {}: {}", self.path.display(), self.action, self.source)
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        Some(&self.source)
    }
}

/// Opens a file to be read; only a regular one, as a pipe or a device may never end.
///
/// # Errors
/// The system's, or that it is no regular file.
pub fn open(path: &Path) -> io::Result<File> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    File::open(path)
}

/// Reads a whole regular file.
///
/// # Errors
/// The system's, or that it is no regular file.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Makes a folder and those above it; one that is there already is as good.
///
/// # Errors
/// When the system refuses, or a file has that name.
pub fn make_folder(path: &Path) -> Result<(), Error> {
    fs::create_dir_all(path).map_err(|source| error(path, "make the folder", source))
}

/// Removes from a folder what processes left there that were killed while they wrote. What may be
/// under way yet stays, whoever writes it: a process's number would not tell, as another may have
/// it by now, or the folder may be another machine's.
pub fn sweep(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_ours = entry.file_name().to_str().is_some_and(is_temporary);
        let modified = entry.metadata().and_then(|found| found.modified());
        let age = modified.ok().and_then(|modified| modified.elapsed().ok());
        if is_ours && age.is_some_and(|age| age > LONGEST_DRAFT) {
            // What can't be removed harms nobody.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Writes a whole file.
///
/// # Errors
/// Those of [`Target::write`].
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    Target::new(path)?.write(bytes)
}

/// Writes several whole files. All are on the disk before the first takes its name, so that a full
/// disk leaves none of them.
///
/// # Errors
/// When a folder or the disk refuses. Those before the one that is named have been written.
pub fn write_all(files: &[(Target, &[u8])]) -> Result<(), Error> {
    let drafts: Result<Vec<_>, _> =
        files.iter().map(|(target, bytes)| target.draft(bytes)).collect();
    drafts?.into_iter().try_for_each(Draft::publish)
}

/// Writes several whole files to names that nothing has yet, however many processes try at once.
///
/// # Errors
/// As [`write_all`], and `AlreadyExists` where a name is taken; then none of them is there.
pub fn write_all_new(files: &[(Target, &[u8])]) -> Result<(), Error> {
    let drafts: Result<Vec<_>, _> =
        files.iter().map(|(target, bytes)| target.draft(bytes)).collect();
    let mut published = Vec::new();
    for draft in drafts? {
        let file = &draft.target.file;
        if let Err(error) = draft.publish_new() {
            for file in published {
                // The error that is told is the first one.
                let _ = fs::remove_file(file);
            }
            return Err(error);
        }
        published.push(file);
    }
    Ok(())
}

/// A place for a file. Until the file is written there is no trace of it.
#[derive(Clone, Debug)]
pub struct Target {
    /// As it was named.
    path: PathBuf,
    /// Without links, but for the file itself where that is not there yet.
    file: PathBuf,
}

impl Target {
    /// The place that a path names. Where that is a symbolic link, it is the file that the link
    /// leads to.
    ///
    /// # Errors
    /// When something other than a regular file is there, or a link that leads nowhere, or no file
    /// can have this name.
    pub fn new(path: &Path) -> Result<Self, Error> {
        let refuse = |action, why| {
            Err(error(path, action, io::Error::new(io::ErrorKind::InvalidInput, why)))
        };
        let is_link = || fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink());
        let at = |file| Target { path: path.to_owned(), file };
        match fs::canonicalize(path) {
            Ok(existing) if existing.is_file() => Ok(at(existing)),
            Ok(_) => refuse("replace", "it is not a regular file"),
            Err(_) if is_link() => refuse("replace", "it is a link that leads nowhere"),
            Err(source) if source.kind() != io::ErrorKind::NotFound => {
                Err(error(path, "create", source))
            }
            Err(_) => match path.file_name().filter(|_| !ends_in_separator(path)) {
                None => refuse("create", "no file name"),
                Some(name) => fs::canonicalize(folder_of(path))
                    .map(|folder| at(folder.join(name)))
                    .map_err(|source| error(path, "create", source)),
            },
        }
    }

    /// The place that a path names, once its folder has taken a file. That is gone again.
    ///
    /// # Errors
    /// Those of [`Target::new`], and when the folder takes no new file.
    pub fn tried(path: &Path) -> Result<Self, Error> {
        let target = Self::new(path)?;
        drop(target.draft(&[])?);
        Ok(target)
    }

    /// Writes the file.
    ///
    /// # Errors
    /// When the folder or the disk refuses; then nothing has changed, unless it is the folder's sync
    /// that failed ([`Error`]).
    pub fn write(&self, bytes: &[u8]) -> Result<(), Error> {
        self.draft(bytes)?.publish()
    }

    /// The path as it was named.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether both are the same file, however they were named.
    #[must_use]
    pub fn is_same_file(&self, other: &Self) -> bool {
        self.file == other.file
    }

    fn draft<'a>(&'a self, bytes: &[u8]) -> Result<Draft<'a>, Error> {
        let fail = |action| move |source| error(&self.path, action, source);
        let temporary = self.file.with_file_name(temporary_name());
        let mut options = OpenOptions::new();
        let opened = options.write(true).create_new(true).open(&temporary);
        let mut file = opened.map_err(fail("create"))?;
        let draft = Draft { target: self, temporary: Some(temporary) };
        if !bytes.is_empty() {
            file.write_all(bytes).map_err(fail("write"))?;
        }
        file.sync_all().map_err(fail("sync"))?;
        Ok(draft)
    }
}

/// A file on the disk without its name. Dropped before it is published, it vanishes.
struct Draft<'a> {
    target: &'a Target,
    /// `None` once it has become the target.
    temporary: Option<PathBuf>,
}

impl Draft<'_> {
    fn publish(mut self) -> Result<(), Error> {
        let Target { path, file } = self.target;
        if let Some(temporary) = &self.temporary {
            fs::rename(temporary, file).map_err(|source| error(path, "rename", source))?;
        }
        self.temporary = None;
        sync_folder(file).map_err(|source| error(path, "sync the folder of", source))
    }

    /// Takes the name unless something has it: a hard link, unlike a rename, replaces nothing. A
    /// disk without links (FAT) is looked at instead.
    fn publish_new(mut self) -> Result<(), Error> {
        let Target { path, file } = self.target;
        let Some(temporary) = &self.temporary else { return Ok(()) };
        let taken = |source| Err(error(path, "create", source));
        match fs::hard_link(temporary, file) {
            // The temporary name goes with the draft.
            Ok(()) => {}
            Err(source) if source.kind() == io::ErrorKind::AlreadyExists => return taken(source),
            Err(_) if file.exists() => return taken(io::ErrorKind::AlreadyExists.into()),
            Err(_) => {
                fs::rename(temporary, file).map_err(|source| error(path, "rename", source))?;
                self.temporary = None;
            }
        }
        sync_folder(file).map_err(|source| {
            // Nothing had this name: nothing is to have it now.
            let _ = fs::remove_file(file);
            error(path, "sync the folder of", source)
        })
    }
}

impl Drop for Draft<'_> {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            // Nothing is left to do with an error here; the stray name says what it is.
            let _ = fs::remove_file(temporary);
        }
    }
}

fn error(path: &Path, action: &'static str, source: io::Error) -> Error {
    Error { path: path.to_owned(), action, source }
}

fn ends_in_separator(path: &Path) -> bool {
    path.as_os_str().as_encoded_bytes().last().is_some_and(|&byte| byte == b'/')
}

/// How long a draft lives at the most: the slowest disk has taken it by then. One that lived longer
/// and is gone fails to be renamed, which is told, and written again.
const LONGEST_DRAFT: Duration = Duration::from_secs(60 * 60);

/// A name that no other draft of this or another process has. It is short whatever the target's is:
/// a name has a longest length.
fn temporary_name() -> String {
    static DRAFTS: AtomicU32 = AtomicU32::new(0);
    let draft = DRAFTS.fetch_add(1, Ordering::Relaxed);
    format!(".paros-{}-{draft}.part", std::process::id())
}

/// Whether [`temporary_name`] makes such names.
fn is_temporary(name: &str) -> bool {
    let numbers = name.strip_prefix(".paros-").and_then(|rest| rest.strip_suffix(".part"));
    numbers.and_then(|numbers| numbers.split_once('-')).is_some_and(|(process, draft)| {
        [process, draft].iter().all(|number| number.parse::<u32>().is_ok())
    })
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

#[cfg(unix)]
fn sync_folder(file: &Path) -> io::Result<()> {
    File::open(folder_of(file))?.sync_all()
}

/// Elsewhere a folder is no file that could be synced.
#[cfg(not(unix))]
fn sync_folder(_file: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::fs::{self, File};
    use std::time::SystemTime;

    use super::{LONGEST_DRAFT, sweep, temporary_name};

    #[test]
    fn only_what_was_left_long_ago_is_swept() {
        let folder = std::env::temp_dir().join(format!("paros-sweep-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("room on the disk");
        let (left, under_way) = (temporary_name(), temporary_name());
        let others =
            ["session-128.save", ".paros-1.part", ".paros-1-x.part", ".paros-1-2.part.rmap"];
        for name in [&*left, &under_way].into_iter().chain(others) {
            let file = File::create(folder.join(name)).expect("room on the disk");
            let age = if name == under_way { LONGEST_DRAFT / 2 } else { LONGEST_DRAFT * 2 };
            file.set_modified(SystemTime::now() - age).expect("it is ours");
        }
        sweep(&folder);
        assert!(!folder.join(&left).exists());
        assert!(folder.join(&under_way).exists());
        assert!(others.iter().all(|name| folder.join(name).exists()));
        sweep(&folder.join("none"));
        fs::remove_dir_all(&folder).expect("it is ours");
    }
}
