//! The settings of both shells: one file of TOML, `paros.toml`, and what else may set the same.
//!
//! A setting has the value of the last layer that sets it: what the headset's package brings, the file, the managed
//! configuration of the headset (Android's `RestrictionsManager`), the command line; where none does, its default.
//!
//! What is wrong costs as little as can be said plainly: a file that is no TOML counts for nothing; in one that is,
//! a setting that doesn't fit counts for nothing, and so does a key that is none. Each is told with its place and with
//! what was expected. On a headset the file lies in the folder of the sessions and is read at each start:
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
    /// Voxels along an edge, one of [`crate::sizes::GRID_SIDES`]; the shell's own choice if not set.
    pub size: Option<usize>,
    /// How a headset's sessions start; in visits, where nothing is chosen.
    pub mode: SessionMode,
    /// How long a headset must be off, asleep or without motion for whoever uses it next to be another visitor.
    pub handover_after: Duration,
    /// The string on which hands draw their bits, in millimetres; 0 for hands that aren't steadied.
    pub steady_mm: u8,
    /// Whether a headset's room is a step lower or higher for visitors who sit or are tall.
    pub snap_heights: bool,
    /// The display refresh rate that a headset is asked for, in hertz.
    pub refresh_rate_hz: u32,
    /// The least foveation level; see [`Foveation::choose`](crate::headset::foveation::Foveation::choose).
    pub foveation: Option<FoveationLevel>,
    /// The least part of a picture's sides that is drawn, in hundredths.
    pub least_resolution_percent: u32,
    /// Samples of a pixel, 2 or 4.
    pub samples: u32,
    /// Whether depth is submitted to the compositor too.
    pub submit_depth: bool,
    /// How loud the studio is, in hundredths; 0 for no sound.
    pub sound_percent: u32,
    /// Where the last session's trace goes.
    pub record: Option<PathBuf>,
    /// Whether visitors use the window one after the other.
    pub kiosk: bool,
    /// How long a kiosk's window must be left alone for its visitor to have gone.
    pub kiosk_handover_after: Duration,
    /// The settings of visits; none where sessions are no visits.
    pub visits: Option<VisitSettings>,
    /// The settings of the way to a booth, where the device is enrolled at one.
    pub booth: BoothSettings,
}

/// Where the value of a setting comes from.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SettingOrigin {
    /// The value, as TOML has it; of one that isn't set, what holds then.
    pub value: String,
    /// Whether there is a value of its kind.
    pub is_set: bool,
    /// The source of the layer that sets it; none if it is the default.
    pub source: Option<String>,
    /// Where it stands there, in a file.
    pub place: Option<FilePlace>,
}

/// The settings of all layers, and what is to be said of them.
#[derive(Clone, Debug)]
pub struct LoadedSettings {
    /// The settings.
    pub settings: Settings,
    /// Where the value of each comes from, in the order of [`SETTINGS`].
    pub origins: Vec<SettingOrigin>,
    /// What each layer sets, a line for each.
    pub told: Vec<String>,
    /// What is wrong, a line for each fault and each contradiction.
    pub faults: Vec<String>,
    /// Which settings contradict each other.
    pub contradictions: Vec<Contradiction>,
}

impl LoadedSettings {
    /// Merges layers, of which a later one wins.
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

    /// Whether a layer sets a setting of this name, so that its default doesn't hold.
    #[must_use]
    pub fn is_set(&self, name: &str) -> bool {
        let mut all = SETTINGS.iter().zip(&self.origins);
        all.any(|(setting, origin)| setting.name == name && origin.source.is_some())
    }

    /// All lines for the log.
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
    /// The fault with its source and its place there, as compilers write them.
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
    // A default that doesn't fit is a fault of the table, which its tests find.
    let value = setting.default.to_raw().and_then(|raw| setting.kind.check(&raw, &[]).ok());
    let is_set = value.is_some();
    if let Some(value) = value {
        (setting.store)(settings, value);
    }
    SettingOrigin { value: setting.default.to_string(), is_set, source: None, place: None }
}

/// A line for each fault of a layer: what is wrong, and what holds all the same.
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

/// A line of what a layer sets; none for one that only has faults.
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
