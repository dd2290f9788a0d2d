//! The options that the shell is started with.

use std::path::PathBuf;
use std::time::Duration;

use paros_core::session::SessionMode;
use paros_shaders::gpu::RenderPath;
use paros_shell::settings::{BoothSettings, Settings};
use paros_visit::VisitOptions;

use crate::foveation::FoveationLevel;

/// Options of a run.
#[derive(Clone, PartialEq, Debug)]
pub struct ShellOptions {
    /// One folder for all files, instead of the user's own. If set, visitors share the headset: a session
    /// that was found at the start is finished unless it belongs to the current visitor.
    pub folder: Option<PathBuf>,
    /// The mode in which sessions start.
    pub mode: SessionMode,
    /// The time without use after which the next user counts as another visitor.
    pub handover_after: Duration,
    /// The options of visits; without them sessions start and end by the headset's use and its menu button.
    pub visits: Option<VisitOptions>,
    /// The settings for sending sculptures to a booth, if the device is enrolled at one.
    pub booth: BoothSettings,
    /// The file for the session's trace; if set, the session restarts.
    pub record: Option<PathBuf>,
    /// The length of the string on which hands draw their bits, in millimetres; 0 turns steadying off.
    pub string_mm: u8,
    /// `true` if the room is lowered for seated visitors and raised for tall ones.
    pub snap_heights: bool,
    /// The display refresh rate that is requested, in hertz.
    pub refresh_rate: f32,
    /// `true` if depth is also submitted to the compositor; pixels then have one sample.
    pub submit_depth: bool,
    /// The least foveation level; see [`Foveation::choose`](crate::foveation::Foveation::choose).
    pub foveation: Option<FoveationLevel>,
    /// The lower limit of the resolution scale, in percent of each side.
    pub least_resolution_percent: u32,
    /// Samples of a pixel, 2 or 4.
    pub samples: u32,
    /// The render path of the sculpture.
    pub path: RenderPath,
    /// The volume in percent; 0 for no sound.
    pub sound_percent: u32,
    /// `true` if commands are read from standard input, for tests.
    pub test_commands: bool,
    /// `true` if Vulkan's validation layer is enabled; each of its messages is an error.
    pub validation: bool,
}

impl ShellOptions {
    /// Returns the options for these settings; all others have their defaults.
    #[must_use]
    pub fn from_settings(settings: &Settings) -> Self {
        ShellOptions {
            folder: None,
            mode: settings.mode,
            handover_after: settings.handover_after,
            visits: settings.visits.as_ref().map(VisitOptions::of_settings),
            booth: settings.booth.clone(),
            record: settings.record.clone(),
            string_mm: settings.steady_mm,
            snap_heights: settings.snap_heights,
            refresh_rate: settings.refresh_rate_hz as f32,
            submit_depth: settings.submit_depth,
            foveation: settings.foveation,
            least_resolution_percent: settings.least_resolution_percent,
            samples: settings.samples,
            path: RenderPath::Fast,
            sound_percent: settings.sound_percent,
            test_commands: false,
            validation: false,
        }
    }
}

impl Default for ShellOptions {
    fn default() -> Self {
        ShellOptions::from_settings(&Settings::default())
    }
}
