//! The flags of `paros-quest` on Linux. Flags that are settings are checked in the same way as settings, and
//! override those of the file.

mod visits;

use std::path::{Path, PathBuf};

use clap::Parser;
use paros_shell::settings::table::find_setting;
use paros_shell::settings::value::RawValue;
use paros_shell::settings::{LoadedSettings, SettingsLayer};
use paros_shell::studio_paths::StudioPaths;

use crate::options::ShellOptions;
use visits::VisitArgs;

/// Sculpt in a headset, or replay a recorded session.
#[derive(Debug, Parser)]
#[command(name = "paros-quest", version)]
pub struct HeadsetArgs {
    /// Voxels along an edge: 128, or 256 for a fast machine.
    #[arg(long, value_parser = check_setting("size"))]
    pub size: Option<String>,
    /// Folder for sessions and sculptures, instead of the user's own folders.
    ///
    /// At the start, a saved session in the folder is finished as a former visitor's if the handover time has
    /// passed or the machine was rebooted.
    #[arg(long, value_name = "DIR")]
    pub folder: Option<PathBuf>,
    /// Settings file, instead of `paros.toml` in the folder. `paros settings template` writes a template.
    #[arg(long, value_name = "FILE", conflicts_with = "replay")]
    pub settings: Option<PathBuf>,
    /// Mode in which sessions start: `free`, `creative`, or the name of a hidden figure.
    #[arg(long, value_parser = check_setting("mode"))]
    pub mode: Option<String>,
    /// Seconds off the head, asleep or without motion after which the next user counts as another visitor.
    ///
    /// For another visitor, the sculpture is finished and saved, and a new session starts.
    #[arg(long, value_name = "SECONDS", value_parser = check_setting("handover_seconds"))]
    pub handover: Option<String>,
    /// Start a new session, and write its trace to a file.
    #[arg(long, value_name = "FILE", conflicts_with = "replay")]
    pub record: Option<PathBuf>,
    /// Steady the hands: a running bit is pulled behind its hand on a string of MM millimetres, at most 40.
    #[arg(long, value_name = "MM", value_parser = check_setting("steady_mm"))]
    pub steady: Option<String>,
    /// Replay a trace at full speed without a headset, and stop at the first tick that differs from the
    /// recording.
    #[arg(long, value_name = "TRACE", requires = "digests")]
    pub replay: Option<PathBuf>,
    /// Write each tick's digest to a file, one per line.
    #[arg(long, value_name = "FILE", requires = "replay")]
    pub digests: Option<PathBuf>,
    /// Refresh rate of the display in hertz, if the display offers several.
    #[arg(long, value_name = "HERTZ", value_parser = check_setting("refresh_rate_hz"))]
    pub rate: Option<String>,
    /// Submit depth to the compositor too. Pixels then have one sample.
    #[arg(long)]
    pub depth: bool,
    /// Level of foveation (coarser shading away from the image centre): auto, off, low, medium or high.
    ///
    /// Heat and a low battery raise the level, unless it is off. With `auto` (the default), an integrated GPU
    /// starts at medium, and others at off.
    #[arg(long, value_name = "LEVEL", value_parser = check_setting("foveation"))]
    pub foveation: Option<String>,
    /// Lowest image width and height, in percent of the recommended ones, 85 to 100.
    ///
    /// The resolution is lowered while frames would be late otherwise.
    #[arg(long, value_name = "PERCENT", value_parser = check_setting("least_resolution_percent"))]
    pub least_resolution: Option<String>,
    /// Samples per pixel, 2 or 4.
    #[arg(long, value_parser = check_setting("samples"))]
    pub samples: Option<String>,
    /// Read commands from standard input, for tests.
    #[arg(long, hide = true)]
    pub script: bool,
    #[command(flatten)]
    visits: VisitArgs,
    /// Enable Vulkan's validation layers.
    #[arg(long, hide = true)]
    pub validation: bool,
}

impl HeadsetArgs {
    /// Reads the settings from the file and from these flags.
    ///
    /// # Errors
    /// The file named by `--settings` doesn't exist.
    pub fn load_settings(&self) -> Result<LoadedSettings, String> {
        let default = || match &self.folder {
            Some(folder) => StudioPaths::inside_folder(folder).settings,
            None => StudioPaths::for_user(None).settings,
        };
        let path = self.settings.clone().unwrap_or_else(default);
        let file = SettingsLayer::read_file(&path, &[]);
        if file.is_none() && self.settings.is_some() {
            return Err(format!("{}: there is no such file", path.display()));
        }
        let layers: Vec<_> = file.into_iter().chain([self.to_layer()]).collect();
        let mut loaded = LoadedSettings::merge(&layers);
        // The user knows the command line: don't log it.
        loaded.told.retain(|line| !line.starts_with(COMMAND_LINE));
        loaded.resolve_record(path.parent().unwrap_or(Path::new("")), &[]);
        if let Some(record) = &self.record {
            loaded.settings.record = Some(record.clone());
        }
        Ok(loaded)
    }

