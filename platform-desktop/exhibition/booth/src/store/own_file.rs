//! A file or a folder that only its owner reads, under a temporary name until it is whole.

use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, Write as _};
use std::os::unix::fs::{DirBuilderExt as _, OpenOptionsExt as _};
use std::path::{Path, PathBuf};

use paros_shell::durable;

/// The length of a file that checks a folder: a sculpture's file is a fifth of that.
const CHECKED_BYTES: usize = 1 << 16;

/// A temporary file or folder, which is removed where it isn't renamed.
#[derive(Debug)]
pub(crate) struct OwnPart {
    /// Under which name it is made.
    pub(crate) path: PathBuf,
    is_renamed: bool,
}

impl OwnPart {
    /// A new file beside the one that it is to be, of mode 0600.
    ///
    /// # Errors
    /// What the disk says.
    pub(crate) fn new_file(of: &Path) -> io::Result<(Self, File)> {
        let path = parent_of(of).join(durable::temporary_name());
        durable::remove_stale_temporaries(parent_of(of));
        let mut options = OpenOptions::new();
        let file = options.read(true).write(true).create_new(true).mode(0o600).open(&path)?;
        Ok((OwnPart { path, is_renamed: false }, file))
    }

    /// A new folder beside the one that it is to be, of mode 0700.
    ///
    /// # Errors
    /// What the disk says.
    pub(crate) fn new_folder(of: &Path) -> io::Result<Self> {
        let path = parent_of(of).join(durable::temporary_name());
        DirBuilder::new().mode(0o700).create(&path)?;
        Ok(OwnPart { path, is_renamed: false })
    }

    /// Gives it its name. What it holds is on the disk already.
    ///
    /// # Errors
    /// What the disk says.
    pub(crate) fn rename(mut self, to: &Path) -> io::Result<()> {
        fs::rename(&self.path, to)?;
        self.is_renamed = true;
        File::open(parent_of(to))?.sync_all()
    }
}

impl Drop for OwnPart {
    fn drop(&mut self) {
        if !self.is_renamed {
            // The stray name says what it is.
            let _ = fs::remove_file(&self.path).or_else(|_| fs::remove_dir_all(&self.path));
        }
    }
}

/// Checks that a folder has room for a file.
///
/// # Errors
/// The error of the disk.
pub(crate) fn check_folder(folder: &Path) -> io::Result<()> {
    let (_removed, mut file) = OwnPart::new_file(&folder.join("check"))?;
    file.write_all(&[0; CHECKED_BYTES])?;
    file.sync_all()
}

fn parent_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}
