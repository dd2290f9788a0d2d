//! Where a studio keeps its files.

use std::env;
use std::path::{Path, PathBuf};

/// Folders; each is made when something is written there.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Places {
    /// Sculptures, prints, pictures and traces: what the visitor is to find.
    pub sculptures: PathBuf,
    /// Sessions under way.
    pub sessions: PathBuf,
    /// What makes the next start faster.
    pub cache: PathBuf,
}

impl Places {
    /// The user's own folders, by the XDG base directories; sculptures go to `sculptures` where
    /// that is given, else to `Paros` at home.
    #[must_use]
    pub fn of_user(sculptures: Option<&Path>) -> Self {
        let absolute =
            |name: &str| env::var_os(name).map(PathBuf::from).filter(|p| p.is_absolute());
        let home = absolute("HOME").or_else(|| absolute("USERPROFILE")).unwrap_or_default();
        let data = absolute("XDG_DATA_HOME").unwrap_or_else(|| home.join(".local/share"));
        let cache = absolute("XDG_CACHE_HOME").unwrap_or_else(|| home.join(".cache"));
        Places {
            sculptures: sculptures.map_or_else(|| home.join("Paros"), Path::to_owned),
            sessions: data.join("paros"),
            cache: cache.join("paros"),
        }
    }

    /// Folders in one, where the system has none for each purpose: a headset's.
    #[must_use]
    pub fn within(folder: &Path) -> Self {
        Places {
            sculptures: folder.join("sculptures"),
            sessions: folder.join("sessions"),
            cache: folder.join("cache"),
        }
    }

    /// The session under way at a size.
    #[must_use]
    pub fn session(&self, n: usize) -> PathBuf {
        self.sessions.join(format!("session-{n}.save"))
    }

    /// The session before it, which was left for a new one.
    #[must_use]
    pub fn session_before(&self, n: usize) -> PathBuf {
        self.sessions.join(format!("session-{n}.before.save"))
    }

    /// The driver's compiled programs.
    #[must_use]
    pub fn pipelines(&self) -> PathBuf {
        self.cache.join("pipelines.bin")
    }

    /// A path without an ending that no file of the sculptures' folder has with any of `endings`.
    #[must_use]
    pub fn free(&self, name: &str, endings: &[&str]) -> PathBuf {
        let taken = |stem: &Path| endings.iter().any(|ending| stem.with_extension(ending).exists());
        (1u32..)
            .map(|number| self.sculptures.join(format!("{name}-{number:03}")))
            .find(|stem| !taken(stem))
            .unwrap_or_default()
    }
}
