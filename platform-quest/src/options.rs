//! What a shell is started with.

use std::path::PathBuf;
use std::time::Duration;

use paros_core::input::Mode;
use paros_shaders::gpu::Path;

use crate::foveation::Foveation;
use crate::visitor::HANDOVER;

/// Settings of a run.
#[derive(Clone, PartialEq, Debug)]
pub struct Options {
    /// One folder for all files, instead of the user's own.
    pub folder: Option<PathBuf>,
    /// How sessions start.
    pub mode: Mode,
    /// How long the headset must be off for who puts it on next to be another visitor.
    pub handover: Duration,
    /// A file for the trace of the session; it starts anew then.
    pub record: Option<PathBuf>,
    /// The display's rate, in hertz, where there is a choice.
    pub rate: f32,
    /// Whether the compositor gets depth too, which costs the pixels' several samples.
    pub depth: bool,
    /// How coarsely pictures are shaded away from their middle; see [`Foveation::under`].
    pub foveation: Option<Foveation>,
    /// How the sculpture is drawn.
    pub path: Path,
    /// Whether commands are read from standard input, for tests; see [`crate::script`].
    pub script: bool,
    /// Whether Vulkan's validation looks on; what it says is an error.
    pub validation: bool,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            folder: None,
            mode: Mode::FreeForm,
            handover: HANDOVER,
            record: None,
            rate: 72.0,
            depth: false,
            foveation: None,
            path: Path::Fast,
            script: false,
            validation: false,
        }
    }
}
