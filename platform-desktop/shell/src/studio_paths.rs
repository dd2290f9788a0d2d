//! The folders and file names of a studio's sculptures, sessions and caches.

use std::env;
use std::path::{Path, PathBuf};

use crate::settings;

/// A studio's folders. Each is created when something is written there.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct StudioPaths {
    /// For the visitor: volumes, prints, pictures and traces.
    pub sculptures: PathBuf,
    /// Saved sessions.
    pub sessions: PathBuf,
    /// The pipeline cache.
    pub cache: PathBuf,
    /// The file of settings.
    pub settings: PathBuf,
    /// This window's number among those open at once, from 1.
    pub window: u32,
}

impl StudioPaths {
    /// The user's folders after the XDG Base Directory Specification. Sculptures go to `sculptures` if
    /// given, else to `Paros` in the home folder. Without a home folder, the current one counts as it.
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

    /// Subfolders of one folder, for systems without a folder for each purpose: a headset's.
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

    /// The save of the current session on a grid of `grid_side` voxels a side.
    #[must_use]
    pub fn session_file(&self, grid_side: usize) -> PathBuf {
        self.sessions.join(format!("session-{grid_side}{}.save", self.window_suffix()))
    }

    /// The save of the session before it, where that was left unfinished.
    #[must_use]
    pub fn left_unfinished_session_file(&self, grid_side: usize) -> PathBuf {
        self.sessions.join(format!("session-{grid_side}{}.before.save", self.window_suffix()))
    }

    /// When the headset was last used, beside the session's save.
    #[must_use]
    pub fn last_use_file(&self, grid_side: usize) -> PathBuf {
        self.sessions.join(format!("session-{grid_side}{}.last-use", self.window_suffix()))
    }

    /// An unused path beside the session's save, to move an unreadable save to.
    #[must_use]
    pub fn unused_path_for_unreadable_save(&self, grid_side: usize) -> PathBuf {
        (1u32..)
            .map(|number| {
                self.session_file(grid_side).with_extension(format!("unreadable-{number}"))
            })
            .find(|path| path.symlink_metadata().is_err())
            .unwrap_or_default()
    }

    /// The graphics driver's pipeline cache.
    #[must_use]
    pub fn pipeline_cache_file(&self) -> PathBuf {
        self.cache.join("pipelines.bin")
    }

    /// The log of a headset, beside the settings.
    #[must_use]
    pub fn log_file(&self) -> PathBuf {
        self.settings.with_file_name("paros.log")
    }

    /// The starts of a headset that have failed in a row.
    #[must_use]
    pub fn failed_starts_file(&self) -> PathBuf {
        self.cache.join("failed-starts")
    }

    /// The part of a file's name that tells the window; empty for the first.
    fn window_suffix(&self) -> String {
        match self.window {
            1 => String::new(),
            number => format!("-{number}"),
        }
    }
}
