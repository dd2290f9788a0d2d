//! The kinds of settings, their values, and the check that a value has its setting's kind.

mod list;
mod write;

use std::path::PathBuf;

use paros_core::session::SessionMode;

use super::pin::StaffPin;
use crate::modes::parse_mode_among;

/// The most bytes of a path, as on Linux and Android.
const MAX_PATH_BYTES: usize = 4096;

/// The kind of a setting's value.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SettingKind {
    /// `true` or `false`.
    Switch,
    /// A whole number between two bounds, both included.
    Whole {
        /// The least.
        least: u32,
        /// The greatest.
        most: u32,
    },
    /// 0, or a whole number between two bounds, both included.
    ZeroOr {
        /// The least value other than 0.
        least: u32,
        /// The greatest.
        most: u32,
    },
    /// One of some numbers.
    Numbers(&'static [u32]),
    /// One of some words.
    Words(&'static [&'static str]),
    /// The name of a session mode, from [`crate::modes`] or of one of the operator's own figures.
    Mode,
    /// A file's path.
    Path,
    /// An ordered list of some of these words, at least one, without repetition.
    WordList(&'static [&'static str]),
    /// An ordered list of names of [`SettingKind::Mode`], at least one, without repetition.
    ModeList {
        /// The most names.
        most: usize,
    },
    /// A PIN of four digits, which is never printed.
    Pin,
}

/// The default of a setting.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SettingDefault {
    /// A switch's position.
    Switch(bool),
    /// A number.
    Whole(u32),
    /// A word, or the name of a mode.
    Word(&'static str),
    /// Words, or names of modes.
    Words(&'static [&'static str]),
    /// No value; the text describes what happens instead.
    Unset(&'static str),
}

/// A value as it was found, before it is checked.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum RawValue {
    /// A boolean.
    Switch(bool),
    /// A whole number.
    Whole(i64),
    /// A quoted text of a file.
    Text(String),
    /// A text of a command line or a managed configuration, which may stand for a number or a switch too.
    Untyped(String),
    /// A list of a file. Its elements are not lists.
    List(Vec<RawValue>),
    /// A value of another TOML type, by the type's name. No setting has such a type.
    Other(&'static str),
}

