//! `paros window`: a studio to sculpt in.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use paros_headless::Error;
use paros_shell::durable::WriteTarget;
use paros_shell::settings::{LoadedSettings, SettingsLayer};
use paros_shell::sizes::GRID_SIDES;
use paros_shell::{rmap, with_size};
use paros_visit::VisitOptions;

use super::{demo, drawing, settings, volume};
use crate::window::{self, SizeChoice, WindowError, WindowOptions};

/// Sculpt in a window, with mouse and keyboard.
#[derive(Debug, Default, clap::Args)]
pub(super) struct Args {
    /// A mesh or a volume to begin with.
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// The folder for finished sculptures, instead of `Paros` at home.
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Voxels along an edge, 128 or 256. Without it, those of the sculpture under way; else 256 where the machine draws
    /// it at its rate.
    #[arg(long, value_parser = volume::grid_side_parser())]
    size: Option<usize>,
    /// For visitors, one after the other: on the full screen, without files and developers' keys. Once nobody has touched
    /// it for 90 seconds (`kiosk_seconds` of the settings), the sculpture is finished and kept, and the start shown again.
    #[arg(long)]
    kiosk: bool,
    /// Visits, as an exhibition has them: from a stone that is carved for those who look on to a badge by which the
    /// visitor's sculpture is found again.
    #[arg(long)]
    visits: bool,
    /// A file of settings, instead of `paros.toml` in the folder of saved sessions; `paros settings` tells more. What is
    /// asked for here wins.
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Write the trace of the last session to a file, when the window is closed.
    #[arg(long, value_name = "TRACE")]
    record: Option<PathBuf>,
    /// What is done instead of by hand, line by line; `-` is standard input.
    #[arg(long, value_name = "FILE", hide = true)]
    script: Option<PathBuf>,
    /// Have Vulkan's validation look on.
    #[arg(long, hide = true)]
    validation: bool,
}

impl Args {
    /// Returns the arguments that open a file, in a volume's own size and with defaults for the rest.
    ///
    /// # Errors
    /// The file doesn't exist and has no extension: it is probably a misspelt command.
    pub(super) fn for_file(file: &Path) -> Result<Self, Error> {
        if file.extension().is_none() && !file.exists() {
            let word = file.display();
            return Err(Error::Input(format!(
                "{word}: neither a command nor a file; `paros --help` has the commands"
            )));
        }
        let size = rmap::read_header(file).ok().map(|header| header.grid_side);
        Ok(Args { file: Some(file.into()), size, ..Args::default() })
    }
}

pub(super) fn run(args: &Args) -> Result<String, Error> {
    open_window(args).map_err(|closed| match closed {
        WindowError::Unavailable(why) => Error::Failure(format!("no window can be opened: {why}")),
        WindowError::Failed(error) => error,
    })
}

/// Opens the window; runs the demo if no window can be opened.
pub(super) fn run_window_or_demo() -> Result<String, Error> {
    match open_window(&Args::default()) {
        Ok(report) => Ok(report),
        Err(WindowError::Failed(error)) => Err(error),
        Err(WindowError::Unavailable(why)) => {
            // Standard error may be closed.
            let _ = writeln!(io::stderr(), "no window can be opened ({why}): here is the demo");
            demo::run(&demo::Args::default())
        }
    }
}

fn open_window(args: &Args) -> Result<String, WindowError> {
    if let Some(record) = &args.record {
        // Check before the sculpting, not after it.
        WriteTarget::resolve_and_check_writable(record)
            .map_err(|error| WindowError::Failed(error.into()))?;
    }
    let loaded = load_settings(args)?;
    // A script is silent unless the settings set the loudness.
    let is_heard = args.script.is_none() || loaded.is_set("sound_percent");
    let LoadedSettings { settings, faults, .. } = loaded;
    let size = args.size.or(settings.size);
    // Scripts must not depend on the machine.
    let is_chosen = size.is_none() && args.script.is_none();
    let size_choice = is_chosen.then(|| SizeChoice::choose(args.folder.as_deref()));
    let size = size.or(size_choice.map(|choice| choice.grid_side));
    let visits = settings.visits.as_ref().map(VisitOptions::of_settings);
    let options = WindowOptions {
        size_choice,
        file: args.file.clone(),
        folder: args.folder.clone(),
        record: args.record.clone().or(settings.record),
        script: args.script.clone(),
        kiosk: (args.kiosk || settings.kiosk).then_some(settings.kiosk_handover_after),
        visits,
        // A script's window isn't a booth's headset, unless a settings file is named for it.
        booth: (args.script.is_none() || args.settings.is_some()).then_some(settings.booth),
        sound_percent: if is_heard { settings.sound_percent } else { 0 },
        settings_faults: faults,
        validation: args.validation,
    };
    with_size!(size.unwrap_or(GRID_SIDES[0]), N => {
        window::run_window::<N>(&options, drawing::draw_portrait_png)
    })
}

/// Reads the settings, and logs them and their faults to standard error. Scripts don't read the user's
/// settings.
fn load_settings(args: &Args) -> Result<LoadedSettings, WindowError> {
    let default = || args.script.is_none().then(settings::default_file);
    // The flag is one settings layer, so that the other settings of a file apply too.
    let of_flags = args.visits.then(|| SettingsLayer::parse_toml("--visits", "visits = true", &[]));
    let Some(path) = args.settings.clone().or_else(default) else {
        return Ok(LoadedSettings::merge(&Vec::from_iter(of_flags)));
    };
    let layer = SettingsLayer::read_file(&path, &[]);
    if layer.is_none() && args.settings.is_some() {
        return Err(WindowError::Failed(settings::missing_file(&path)));
    }
    let layers: Vec<_> = layer.into_iter().chain(of_flags).collect();
    let mut loaded = LoadedSettings::merge(&layers);
    loaded.resolve_record(path.parent().unwrap_or(Path::new("")), &[]);
    for line in loaded.log_lines() {
        // Standard error may be closed.
        let _ = writeln!(io::stderr(), "paros: {line}");
    }
    Ok(loaded)
}

#[cfg(test)]
mod tests {
    use paros_core::session::SessionMode;

    use super::*;

    /// Tests visits requested on the command line alone, and together with a file that doesn't request
    /// visits.
    #[test]
    fn visits_that_are_asked_for_have_the_settings_of_a_file() {
        let file = std::env::temp_dir().join(format!("paros-visits-{}.toml", std::process::id()));
        let text = "staff_pin = \"4711\"\nstarts = [\"free\"]\n";
        paros_shell::durable::write_file(&file, text.as_bytes()).expect("room on the disk");
        let load = |visits, settings| {
            let script = Some(PathBuf::from("-"));
            let args = Args { visits, settings, script, ..Args::default() };
            let Ok(loaded) = load_settings(&args) else { panic!("settings") };
            loaded.settings.visits.as_ref().map(VisitOptions::of_settings)
        };
        let of_file = load(true, Some(file.clone())).expect("visits");
        assert!(of_file.staff_pin.is_some());
        assert_eq!(of_file.starts, [SessionMode::FreeForm]);
        assert_eq!(load(true, None), Some(VisitOptions::default()));
        assert_eq!(load(false, Some(file.clone())), None);
        std::fs::remove_file(file).expect("it is there");
    }
}