    /// Returns the shell's options from settings and from flags that aren't settings. Not for a replay.
    #[must_use]
    pub fn to_options(&self, loaded: &LoadedSettings) -> ShellOptions {
        let settings = ShellOptions::from_settings(&loaded.settings);
        // A scripted run is silent unless its settings set the volume.
        let is_heard = !self.script || loaded.is_set("sound_percent");
        ShellOptions {
            folder: self.folder.clone(),
            sound_percent: if is_heard { settings.sound_percent } else { 0 },
            test_commands: self.script,
            visits: self.visits.to_options().or(settings.visits),
            validation: self.validation,
            ..settings
        }
    }

    /// Returns the flags as a layer of settings, without `record`: its path is relative to the current
    /// folder, not to the settings file.
    fn to_layer(&self) -> SettingsLayer {
        let depth = self.depth.then(|| "true".to_owned());
        let flags = [
            ("size", &self.size),
            ("mode", &self.mode),
            ("handover_seconds", &self.handover),
            ("steady_mm", &self.steady),
            ("refresh_rate_hz", &self.rate),
            ("least_resolution_percent", &self.least_resolution),
            ("samples", &self.samples),
            ("submit_depth", &depth),
            ("foveation", &self.foveation),
        ];
        let given = flags.into_iter().filter_map(|(name, text)| Some((name, text.as_deref()?)));
        SettingsLayer::from_texts(COMMAND_LINE, given, &[])
    }
}

/// The name of the settings layer that holds the flags.
const COMMAND_LINE: &str = "command line";

/// Returns the parser of a flag that is a setting: it checks the text and returns it unchanged.
fn check_setting(name: &'static str) -> impl Fn(&str) -> Result<String, String> + Clone {
    move |text| {
        let kind = find_setting(name).ok_or("no setting")?.kind;
        kind.check(&RawValue::Untyped(text.into()), &[]).map(|_| text.to_owned())
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::time::Duration;

    use clap::Parser;
    use paros_core::session::SessionMode;
    use paros_shell::headset::foveation::FoveationLevel;
    use paros_shell::settings::FILE_NAME;

    use super::HeadsetArgs;
    use crate::options::ShellOptions;

    /// Parses a command line, whose folder may contain a settings file.
    fn parse(words: &str) -> Result<ShellOptions, String> {
        let words = format!("paros-quest {words}");
        let args = HeadsetArgs::try_parse_from(words.split_whitespace());
        let args = args.map_err(|error| error.to_string())?;
        Ok(args.to_options(&args.load_settings()?))
    }

    #[test]
    fn no_words_are_the_defaults() {
        let folder = Some("/no/such/folder".into());
        let expected = ShellOptions { folder, ..ShellOptions::default() };
        assert_eq!(parse("--folder /no/such/folder"), Ok(expected));
    }

    #[test]
    fn flags_win_over_the_file_of_the_folder_or_the_one_that_is_named() {
        let folder = std::env::temp_dir().join(format!("paros-flags-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let text =
            "mode = \"owl\"\nhandover_seconds = 120\nrecord = \"own.trace\"\nsteady_mm = 99\n";
        fs::write(folder.join(FILE_NAME), text).expect("room on the disk");
        fs::write(folder.join("other.toml"), "mode = \"creative\"").expect("room on the disk");
        let at = folder.display();
        let expected = ShellOptions {
            folder: Some(folder.clone()),
            mode: SessionMode::Constrained { figure: 8 },
            handover_after: Duration::from_secs(60),
            record: Some(folder.join("own.trace")),
            submit_depth: true,
            foveation: Some(FoveationLevel::Low),
            ..ShellOptions::default()
        };
        let words = format!("--folder {at} --handover 60 --depth --foveation low");
        assert_eq!(parse(&words), Ok(expected));
        let other = parse(&format!("--settings {at}/other.toml --record here"));
        let other = other.expect("a file");
        assert_eq!((other.mode, other.record), (SessionMode::Creative, Some("here".into())));
        // A scripted run is silent unless its settings set the volume.
        let silent = parse(&format!("--settings {at}/other.toml --script")).expect("a file");
        assert_eq!((other.sound_percent, silent.sound_percent), (70, 0));
        fs::write(folder.join("loud.toml"), "sound_percent = 40").expect("room on the disk");
        let loud = parse(&format!("--settings {at}/loud.toml --script")).expect("a file");
        assert_eq!(loud.sound_percent, 40);
        let why = parse(&format!("--settings {at}/none.toml")).expect_err("no file");
        assert_eq!(why, format!("{at}/none.toml: there is no such file"));
        fs::remove_dir_all(&folder).expect("it is ours");
    }

    #[test]
    fn what_is_wrong_says_what_was_expected() {
        for (words, expected) in [
            ("--rate abc", "for '--rate <HERTZ>': abc, expected a whole number from 60 to 144"),
            ("--rate 0", "expected a whole number from 60"),
            ("--rate inf", "expected a whole number from 60"),
            ("--handover soon", "expected a whole number from 1 to 3600"),
            ("--steady 41", "expected a whole number from 0 to 40"),
            ("--steady soft", "expected a whole number from 0 to 40"),
            ("--mode cubes", "expected free, creative or one of"),
            ("--foveation some", "expected one of \"auto\", \"off\""),
            ("--size 64", "expected 128 or 256"),
        ] {
            let why = parse(words).expect_err(words);
            assert!(why.contains(expected), "{why}");
        }
    }
}
