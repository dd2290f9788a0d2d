//! The settings of the way to a booth.

use std::path::{Path, PathBuf};

use crate::outbox::OutboxSettings;
use crate::outbox::enrolment::enrolment_file;

/// What an exhibition sets of the way to its booth.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct BoothSettings {
    /// The file that an enrolment left; the one beside the saved sessions if not set.
    pub enrolment: Option<PathBuf>,
    /// Whether traces are sent.
    pub sends_traces: bool,
    /// Days for which a sculpture stays here once the booth has it.
    pub grace_days: u32,
    /// Megabytes that all parcels may take together.
    pub space_mb: u32,
}

impl BoothSettings {
    /// Before any setting is stored.
    pub(super) const fn unset() -> Self {
        BoothSettings { enrolment: None, sends_traces: false, grace_days: 0, space_mb: 0 }
    }

    /// Where the enrolment is kept, beside saved sessions in `sessions` unless the setting is absolute.
    #[must_use]
    pub fn enrolment_path(&self, sessions: &Path) -> PathBuf {
        self.enrolment.as_ref().map_or_else(|| enrolment_file(sessions), |path| sessions.join(path))
    }

    /// As the outbox takes them.
    #[must_use]
    pub fn outbox(&self) -> OutboxSettings {
        OutboxSettings {
            grace_seconds: self.grace_days.saturating_mul(86_400),
            max_bytes: u64::from(self.space_mb) * 1_000_000,
        }
    }
}
