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
    /// Mesh or volume to open.
    #[arg(value_name = "FILE")]
    file: Option<PathBuf>,
    /// Folder for finished sculptures, instead of `Paros` in the home folder.
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Voxels along an edge: 128 or 256.
    ///
    /// The default is the size of the sculpture under way. If there is none, it is 256 if this machine draws
    /// that fast enough, and otherwise 128.
    #[arg(long, value_parser = volume::grid_side_parser())]
    size: Option<usize>,
    /// Run as a kiosk: one visitor after the other, in full screen, without files and developers' keys.
    ///
    /// After 90 seconds without input (setting `kiosk_seconds`), the sculpture is finished and saved, and the
    /// start screen is shown again.
    #[arg(long)]
    kiosk: bool,
    /// Hold visits, as in an exhibition.
    ///
    /// Before a visit, a stone is carved as a demonstration. At the end, the visitor gets a badge with which
    /// staff find the sculpture.
    #[arg(long)]
    visits: bool,
    /// Settings file, instead of `paros.toml` in the folder of saved sessions; see `paros settings --help`.
    /// Command-line arguments override the file.
    #[arg(long, value_name = "FILE")]
    settings: Option<PathBuf>,
    /// Write the trace of the last session to a file when the window is closed.
    #[arg(long, value_name = "TRACE")]
    record: Option<PathBuf>,
    /// Script that replaces user input, one command per line; `-` is standard input.
    #[arg(long, value_name = "FILE", hide = true)]
    script: Option<PathBuf>,
    /// Enable Vulkan's validation layers.
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
