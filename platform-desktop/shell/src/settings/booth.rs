//! The settings for sending sculptures to a booth.

use std::path::PathBuf;

/// The settings for sending sculptures to an exhibition's booth.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct BoothSettings {
    /// The file that enrolment wrote; if not set, the one beside the saved sessions.
    pub enrolment: Option<PathBuf>,
    /// `true` if traces are sent.
    pub sends_traces: bool,
    /// The days for which a sculpture is kept on this device after the booth has received it.
    pub grace_days: u32,
    /// The most megabytes that all parcels may take together.
    pub space_mb: u32,
}

impl BoothSettings {
    /// Returns the settings before any value is stored.
    pub(super) const fn unset() -> Self {
        BoothSettings { enrolment: None, sends_traces: false, grace_days: 0, space_mb: 0 }
    }
}