/// A value that fits its setting.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum SettingValue {
    /// A switch's position.
    Switch(bool),
    /// A number.
    Number(u32),
    /// A word.
    Word(&'static str),
    /// A mode and its name.
    Mode(String, SessionMode),
    /// A path.
    Path(PathBuf),
    /// Words.
    Words(Vec<&'static str>),
    /// Modes and their names.
    Modes(Vec<(String, SessionMode)>),
    /// The staff's PIN.
    Pin(StaffPin),
}

impl SettingKind {
    /// Checks a value. `own_figures` are the names of the operator's own hidden figures.
    ///
    /// # Errors
    /// Returns a text that says what was found and what was expected.
    pub fn check(self, raw: &RawValue, own_figures: &[String]) -> Result<SettingValue, String> {
        let not_expected =
            |found: &str| format!("{found}, expected {}", self.describe(own_figures));
        let wrong = || not_expected(&raw.to_string());
        match self {
            SettingKind::Switch => raw.as_switch().map(SettingValue::Switch).ok_or_else(wrong),
            SettingKind::Whole { least, most } => {
                let whole = raw.as_whole().filter(|whole| (least..=most).contains(whole));
                whole.map(SettingValue::Number).ok_or_else(wrong)
            }
            SettingKind::ZeroOr { least, most } => {
                let fits = |whole: &u32| *whole == 0 || (least..=most).contains(whole);
                raw.as_whole().filter(fits).map(SettingValue::Number).ok_or_else(wrong)
            }
            SettingKind::Numbers(numbers) => {
                let whole = raw.as_whole().filter(|whole| numbers.contains(whole));
                whole.map(SettingValue::Number).ok_or_else(wrong)
            }
            SettingKind::Words(words) => {
                let word = raw.as_text().and_then(|text| find_word(words, text));
                word.map(SettingValue::Word).ok_or_else(wrong)
            }
            SettingKind::Mode => {
                let name = raw.as_text().ok_or_else(wrong)?;
                let mode = parse_mode_among(name, own_figures).map_err(|_| wrong())?;
                Ok(SettingValue::Mode(name.into(), mode))
            }
            SettingKind::Path => {
                let fits = |text: &&str| {
                    !text.is_empty()
                        && text.len() <= MAX_PATH_BYTES
                        && !text.chars().any(char::is_control)
                };
                let path = raw.as_text().filter(fits).ok_or_else(wrong)?;
                Ok(SettingValue::Path(path.into()))
            }
            SettingKind::WordList(words) => {
                let list = list::check(raw, words.len(), |text| find_word(words, text));
                list.map(SettingValue::Words).map_err(|found| not_expected(&found))
            }
            SettingKind::ModeList { most } => {
                let find = |name: &str| {
                    let mode = parse_mode_among(name, own_figures).ok()?;
                    Some((name.to_owned(), mode))
                };
                let list = list::check(raw, most, find);
                list.map(SettingValue::Modes).map_err(|found| not_expected(&found))
            }
            SettingKind::Pin => {
                let pin = raw.as_text().and_then(StaffPin::from_text);
                // The log must not show a wrong PIN, which may be close to the right one.
                pin.map(SettingValue::Pin).ok_or_else(|| not_expected("a value that isn't shown"))
            }
        }
    }

    /// Returns `true` if its values are lists.
    #[must_use]
    pub const fn is_list(self) -> bool {
        matches!(self, SettingKind::WordList(_) | SettingKind::ModeList { .. })
    }

    /// Returns a description of the valid values.
    #[must_use]
    pub fn describe(self, own_figures: &[String]) -> String {
        match self {
            SettingKind::Switch => "true or false".into(),
            SettingKind::Whole { least, most } => format!("a whole number from {least} to {most}"),
            SettingKind::ZeroOr { least, most } => {
                format!("0, or a whole number from {least} to {most}")
            }
            SettingKind::Numbers(numbers) => {
                numbers.iter().map(u32::to_string).collect::<Vec<_>>().join(" or ")
            }
            SettingKind::Words(words) => {
                format!("one of {}", quote_words(words))
            }
            SettingKind::Mode => {
                let known = crate::modes::UnknownMode.to_string();
                let known = known.trim_start_matches("expected ").to_owned();
                if own_figures.is_empty() {
                    return known;
                }
                format!("{known}, or a figure of one's own: {}", own_figures.join(", "))
            }
            SettingKind::Path => format!("a file's path of 1 to {MAX_PATH_BYTES} bytes"),
            SettingKind::WordList(words) => {
                format!("a list of one or more of {}, none twice", quote_words(words))
            }
            SettingKind::ModeList { most } => {
                let known = SettingKind::Mode.describe(own_figures);
                format!("a list of 1 to {most}, none twice, each {known}")
            }
            SettingKind::Pin => "four digits in quotes".into(),
        }
    }
}

impl RawValue {
    fn as_switch(&self) -> Option<bool> {
        match self {
            RawValue::Switch(on) => Some(*on),
            RawValue::Untyped(text) => text.parse().ok(),
            _ => None,
        }
    }

    fn as_whole(&self) -> Option<u32> {
        match self {
            RawValue::Whole(whole) => u32::try_from(*whole).ok(),
            RawValue::Untyped(text) if text.bytes().all(|c| c.is_ascii_digit()) => {
                text.parse().ok()
            }
            _ => None,
        }
    }

    fn as_text(&self) -> Option<&str> {
        match self {
            RawValue::Text(text) | RawValue::Untyped(text) => Some(text),
            _ => None,
        }
    }
}

impl SettingValue {
    /// Returns the number; `None` for other kinds.
    pub(super) fn number(&self) -> Option<u32> {
        if let SettingValue::Number(number) = self { Some(*number) } else { None }
    }

    /// Returns the word; `None` for other kinds.
    pub(super) fn word(&self) -> Option<&'static str> {
        if let SettingValue::Word(word) = self { Some(word) } else { None }
    }
}

impl SettingDefault {
    /// Returns the default as a raw value; `None` for [`SettingDefault::Unset`].
    #[must_use]
    pub fn to_raw(self) -> Option<RawValue> {
        match self {
            SettingDefault::Switch(on) => Some(RawValue::Switch(on)),
            SettingDefault::Whole(number) => Some(RawValue::Whole(number.into())),
            SettingDefault::Word(word) => Some(RawValue::Text(word.into())),
            SettingDefault::Words(words) => Some(RawValue::List(
                words.iter().map(|word| RawValue::Text((*word).into())).collect(),
            )),
            SettingDefault::Unset(_) => None,
        }
    }
}

fn find_word(words: &[&'static str], text: &str) -> Option<&'static str> {
    words.iter().find(|word| **word == text).copied()
}

/// Returns a quoted, comma-separated list of words for messages.
fn quote_words(words: &[&str]) -> String {
    let words: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
    words.join(", ")
}

#[cfg(test)]
mod tests;
