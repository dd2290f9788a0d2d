//! `paros settings`: checks or shows the settings file, or prints a template.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use paros_headless::Error;
use paros_shell::figures::check_own_figure_names;
use paros_shell::settings::table::{SETTINGS, Setting};
use paros_shell::settings::value::SettingKind;
use paros_shell::settings::{LoadedSettings, SettingsFault, SettingsLayer, write_template};
use paros_shell::studio_paths::StudioPaths;
use serde::Serialize;

/// Check a settings file (paros.toml), show the values in effect, or write a template.
#[derive(Debug, clap::Subcommand)]
pub(super) enum Action {
    /// Check a file, and report the line, column and expected value of each fault.
    Check {
        /// Settings file to check.
        file: PathBuf,
        #[command(flatten)]
        figures: OwnFigures,
        /// Write the result as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Show all settings, and the source of each value.
    Show {
        /// Settings file to show. By default paros.toml in the folder of saved sessions, if it exists.
        file: Option<PathBuf>,
        #[command(flatten)]
        figures: OwnFigures,
        /// Write the result as JSON.
        #[arg(long)]
        json: bool,
    },
    /// Write a template that lists each setting with its default, its bounds and its reason.
    Template,
}

/// The package's own figures, which `mode` may name.
#[derive(Debug, clap::Args)]
pub(super) struct OwnFigures {
    /// Name of a hidden figure of your own, as in the package. May be given several times.
    #[arg(long = "figure", value_name = "NAME")]
    names: Vec<String>,
}

#[derive(Serialize)]
struct Check<'a> {
    file: String,
    /// Number of settings in the file.
    settings: usize,
    faults: Vec<Fault<'a>>,
}

#[derive(Serialize)]
struct Fault<'a> {
    line: Option<usize>,
    column: Option<usize>,
    setting: Option<&'a str>,
    message: &'a str,
}

#[derive(Serialize)]
struct Shown<'a> {
    name: &'a str,
    /// The value as in the file; for a PIN only that it is set; `None` if the file doesn't set it.
    value: Option<serde_json::Value>,
    /// The file and the position in it, or `default`.
    from: String,
    shell: &'a str,
}

pub(super) fn run(action: &Action) -> Result<String, Error> {
    match action {
        Action::Check { file, figures, json } => check(file, &figures.checked()?, *json),
        Action::Show { file, figures, json } => show(file.as_deref(), &figures.checked()?, *json),
        Action::Template => Ok(write_template()),
    }
}

/// Returns the default path of the settings file.
pub(super) fn default_file() -> PathBuf {
    StudioPaths::for_user(None).settings
}

/// Returns the error for a file that doesn't exist.
pub(super) fn missing_file(path: &Path) -> Error {
    Error::Input(format!("{}: cannot read: there is no such file", path.display()))
}

impl OwnFigures {
    fn checked(&self) -> Result<Vec<String>, Error> {
        check_own_figure_names(&self.names).map_err(Error::Input)?;
        Ok(self.names.clone())
    }
}

fn check(file: &Path, own_figures: &[String], as_json: bool) -> Result<String, Error> {
    let mut layer =
        SettingsLayer::read_file(file, own_figures).ok_or_else(|| missing_file(file))?;
    layer.faults.extend(layer.find_contradictions());
    let settings = layer.entries.len();
    if as_json {
        let faults = layer.faults.iter().map(Fault::of).collect();
        let check = Check { file: layer.source.clone(), settings, faults };
        let json = serde_json::to_string_pretty(&check).map_err(Error::failure)? + "\n";
        return end_with_faults(json, &layer);
    }
    let report = match settings {
        1 => format!("{}: 1 setting, nothing wrong\n", layer.source),
        _ => format!("{}: {settings} settings, nothing wrong\n", layer.source),
    };
    if layer.faults.is_empty() { Ok(report) } else { end_with_faults(String::new(), &layer) }
}

fn show(file: Option<&Path>, own_figures: &[String], as_json: bool) -> Result<String, Error> {
    let path = file.map_or_else(default_file, Path::to_owned);
    let layer = SettingsLayer::read_file(&path, own_figures);
    if layer.is_none() && file.is_some() {
        return Err(missing_file(&path));
    }
    let mut layers = Vec::from_iter(layer);
    let loaded = LoadedSettings::merge(&layers);
    let report = if as_json { show_as_json(&loaded)? } else { show_as_lines(&loaded) };
    let Some(layer) = layers.first_mut() else { return Ok(report) };
    layer.faults.extend(layer.find_contradictions());
    end_with_faults(report, layer)
}

fn show_as_lines(loaded: &LoadedSettings) -> String {
    let mut lines = String::new();
    for (setting, origin) in SETTINGS.iter().zip(&loaded.origins) {
        let value = if origin.is_set { "= " } else { "  " }.to_owned() + &origin.value;
        let (name, shell) = (setting.name, setting.scope.name());
        let _ = writeln!(lines, "{name:<25}{value:<16}  # {origin}; {shell}");
    }
    lines
}

fn show_as_json(loaded: &LoadedSettings) -> Result<String, Error> {
    let shown = SETTINGS.iter().zip(&loaded.origins).map(|(setting, origin)| Shown {
        name: setting.name,
        value: origin.is_set.then(|| to_json(setting, &origin.value)).flatten(),
        from: origin.to_string(),
        shell: setting.scope.name(),
    });
    let shown: Vec<_> = shown.collect();
    Ok(serde_json::to_string_pretty(&shown).map_err(Error::failure)? + "\n")
}

/// Converts a value to JSON. TOML and JSON have the same syntax for our values, except for the note that a
/// PIN is set.
fn to_json(setting: &Setting, value: &str) -> Option<serde_json::Value> {
    match setting.kind {
        SettingKind::Pin => Some(value.into()),
        _ => serde_json::from_str(value).ok(),
    }
}

/// Returns the report. If the layer has faults, writes the report and returns the faults as an error.
fn end_with_faults(report: String, layer: &SettingsLayer) -> Result<String, Error> {
    if layer.faults.is_empty() {
        return Ok(report);
    }
    // A reader that closes the pipe early is no error.
    let _ = io::stdout().lock().write_all(report.as_bytes());
    let told: Vec<_> = layer.faults.iter().map(|fault| fault.describe(&layer.source)).collect();
    Err(Error::Input(told.join("\n")))
}

impl<'a> Fault<'a> {
    fn of(fault: &'a SettingsFault) -> Self {
        Fault {
            line: fault.place.map(|place| place.line),
            column: fault.place.map(|place| place.column),
            setting: fault.setting.map(|setting| setting.name),
            message: &fault.why,
        }
    }
}
