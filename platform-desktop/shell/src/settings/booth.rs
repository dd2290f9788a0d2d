//! The settings of the way to a booth.

use std::path::PathBuf;

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
}
