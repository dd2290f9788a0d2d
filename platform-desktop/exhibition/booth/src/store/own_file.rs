//! A file or folder that only its owner can read, with a temporary name until it is complete.

use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};

use paros_shell::durable;

/// The length of the test file for a folder: five times a sculpture's file.
const CHECKED_BYTES: usize = 1 << 16;

/// A temporary file or folder. It is removed on drop unless it was renamed.
#[derive(Debug)]
pub(crate) struct OwnPart {
    /// The temporary path.
    pub(crate) path: PathBuf,
    is_renamed: bool,
}

impl OwnPart {
    /// Makes a temporary file beside the final path, with mode 0600.
    ///
    /// # Errors
    /// An I/O error.
    pub(crate) fn new_file(of: &Path) -> io::Result<(Self, File)> {
        let path = parent_of(of).join(durable::temporary_name());
        durable::remove_stale_temporaries(parent_of(of));
        let mut options = OpenOptions::new();
        let file = options.read(true).write(true).create_new(true).mode(0o600).open(&path)?;
        Ok((OwnPart { path, is_renamed: false }, file))
    }

    /// Makes a temporary folder beside the final path, with mode 0700.
    ///
    /// # Errors
    /// An I/O error.
    pub(crate) fn new_folder(of: &Path) -> io::Result<Self> {
        let path = parent_of(of).join(durable::temporary_name());
        DirBuilder::new().mode(0o700).create(&path)?;
        Ok(OwnPart { path, is_renamed: false })
    }

    /// Renames to the final path. The contents must be synced already.
    ///
    /// # Errors
    /// An I/O error.
    pub(crate) fn rename(mut self, to: &Path) -> io::Result<()> {
        fs::rename(&self.path, to)?;
        self.is_renamed = true;
        File::open(parent_of(to))?.sync_all()
    }
}

impl Drop for OwnPart {
    fn drop(&mut self) {
        if !self.is_renamed {
            // If removal fails, the name shows that the file is temporary.
            let _ = fs::remove_file(&self.path).or_else(|_| fs::remove_dir_all(&self.path));
        }
    }
}

/// Checks that a folder can be written to, with a test file.
///
/// # Errors
/// An I/O error.
pub(crate) fn check_folder(folder: &Path) -> io::Result<()> {
    let (_removed, mut file) = OwnPart::new_file(&folder.join("check"))?;
    file.write_all(&[0; CHECKED_BYTES])?;
    file.sync_all()
}

fn parent_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
