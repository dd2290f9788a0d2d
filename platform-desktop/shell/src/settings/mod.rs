//! The settings of both shells, from the TOML file `paros.toml` and other sources.
//!
//! Settings are merged from layers; the last layer that sets a setting wins. The layers are, in order: the
//! headset's package, the file, the headset's managed configuration (Android's `RestrictionsManager`), and
//! the command line. A setting that no layer sets has its default.
//!
//! Faults are contained: a file that is not valid TOML is ignored as a whole; in a valid one, only invalid
//! values and unknown keys are ignored. Each fault is reported with its place and with what was expected. On
//! a headset the file lies beside the folder of the sessions and is read at each start:
//!
//! ```text
//! adb push paros.toml /sdcard/Android/data/org.paros.studio/files/paros.toml
//! ```

mod booth;
mod contradiction;
mod describe;
mod layer;
mod pin;
mod record;
pub mod table;
pub mod value;
mod visits;

use std::fmt;
use std::path::PathBuf;
use std::time::Duration;

use paros_core::session::SessionMode;

pub use booth::BoothSettings;
pub use contradiction::Contradiction;
pub use describe::{
    FLEET_FILE_KEY, RestrictionFiles, write_documentation, write_restrictions, write_template,
};
pub use layer::{FilePlace, LayerEntry, MAX_BYTES, SettingsFault, SettingsLayer};
pub use pin::{PIN_DIGITS, StaffPin};
use table::{SETTINGS, Setting};
pub use visits::{MAX_STARTS, VisitSettings, VisitStart, plan_changes};

use crate::headset::foveation::FoveationLevel;

/// The file's name.
pub const FILE_NAME: &str = "paros.toml";

/// The settings of a shell.
#[derive(Clone, PartialEq, Debug)]
pub struct Settings {
    /// The voxels along an edge, one of [`crate::sizes::GRID_SIDES`]; `None` leaves the choice to the shell.
    pub size: Option<usize>,
    /// The mode in which a headset's sessions start; in visit mode, the mode if the visitor chooses nothing.
    pub mode: SessionMode,
    /// The time that a headset must be off, asleep or motionless for its next user to count as another
    /// visitor.
    pub handover_after: Duration,
    /// The length, in millimetres, of the virtual string by which hands pull their bits, which steadies them;
    /// 0 for none.
    pub steady_mm: u8,
    /// `true` if a headset's room is moved by a height step for visitors who sit or are tall.
    pub snap_heights: bool,
    /// The display refresh rate to request from a headset, in hertz.
    pub refresh_rate_hz: u32,
    /// The least foveation level; see [`Foveation::choose`](crate::headset::foveation::Foveation::choose).
    pub foveation: Option<FoveationLevel>,
    /// The least scale of a picture's sides for dynamic resolution, in percent.
    pub least_resolution_percent: u32,
    /// The samples per pixel, 2 or 4.
    pub samples: u32,
    /// `true` if depth is submitted to the compositor too.
    pub submit_depth: bool,
    /// The volume of the sound, in percent; 0 for no sound.
    pub sound_percent: u32,
    /// The file for the last session's trace.
    pub record: Option<PathBuf>,
    /// `true` if the window is a kiosk that visitors use one after the other.
    pub kiosk: bool,
    /// The time without input after which a kiosk's visitor counts as gone.
    pub kiosk_handover_after: Duration,
    /// The settings of visits; `None` outside visit mode.
    pub visits: Option<VisitSettings>,
    /// The settings for sending sculptures to a booth, if the device is enrolled at one.
    pub booth: BoothSettings,
}

/// A setting's value and its origin.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SettingOrigin {
    /// The value as TOML; for an unset value, a text that says what is used instead.
    pub value: String,
    /// `true` if there is a value of the setting's kind.
    pub is_set: bool,
    /// The source of the layer that sets it; `None` for the default.
    pub source: Option<String>,
    /// The value's place in the source; `None` if the source is not a file.
    pub place: Option<FilePlace>,
}

/// The settings merged from all layers, with their origins and messages.
#[derive(Clone, Debug)]
pub struct LoadedSettings {
    /// The settings.
    pub settings: Settings,
    /// The value and origin of each setting, in the order of [`SETTINGS`].
    pub origins: Vec<SettingOrigin>,
    /// Log lines: the settings of each layer, one line per layer.
    pub told: Vec<String>,
    /// Log lines: one for each fault and each contradiction.
    pub faults: Vec<String>,
    /// The contradictions between settings.
    pub contradictions: Vec<Contradiction>,
}

