//! The folders and file names of a studio's sculptures, sessions and caches.

use std::env;
use std::path::{Path, PathBuf};

use crate::settings;

/// A studio's folders. Each is created when something is written there.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct StudioPaths {
    /// The visitor's files: volumes, prints, pictures and traces.
    pub sculptures: PathBuf,
    /// Saved sessions.
    pub sessions: PathBuf,
    /// The pipeline cache.
    pub cache: PathBuf,
    /// The settings file.
    pub settings: PathBuf,
    /// The number of this window among all open ones, from 1.
    pub window: u32,
}

impl StudioPaths {
    /// Returns the user's folders according to the XDG Base Directory Specification. Sculptures go to
    /// `sculptures` if given, else to `Paros` in the home folder. Without a home folder, the current folder
    /// is used.
    #[must_use]
    pub fn for_user(sculptures: Option<&Path>) -> Self {
        let absolute =
            |name: &str| env::var_os(name).map(PathBuf::from).filter(|p| p.is_absolute());
        let own = env::home_dir().filter(|home| home.is_absolute() && home.is_dir());
        let home = own.or_else(|| env::current_dir().ok()).unwrap_or_default();
        let data = absolute("XDG_DATA_HOME").unwrap_or_else(|| home.join(".local/share"));
        let cache = absolute("XDG_CACHE_HOME").unwrap_or_else(|| home.join(".cache"));
        StudioPaths {
            sculptures: sculptures.map_or_else(|| home.join("Paros"), Path::to_owned),
            sessions: data.join("paros"),
            cache: cache.join("paros"),
            settings: data.join("paros").join(settings::FILE_NAME),
            window: 1,
        }
    }

    /// Returns subfolders of one folder, for systems without a folder for each purpose, such as headsets.
    #[must_use]
    pub fn inside_folder(folder: &Path) -> Self {
        StudioPaths {
            sculptures: folder.join("sculptures"),
            sessions: folder.join("sessions"),
            cache: folder.join("cache"),
            settings: folder.join(settings::FILE_NAME),
            window: 1,
        }
    }

    /// Returns the path of the current session's save on a grid of `grid_side` voxels a side.
    #[must_use]
    pub fn session_file(&self, grid_side: usize) -> PathBuf {
        self.sessions.join(format!("session-{grid_side}{}.save", self.window_suffix()))
    }

    /// Returns the path of the previous session's save, if that session was left unfinished.
    #[must_use]
    pub fn left_unfinished_session_file(&self, grid_side: usize) -> PathBuf {
        self.sessions.join(format!("session-{grid_side}{}.before.save", self.window_suffix()))
    }

    /// Returns the path of the file with the time of the headset's last use, beside the session's save.
    #[must_use]
    pub fn last_use_file(&self, grid_side: usize) -> PathBuf {
        self.sessions.join(format!("session-{grid_side}{}.last-use", self.window_suffix()))
    }

    /// Returns an unused path beside the session's save, to which an unreadable save can be moved.
    #[must_use]
    pub fn unused_path_for_unreadable_save(&self, grid_side: usize) -> PathBuf {
        (1u32..)
            .map(|number| {
                self.session_file(grid_side).with_extension(format!("unreadable-{number}"))
            })
            .find(|path| path.symlink_metadata().is_err())
            .unwrap_or_default()
    }

    /// Returns the path of the graphics driver's pipeline cache.
    #[must_use]
    pub fn pipeline_cache_file(&self) -> PathBuf {
        self.cache.join("pipelines.bin")
    }

    /// Returns the path of a headset's log, beside the settings.
    #[must_use]
    pub fn log_file(&self) -> PathBuf {
        self.settings.with_file_name("paros.log")
    }

    /// Returns the path of the count of a headset's consecutive failed starts.
    #[must_use]
    pub fn failed_starts_file(&self) -> PathBuf {
        self.cache.join("failed-starts")
    }

    /// Returns the part of a file's name that identifies the window; empty for the first.
    fn window_suffix(&self) -> String {
        match self.window {
            1 => String::new(),
            number => format!("-{number}"),
        }
    }
}
