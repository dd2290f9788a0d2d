//! A layer of settings: the settings of one source, and its faults.

use std::fmt;
use std::io::{self, Read};
use std::path::Path;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::LoadedSettings;
use super::table::{SETTINGS, Setting, find_setting, nearest_name};
use super::value::{RawValue, SettingValue};
use crate::durable;

/// The most bytes of a settings file, some seven times the template. A longer file is no settings file.
pub const MAX_BYTES: u64 = 64 << 10;

/// A place in a file.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub struct FilePlace {
    /// The line, from 1.
    pub line: usize,
    /// The character in the line, from 1.
    pub column: usize,
}

/// A setting and the value that a layer gives it.
#[derive(Clone, Debug)]
pub struct LayerEntry {
    /// The setting.
    pub setting: &'static Setting,
    /// The value.
    pub value: SettingValue,
    /// The value's place; `None` if the source is not a file.
    pub place: Option<FilePlace>,
}

/// A fault of a layer.
#[derive(Clone, Debug)]
pub struct SettingsFault {
    /// The setting that is ignored because of it; `None` for an unknown key, or for the layer as a whole.
    pub setting: Option<&'static Setting>,
    /// The fault's place; `None` if the source is not a file.
    pub place: Option<FilePlace>,
    /// The value that was found, and the values that were expected.
    pub why: String,
    /// `true` if the whole layer is ignored.
    pub costs_layer: bool,
}

/// The settings of one source, in its order.
#[derive(Clone, Debug)]
pub struct SettingsLayer {
    /// The name of the source in messages, such as a file's path.
    pub source: String,
    /// The entries; each setting occurs at most once.
    pub entries: Vec<LayerEntry>,
    /// The faults.
    pub faults: Vec<SettingsFault>,
}

impl SettingsLayer {
    /// Parses a file's text. `own_figures` are the names of the operator's own hidden figures.
    #[must_use]
    pub fn parse_toml(source: &str, text: &str, own_figures: &[String]) -> Self {
        let mut layer = SettingsLayer::empty(source);
        // Skips a byte-order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let table = match DeTable::parse(text) {
            Ok(table) => table.into_inner(),
            Err(error) => {
                let place = error.span().map(|span| find_place(text, span.start));
                // Some messages of the parser have several lines.
                let why = error.message().split_whitespace().collect::<Vec<_>>().join(" ");
                layer.refuse_all(place, format!("no TOML: {}", why.escape_debug()));
                return layer;
            }
        };
        let mut pairs: Vec<_> = table.into_iter().collect();
        pairs.sort_by_key(|(key, _)| key.span().start);
        for (key, value) in pairs {
            let place = |span: core::ops::Range<usize>| Some(find_place(text, span.start));
            match find_setting(key.get_ref()) {
                Some(setting) => {
                    layer.add(setting, &to_raw(&value), place(value.span()), own_figures);
                }
                None => layer.add_unknown(key.get_ref(), place(key.span())),
            }
        }
        layer
    }

    /// Reads a settings file. Returns `None` if the file doesn't exist. Any other read error becomes a fault
    /// of the layer.
    #[must_use]
    pub fn read_file(path: &Path, own_figures: &[String]) -> Option<Self> {
        let source = path.display().to_string();
        match read_text(path) {
            Ok(text) => Some(SettingsLayer::parse_toml(&source, &text, own_figures)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => None,
            Err(error) => {
                let mut layer = SettingsLayer::empty(&source);
                layer.refuse_all(None, error.to_string());
                Some(layer)
            }
        }
    }

    /// Parses the bytes of a settings file that was read already, such as a package's asset.
    #[must_use]
    pub fn parse_bytes(source: &str, bytes: &[u8], own_figures: &[String]) -> Self {
        match check_text(bytes) {
            Ok(text) => SettingsLayer::parse_toml(source, text, own_figures),
            Err(error) => {
                let mut layer = SettingsLayer::empty(source);
                layer.refuse_all(None, error.to_string());
                layer
            }
        }
    }

    /// Parses pairs of a setting's name and its text, as in a managed configuration or on a command line.
    #[must_use]
    pub fn from_texts<'a>(
        source: &str,
        texts: impl IntoIterator<Item = (&'a str, &'a str)>,
        own_figures: &[String],
    ) -> Self {
        let mut layer = SettingsLayer::empty(source);
        for (name, text) in texts {
            match find_setting(name) {
                Some(setting) => {
                    layer.add(setting, &RawValue::Untyped(text.into()), None, own_figures);
                }
                None => layer.add_unknown(name, None),
            }
        }
        layer
    }

    /// Returns the contradictions in this layer alone, with all other settings at their defaults.
    #[must_use]
    pub fn find_contradictions(&self) -> Vec<SettingsFault> {
        let loaded = LoadedSettings::merge(std::slice::from_ref(self));
        loaded.contradictions.into_iter().map(|contradiction| contradiction.fault).collect()
    }

    /// Returns the entry for the setting at an index of [`SETTINGS`], if the layer sets it.
    pub(super) fn find(&self, index: usize) -> Option<&LayerEntry> {
        self.entries.iter().find(|entry| core::ptr::eq(entry.setting, &raw const SETTINGS[index]))
    }

    fn empty(source: &str) -> Self {
        SettingsLayer { source: source.into(), entries: Vec::new(), faults: Vec::new() }
    }

    fn refuse_all(&mut self, place: Option<FilePlace>, why: String) {
        self.faults.push(SettingsFault { setting: None, place, why, costs_layer: true });
    }

    fn add(
        &mut self,
        setting: &'static Setting,
        raw: &RawValue,
        place: Option<FilePlace>,
        own_figures: &[String],
    ) {
        match setting.kind.check(raw, own_figures) {
            Ok(value) => {
                // On a command line a setting may occur twice; the last one counts.
                self.entries.retain(|entry| !core::ptr::eq(entry.setting, setting));
                self.entries.push(LayerEntry { setting, value, place });
            }
            Err(why) => {
                let why = format!("{} = {why}", setting.name);
                let setting = Some(setting);
                self.faults.push(SettingsFault { setting, place, why, costs_layer: false });
            }
        }
    }

    fn add_unknown(&mut self, name: &str, place: Option<FilePlace>) {
        let meant = match nearest_name(name) {
            Some(near) => format!("is {near} meant?"),
            None => {
                let all: Vec<_> = SETTINGS.iter().map(|setting| setting.name).collect();
                format!("expected one of {}", all.join(", "))
            }
        };
        let why = format!("{}: there is no such setting; {meant}", name.escape_debug());
        self.faults.push(SettingsFault { setting: None, place, why, costs_layer: false });
    }
}

