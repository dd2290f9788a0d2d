//! Files that appear whole or not at all: written under a temporary name beside the target, synced
//! to disk, renamed over it, and the folder synced after.

use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

/// Why a file could not be written. The target is as it was before.
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

/// Writes a whole file.
///
/// # Errors
/// When the folder or the disk refuses; then nothing has changed.
pub fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let mut draft = Draft::create(path)?;
    draft.write_all(bytes).map_err(|source| draft.error("write", source))?;
    draft.commit()
}

/// A file being written. It takes its name on [`Draft::commit`]; dropped before, it vanishes.
#[derive(Debug)]
#[must_use = "a draft that is not committed vanishes"]
pub struct Draft {
    file: BufWriter<File>,
    target: PathBuf,
    /// `None` once it has become the target.
    temporary: Option<PathBuf>,
}

impl Draft {
    /// Starts a file that will replace `path`. Where `path` is a symbolic link, the file that it
    /// points to is replaced.
    ///
    /// # Errors
    /// When `path` is there and is no regular file, or its folder does not take a new file.
    pub fn create(path: &Path) -> Result<Self, Error> {
        let fail = |action, source| Error { path: path.to_owned(), action, source };
        let unfit = |what| io::Error::new(io::ErrorKind::InvalidInput, what);
        let target = match fs::canonicalize(path) {
            Ok(existing) if existing.is_file() => existing,
            Ok(_) => return Err(fail("replace", unfit("it is not a regular file"))),
            Err(_) => path.to_owned(),
        };
        let temporary =
            temporary_name(&target).ok_or_else(|| fail("create", unfit("no file name")))?;
        let file = OpenOptions::new()
            .write(true)
            .create_new(true)
            .open(&temporary)
            .map_err(|source| fail("create", source))?;
        Ok(Draft { file: BufWriter::new(file), target, temporary: Some(temporary) })
    }

    /// Makes the file durable under its name.
    ///
    /// # Errors
    /// When the disk refuses; then the target is as it was.
    pub fn commit(mut self) -> Result<(), Error> {
        self.file.flush().map_err(|source| self.error("write", source))?;
        self.file.get_ref().sync_all().map_err(|source| self.error("sync", source))?;
        if let Some(temporary) = &self.temporary {
            fs::rename(temporary, &self.target).map_err(|source| self.error("rename", source))?;
        }
        self.temporary = None;
        sync_folder(&self.target).map_err(|source| self.error("sync the folder of", source))
    }

    /// An error of this draft, for a failed write into it.
    #[must_use]
    pub fn error(&self, action: &'static str, source: io::Error) -> Error {
        Error { path: self.target.clone(), action, source }
    }
}

impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        if let Some(temporary) = &self.temporary {
            // Nothing is left to do with an error here; the stray name says what it is.
            let _ = fs::remove_file(temporary);
        }
    }
}

/// A name beside the target that no other draft of this or another process has.
fn temporary_name(target: &Path) -> Option<PathBuf> {
    static DRAFTS: AtomicU32 = AtomicU32::new(0);
    let draft = DRAFTS.fetch_add(1, Ordering::Relaxed);
    let mut name = OsString::from(".");
    name.push(target.file_name()?);
    name.push(format!(".{}-{draft}.part", std::process::id()));
    Some(target.with_file_name(name))
}

#[cfg(unix)]
fn sync_folder(target: &Path) -> io::Result<()> {
    let folder = target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    File::open(folder)?.sync_all()
}

/// Elsewhere a folder is no file that could be synced.
#[cfg(not(unix))]
fn sync_folder(_target: &Path) -> io::Result<()> {
    Ok(())
}
