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
    /// One folder for all files, instead of the user's own. With it the headset is one that visitors share: what they
    /// left is finished where it can't be told that it is the same one's.
    pub folder: Option<PathBuf>,
    /// How sessions start.
    pub mode: SessionMode,
    /// How long the headset must be unused for whoever uses it next to be another visitor.
    pub handover_after: Duration,
    /// The visits that are held; without them sessions start and end by the headset's use and its menu button.
    pub visits: Option<VisitOptions>,
    /// How sculptures go to a booth, where the device is enrolled at one.
    pub booth: BoothSettings,
    /// Where the session's trace is written; the session starts anew then.
    pub record: Option<PathBuf>,
    /// The string on which hands draw their bits, in millimetres; 0 for hands that aren't steadied.
    pub string_mm: u8,
    /// Whether the room is a step lower or higher for visitors who sit or are tall.
    pub snap_heights: bool,
    /// The display refresh rate that is requested, in hertz.
    pub refresh_rate: f32,
    /// Whether depth is submitted to the compositor too; pixels have one sample then.
    pub submit_depth: bool,
    /// The least foveation level; see [`Foveation::choose`](crate::foveation::Foveation::choose).
    pub foveation: Option<FoveationLevel>,
    /// The least part of a picture's sides that is drawn, in hundredths.
    pub least_resolution_percent: u32,
    /// Samples of a pixel, 2 or 4.
    pub samples: u32,
    /// The render path of the sculpture.
    pub path: RenderPath,
    /// How loud it is, in hundredths; 0 for no sound.
    pub sound_percent: u32,
    /// Whether commands are read from standard input, for tests.
    pub test_commands: bool,
    /// Whether Vulkan's validation layer is enabled; each of its messages is an error.
    pub validation: bool,
}

impl ShellOptions {
    /// The options that settings ask for, all else as by default.
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