impl fmt::Display for FilePlace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// Reads a file's text.
fn read_text(path: &Path) -> io::Result<String> {
    let mut bytes = Vec::new();
    durable::open_regular_file(path)?.take(MAX_BYTES + 1).read_to_end(&mut bytes)?;
    check_text(&bytes).map(str::to_owned)
}

/// Checks that bytes are UTF-8 text of at most [`MAX_BYTES`].
fn check_text(bytes: &[u8]) -> io::Result<&str> {
    if bytes.len() as u64 > MAX_BYTES {
        let why = format!("it is longer than {MAX_BYTES} bytes, expected settings as TOML");
        return Err(io::Error::other(why));
    }
    std::str::from_utf8(bytes).map_err(|error| {
        let good = &bytes[..error.valid_up_to()];
        let line = 1 + good.iter().filter(|byte| **byte == b'\n').count();
        io::Error::other(format!("line {line} is no UTF-8, expected settings as TOML"))
    })
}

/// Returns the place of a byte offset in a text.
fn find_place(text: &str, offset: usize) -> FilePlace {
    let before = text.get(..offset.min(text.len())).unwrap_or(text);
    let line = 1 + before.matches('\n').count();
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    FilePlace { line, column: 1 + before[start..].chars().count() }
}

/// Converts a TOML value.
fn to_raw(value: &Spanned<DeValue<'_>>) -> RawValue {
    match value.get_ref() {
        DeValue::Boolean(on) => RawValue::Switch(*on),
        DeValue::String(text) => RawValue::Text(text.clone().into_owned()),
        DeValue::Integer(integer) => {
            let whole = i64::from_str_radix(integer.as_str(), integer.radix());
            whole.map_or(RawValue::Other("a number that long"), RawValue::Whole)
        }
        DeValue::Float(_) => RawValue::Other("a number with a point"),
        DeValue::Datetime(_) => RawValue::Other("a date or time"),
        DeValue::Array(values) => RawValue::List(values.iter().map(to_raw_within_list).collect()),
        DeValue::Table(_) => RawValue::Other("a table"),
    }
}

/// Converts a TOML value within a list. No setting is a list of lists.
fn to_raw_within_list(value: &Spanned<DeValue<'_>>) -> RawValue {
    if value.get_ref().is_array() { RawValue::Other("a list") } else { to_raw(value) }
}

#[cfg(test)]
mod tests;
