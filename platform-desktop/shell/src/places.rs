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
    /// Which of the windows open at once this is, from 1.
    pub window: u32,
}

impl Places {
    /// The user's own folders, by the XDG base directories; sculptures go to `sculptures` where
    /// that is given, else to `Paros` at home. Who has no home is at home where the program was
    /// started.
    #[must_use]
    pub fn of_user(sculptures: Option<&Path>) -> Self {
        let absolute =
            |name: &str| env::var_os(name).map(PathBuf::from).filter(|p| p.is_absolute());
        let own = env::home_dir().filter(|home| home.is_absolute() && home.is_dir());
        let home = own.or_else(|| env::current_dir().ok()).unwrap_or_default();
        let data = absolute("XDG_DATA_HOME").unwrap_or_else(|| home.join(".local/share"));
        let cache = absolute("XDG_CACHE_HOME").unwrap_or_else(|| home.join(".cache"));
        Places {
            sculptures: sculptures.map_or_else(|| home.join("Paros"), Path::to_owned),
            sessions: data.join("paros"),
            cache: cache.join("paros"),
            window: 1,
        }
    }

    /// Folders in one, where the system has none for each purpose: a headset's.
    #[must_use]
    pub fn within(folder: &Path) -> Self {
        Places {
            sculptures: folder.join("sculptures"),
            sessions: folder.join("sessions"),
            cache: folder.join("cache"),
            window: 1,
        }
    }

    /// The session under way at a size.
    #[must_use]
    pub fn session(&self, n: usize) -> PathBuf {
        self.sessions.join(format!("session-{n}{}.save", self.suffix()))
    }

    /// The session before it, which was left for a new one.
    #[must_use]
    pub fn session_before(&self, n: usize) -> PathBuf {
        self.sessions.join(format!("session-{n}{}.before.save", self.suffix()))
    }

    /// A path that nothing has, for a session that can't be read.
    #[must_use]
    pub fn aside(&self, n: usize) -> PathBuf {
        (1u32..)
            .map(|number| self.session(n).with_extension(format!("unreadable-{number}")))
            .find(|path| path.symlink_metadata().is_err())
            .unwrap_or_default()
    }

    /// The driver's compiled programs.
    #[must_use]
    pub fn pipelines(&self) -> PathBuf {
        self.cache.join("pipelines.bin")
    }

    /// The first window's files are named as if it were the only one.
    fn suffix(&self) -> String {
        match self.window {
            1 => String::new(),
            number => format!("-{number}"),
        }
    }
}
