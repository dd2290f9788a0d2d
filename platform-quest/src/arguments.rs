//! The shell's flags, on the command line or in a file; see [`crate::settings`].

use std::path::PathBuf;
use std::time::Duration;

use clap::Parser;
use paros_core::limits::MAX_STRING_MM;
use paros_core::session::{SessionMode, TICK_RATE};
use paros_shell::headset::visit::DEFAULT_HANDOVER;
use paros_shell::modes::parse_mode;
use paros_shell::sizes::{GRID_SIDE_NAMES, grid_side_or_default};

use crate::foveation::FoveationLevel;
use crate::options::ShellOptions;

/// Sculpt in a headset, or play a recorded session again.
#[derive(Debug, Parser)]
#[command(name = "paros-quest", version)]
pub struct HeadsetArgs {
    /// Voxels along an edge: 128, or 256 for a fast machine.
    #[arg(long, default_value = "128", value_parser = GRID_SIDE_NAMES)]
    pub size: String,
    /// One folder for sessions and sculptures, instead of the user's own. In it a session that is found after the
    /// handover time, or another boot, is a former visitor's, and is finished.
    #[arg(long, value_name = "DIR")]
    pub folder: Option<PathBuf>,
    /// How sessions start: `free`, `creative`, or the name of a hidden figure.
    #[arg(long, default_value = "free", value_parser = parse_mode)]
    pub mode: SessionMode,
    /// For how many seconds the headset must be off, asleep or without motion for who uses it next to be another
    /// visitor: the sculpture is finished and kept, and a new session starts.
    #[arg(long, value_name = "SECONDS", default_value_t = DEFAULT_HANDOVER.as_secs(),
        value_parser = parse_seconds)]
    pub handover: u64,
    /// Write the trace of the session to a file; it starts anew.
    #[arg(long, value_name = "FILE", conflicts_with = "replay")]
    pub record: Option<PathBuf>,
    /// Steady the hands: a running bit is drawn behind its hand on a string of so many millimetres, 40 at most.
    #[arg(long, value_name = "MM", default_value_t = 0, value_parser = parse_string)]
    pub steady: u8,
    /// Play a trace again, as fast as it goes and without a headset; stop at the first tick that
    /// differs from the recording.
    #[arg(long, value_name = "TRACE", requires = "digests")]
    pub replay: Option<PathBuf>,
    /// Write every tick's digest to a file, one a line.
    #[arg(long, value_name = "FILE", requires = "replay")]
    pub digests: Option<PathBuf>,
    /// The display's rate, in hertz, where there is a choice.
    #[arg(long, value_name = "HERTZ", default_value_t = TICK_RATE as f32,
        value_parser = parse_refresh_rate)]
    pub rate: f32,
    /// Give the compositor depth too; pixels have one sample then.
    #[arg(long)]
    pub depth: bool,
    /// How coarsely pictures are shaded away from their middle: off, low, medium or high. Heat and a
    /// low battery raise it, unless it is off; without it there is none until they do.
    #[arg(long, value_name = "LEVEL", value_parser = parse_foveation)]
    pub foveation: Option<FoveationLevel>,
    /// Take commands from standard input, for tests.
    #[arg(long, hide = true)]
    pub script: bool,
    /// Have Vulkan's validation look on.
    #[arg(long, hide = true)]
    pub validation: bool,
}

impl HeadsetArgs {
    /// Voxels along an edge.
    #[must_use]
    pub fn grid_size(&self) -> usize {
        grid_side_or_default(&self.size)
    }

    /// The options of a run that is no replay.
    #[must_use]
    pub fn to_options(&self) -> ShellOptions {
        ShellOptions {
            folder: self.folder.clone(),
            mode: self.mode,
            handover_after: Duration::from_secs(self.handover),
            record: self.record.clone(),
            string_mm: self.steady,
            refresh_rate: self.rate,
            submit_depth: self.depth,
            foveation: self.foveation,
            test_commands: self.script,
            validation: self.validation,
            ..ShellOptions::default()
        }
    }
}

fn parse_foveation(name: &str) -> Result<FoveationLevel, String> {
    let found = FoveationLevel::NAMES.into_iter().find(|(named, _)| *named == name);
    found.map(|(_, level)| level).ok_or_else(|| "expected off, low, medium or high".into())
}

fn parse_refresh_rate(word: &str) -> Result<f32, String> {
    let rate = word.parse().ok().filter(|rate: &f32| rate.is_finite() && *rate > 0.0);
    rate.ok_or_else(|| "expected a number of hertz above 0, such as 72 or 90".into())
}

fn parse_string(word: &str) -> Result<u8, String> {
    let string = word.parse().ok().filter(|mm| *mm <= MAX_STRING_MM);
    string.ok_or_else(|| format!("expected 0 to {MAX_STRING_MM} whole millimetres"))
}

fn parse_seconds(word: &str) -> Result<u64, String> {
    word.parse()
        .map_err(|_| format!("expected whole seconds, such as {}", DEFAULT_HANDOVER.as_secs()))
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::HeadsetArgs;
    use crate::options::ShellOptions;

    fn parse(words: &str) -> Result<ShellOptions, String> {
        let args = HeadsetArgs::try_parse_from(format!("paros-quest {words}").split_whitespace());
        args.map(|args| args.to_options()).map_err(|error| error.to_string())
    }

    #[test]
    fn no_words_are_the_defaults() {
        assert_eq!(parse(""), Ok(ShellOptions::default()));
    }

    #[test]
    fn what_is_wrong_says_what_was_expected() {
        for (words, expected) in [
            ("--rate abc", "expected a number of hertz above 0, such as 72 or 90"),
            ("--rate 0", "expected a number of hertz"),
            ("--rate inf", "expected a number of hertz"),
            ("--handover soon", "expected whole seconds, such as 45"),
            ("--steady 41", "expected 0 to 40 whole millimetres"),
            ("--steady soft", "expected 0 to 40 whole millimetres"),
            ("--mode cubes", "expected free, creative or one of"),
            ("--foveation some", "expected off, low, medium or high"),
        ] {
            let why = parse(words).expect_err(words);
            assert!(why.contains(expected), "{why}");
        }
    }
}
