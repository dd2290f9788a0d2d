//! Working folders of the slicer.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use tracing::warn;

use crate::error::Error;
use crate::random::random_number;
use crate::store::folder_lock::FolderLock;

/// The folder of this process, with a subfolder for each slice.
pub(crate) struct SliceFolders {
    folder: PathBuf,
    count: AtomicU64,
    // While the lock is held, other processes that start don't remove the folder.
    _lock: FolderLock,
}

impl SliceFolders {
    /// Makes this process' folder in `all`, and removes those of processes that have ended.
    ///
    /// # Errors
    /// The error of the disk or the system.
    pub(crate) fn take(all: &Path) -> Result<Self, Error> {
        remove_left(all);
        let own = random_number().map_err(|error| Error::failure("random bits", error))?;
        let folder = all.join(format!("{own:016x}"));
        let lock = FolderLock::take(&folder)?;
        Ok(SliceFolders { folder, count: AtomicU64::new(0), _lock: lock })
    }

    /// Makes the folder of the next slice.
    ///
    /// # Errors
    /// An I/O error.
    pub(crate) fn make_next(&self) -> io::Result<SliceFolder> {
        let number = self.count.fetch_add(1, Ordering::Relaxed);
        let folder = SliceFolder(self.folder.join(number.to_string()));
        fs::create_dir_all(folder.path())?;
        Ok(folder)
    }

    #[cfg(test)]
    pub(crate) fn path(&self) -> &Path {
        &self.folder
    }
}

impl Drop for SliceFolders {
    fn drop(&mut self) {
        // If removal fails, the next start removes the folder.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// A folder that is removed on drop.
#[derive(Debug)]
pub(crate) struct SliceFolder(PathBuf);

impl SliceFolder {
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }
}

impl Drop for SliceFolder {
    fn drop(&mut self) {
        // If removal fails, the folder is removed with that of its process.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Removes the folders of processes that were killed. A slicer may outlive its booth and still write to its
/// folder: failures don't stop the server, and removal is retried at the next start.
fn remove_left(all: &Path) {
    for left in fs::read_dir(all).into_iter().flatten().flatten() {
        let path = left.path();
        if let Ok(_not_in_use) = FolderLock::take(&path)
            && let Err(error) = fs::remove_dir_all(&path)
        {
            warn!(%error, "slices of a booth that was killed stay");
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};
    use std::sync::atomic::{AtomicBool, Ordering};
    use std::thread;

    use super::SliceFolders;

    fn empty_folder(name: &str) -> PathBuf {
        let folder =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../target/tmp/slice-folders");
        let folder = folder.join(name);
        let _ = fs::remove_dir_all(&folder);
        folder
    }

    #[test]
    fn slices_of_a_process_stay_while_it_lives_and_go_with_it() {
        let all = empty_folder("lives");
        let first = SliceFolders::take(&all).expect("room on the disk");
        let slice = first.make_next().expect("room on the disk");
        let second = SliceFolders::take(&all).expect("a second process may start");
        assert!(slice.path().exists(), "another's slice was removed");
        assert_ne!(
            first.make_next().expect("room").path(),
            second.make_next().expect("room").path()
        );
        drop((slice, first, second));
        assert_eq!(fs::read_dir(&all).expect("it is there").count(), 0);
        fs::create_dir_all(all.join("of-a-killed-one/0")).expect("room on the disk");
        let third = SliceFolders::take(&all).expect("room on the disk");
        assert_eq!(fs::read_dir(&all).expect("it is there").count(), 1, "{:?}", third.path());
    }

    #[test]
    fn a_slicer_that_outlived_its_booth_keeps_none_from_starting() {
        let all = empty_folder("outlived");
        let left = all.join("of-a-killed-one/0");
        fs::create_dir_all(&left).expect("room on the disk");
        let is_over = AtomicBool::new(false);
        let started: Vec<_> = thread::scope(|scope| {
            scope.spawn(|| {
                // Fills the folder again whenever it is empty.
                for number in (0_u64..).take_while(|_| !is_over.load(Ordering::Relaxed)) {
                    let _ = fs::create_dir_all(&left);
                    let _ = fs::write(left.join(number.to_string()), "");
                }
            });
            let started = (0..20).map(|_| SliceFolders::take(&all).map(drop)).collect();
            is_over.store(true, Ordering::Relaxed);
            started
        });
        assert!(started.iter().all(Result::is_ok), "{started:?}");
    }
}