impl LoadedSettings {
    /// Merges layers. A later layer wins.
    #[must_use]
    pub fn merge(layers: &[SettingsLayer]) -> Self {
        let mut settings = table::unset_settings();
        let mut origins = Vec::new();
        for (index, setting) in SETTINGS.iter().enumerate() {
            let found = layers.iter().rev().find_map(|layer| Some((layer, layer.find(index)?)));
            origins.push(match found {
                Some((layer, entry)) => {
                    (setting.store)(&mut settings, entry.value.clone());
                    SettingOrigin {
                        value: entry.value.to_string(),
                        is_set: true,
                        source: Some(layer.source.clone()),
                        place: entry.place,
                    }
                }
                None => store_default(setting, &mut settings),
            });
        }
        let contradictions = contradiction::settle(&mut settings, &mut origins);
        let faults = layers.iter().flat_map(|layer| describe_faults(layer, &origins));
        let faults = faults.chain(contradictions.iter().map(Contradiction::describe)).collect();
        let told = layers.iter().filter_map(describe_layer).collect();
        LoadedSettings { settings, origins, told, faults, contradictions }
    }

    /// Returns `true` if a layer sets the setting with this name; otherwise it has its default.
    #[must_use]
    pub fn is_set(&self, name: &str) -> bool {
        let mut all = SETTINGS.iter().zip(&self.origins);
        all.any(|(setting, origin)| setting.name == name && origin.source.is_some())
    }

    /// Returns all lines for the log.
    pub fn log_lines(&self) -> impl Iterator<Item = &str> {
        self.told.iter().chain(&self.faults).map(String::as_str)
    }
}

/// The defaults of the table.
impl Default for Settings {
    fn default() -> Self {
        LoadedSettings::merge(&[]).settings
    }
}

impl SettingsFault {
    /// Returns the fault with its source and place, in a compiler's format.
    #[must_use]
    pub fn describe(&self, source: &str) -> String {
        match self.place {
            Some(place) => format!("{source}:{place}: {}", self.why),
            None => format!("{source}: {}", self.why),
        }
    }
}

impl fmt::Display for SettingOrigin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.source, self.place) {
            (Some(source), Some(place)) => write!(f, "{source}:{place}"),
            (Some(source), None) => f.write_str(source),
            (None, _) => f.write_str("default"),
        }
    }
}

fn store_default(setting: &Setting, settings: &mut Settings) -> SettingOrigin {
    // An invalid default is a fault of the table, which the table's tests find.
    let value = setting.default.to_raw().and_then(|raw| setting.kind.check(&raw, &[]).ok());
    let is_set = value.is_some();
    if let Some(value) = value {
        (setting.store)(settings, value);
    }
    SettingOrigin { value: setting.default.to_string(), is_set, source: None, place: None }
}

/// Returns a line for each fault of a layer: the fault, and the value that is used instead.
fn describe_faults(layer: &SettingsLayer, origins: &[SettingOrigin]) -> Vec<String> {
    let describe = |fault: &SettingsFault| {
        let holds = fault.setting.and_then(|setting| {
            let index = SETTINGS.iter().position(|other| core::ptr::eq(other, setting))?;
            let origin = origins.get(index)?;
            Some(format!("; {} holds ({origin})", origin.value))
        });
        let holds = match fault.costs_layer {
            true => "; it counts for nothing".into(),
            false => holds.unwrap_or_default(),
        };
        fault.describe(&layer.source) + &holds
    };
    layer.faults.iter().map(describe).collect()
}

/// Returns a line with the settings of a layer; `None` for a layer that has only faults.
fn describe_layer(layer: &SettingsLayer) -> Option<String> {
    let set = layer.entries.iter().map(|entry| format!("{} = {}", entry.setting.name, entry.value));
    let set: Vec<_> = set.collect();
    if set.is_empty() && !layer.faults.is_empty() {
        return None;
    }
    let set = if set.is_empty() { "no settings".into() } else { set.join(", ") };
    Some(format!("{}: {set}", layer.source))
}

#[cfg(test)]
mod tests;
