//! Kinds of settings, their values, and the check of one against the other.

use std::fmt;
use std::path::PathBuf;

use paros_core::session::SessionMode;

use crate::modes::parse_mode_among;

/// The most bytes of a path: as many as Linux and Android take.
const MAX_PATH_BYTES: usize = 4096;

/// What a setting's value is.
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
    /// One of some numbers.
    Numbers(&'static [u32]),
    /// One of some words.
    Words(&'static [&'static str]),
    /// The name of a way to start a session, of [`crate::modes`] or of a figure of the operator's own.
    Mode,
    /// A file's path.
    Path,
}

/// What holds where nobody sets a setting.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SettingDefault {
    /// A switch's position.
    Switch(bool),
    /// A number.
    Whole(u32),
    /// A word, or the name of a mode.
    Word(&'static str),
    /// No value of its kind, but what this says.
    Unset(&'static str),
}

/// A value as it was found, before it is known to fit.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum RawValue {
    /// A boolean.
    Switch(bool),
    /// A whole number.
    Whole(i64),
    /// A text of a file, in quotes there.
    Text(String),
    /// A text of a command line or of a managed configuration, in which a number or a switch is a text too.
    Untyped(String),
    /// Something else, in the words of TOML: no setting is of such a type.
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
}

impl SettingKind {
    /// Checks a value. `own_figures` are the names of the operator's own hidden figures.
    ///
    /// # Errors
    /// What was found and what was expected.
    pub fn check(self, raw: &RawValue, own_figures: &[String]) -> Result<SettingValue, String> {
        let wrong = || format!("{raw}, expected {}", self.describe(own_figures));
        match self {
            SettingKind::Switch => raw.as_switch().map(SettingValue::Switch).ok_or_else(wrong),
            SettingKind::Whole { least, most } => {
                let whole = raw.as_whole().filter(|whole| (least..=most).contains(whole));
                whole.map(SettingValue::Number).ok_or_else(wrong)
            }
            SettingKind::Numbers(numbers) => {
                let whole = raw.as_whole().filter(|whole| numbers.contains(whole));
                whole.map(SettingValue::Number).ok_or_else(wrong)
            }
            SettingKind::Words(words) => {
                let word = raw.as_text().and_then(|text| words.iter().find(|word| **word == text));
                word.map(|word| SettingValue::Word(word)).ok_or_else(wrong)
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
        }
    }

    /// What a value must be.
    #[must_use]
    pub fn describe(self, own_figures: &[String]) -> String {
        match self {
            SettingKind::Switch => "true or false".into(),
            SettingKind::Whole { least, most } => format!("a whole number from {least} to {most}"),
            SettingKind::Numbers(numbers) => {
                numbers.iter().map(u32::to_string).collect::<Vec<_>>().join(" or ")
            }
            SettingKind::Words(words) => {
                let words: Vec<_> = words.iter().map(|word| format!("\"{word}\"")).collect();
                format!("one of {}", words.join(", "))
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
    /// The number, if it is one.
    pub(super) fn number(&self) -> Option<u32> {
        if let SettingValue::Number(number) = self { Some(*number) } else { None }
    }

    /// The word, if it is one.
    pub(super) fn word(&self) -> Option<&'static str> {
        if let SettingValue::Word(word) = self { Some(word) } else { None }
    }
}

impl SettingDefault {
    /// The default as a value that was found; none for [`SettingDefault::Unset`].
    #[must_use]
    pub fn to_raw(self) -> Option<RawValue> {
        match self {
            SettingDefault::Switch(on) => Some(RawValue::Switch(on)),
            SettingDefault::Whole(number) => Some(RawValue::Whole(number.into())),
            SettingDefault::Word(word) => Some(RawValue::Text(word.into())),
            SettingDefault::Unset(_) => None,
        }
    }
}

/// As TOML has it, and what can't be seen of a text escaped.
impl fmt::Display for RawValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RawValue::Switch(on) => write!(f, "{on}"),
            RawValue::Whole(whole) => write!(f, "{whole}"),
            RawValue::Text(text) => write_quoted(f, text),
            RawValue::Untyped(text) => write!(f, "{}", text.escape_debug()),
            RawValue::Other(what) => f.write_str(what),
        }
    }
}

/// As TOML has it.
impl fmt::Display for SettingValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SettingValue::Switch(on) => write!(f, "{on}"),
            SettingValue::Number(number) => write!(f, "{number}"),
            SettingValue::Word(word) => write_quoted(f, word),
            SettingValue::Mode(name, _) => write_quoted(f, name),
            SettingValue::Path(path) => write_quoted(f, &path.to_string_lossy()),
        }
    }
}

/// As TOML has it; what holds without a value in words.
impl fmt::Display for SettingDefault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SettingDefault::Switch(on) => write!(f, "{on}"),
            SettingDefault::Whole(number) => write!(f, "{number}"),
            SettingDefault::Word(word) => write_quoted(f, word),
            SettingDefault::Unset(what) => f.write_str(what),
        }
    }
}

/// Writes a basic string of TOML: quotes, backslashes and control characters are escaped as it says.
fn write_quoted(f: &mut fmt::Formatter<'_>, text: &str) -> fmt::Result {
    f.write_str("\"")?;
    for c in text.chars() {
        match c {
            '"' | '\\' => write!(f, "\\{c}")?,
            c if c.is_control() || matches!(c, '\u{2028}' | '\u{2029}') => {
                write!(f, "\\u{:04X}", c as u32)?;
            }
            c => write!(f, "{c}")?,
        }
    }
    f.write_str("\"")
}

#[cfg(test)]
mod tests {
    use super::{RawValue, SettingKind, SettingValue};

    #[test]
    fn a_value_fits_its_kind_or_is_told() {
        let whole = SettingKind::Whole { least: 1, most: 40 };
        let untyped = |text: &str| RawValue::Untyped(text.into());
        let text = |text: &str| RawValue::Text(text.into());
        for raw in [RawValue::Whole(1), untyped("1"), untyped("001")] {
            assert_eq!(whole.check(&raw, &[]), Ok(SettingValue::Number(1)), "{raw}");
        }
        for raw in [
            RawValue::Whole(0),
            RawValue::Whole(41),
            RawValue::Whole(1 + (1 << 32)),
            RawValue::Whole(-1),
            RawValue::Switch(true),
            RawValue::Other("a float"),
            text("1"),
            untyped("+1"),
            untyped(""),
            untyped("99999999999999999999"),
        ] {
            let why = whole.check(&raw, &[]).expect_err("it doesn't fit");
            assert_eq!(why, format!("{raw}, expected a whole number from 1 to 40"));
        }
        let switch = SettingKind::Switch;
        assert_eq!(switch.check(&untyped("true"), &[]), Ok(SettingValue::Switch(true)));
        assert!(
            switch.check(&text("true"), &[]).is_err() && switch.check(&untyped("1"), &[]).is_err()
        );
        let numbers = SettingKind::Numbers(&[128, 256]);
        assert_eq!(numbers.check(&untyped("256"), &[]), Ok(SettingValue::Number(256)));
        assert_eq!(numbers.describe(&[]), "128 or 256");
        assert!(numbers.check(&RawValue::Whole(200), &[]).is_err());
        let words = SettingKind::Words(&["off", "low"]);
        assert_eq!(words.check(&text("low"), &[]), Ok(SettingValue::Word("low")));
        let why = words.check(&text("Low"), &[]).expect_err("another word");
        assert_eq!(why, "\"Low\", expected one of \"off\", \"low\"");
    }

    #[test]
    fn a_figure_of_ones_own_is_a_mode_by_its_name() {
        let own = ["lion".to_owned()];
        let lion = RawValue::Text("lion".into());
        assert!(matches!(SettingKind::Mode.check(&lion, &own), Ok(SettingValue::Mode(..))));
        assert!(SettingKind::Mode.check(&lion, &[]).is_err());
        let why = SettingKind::Mode.check(&RawValue::Text("lynx".into()), &own);
        assert!(why.is_err_and(|why| why.ends_with("or a figure of one's own: lion")));
    }

    #[test]
    fn a_path_is_a_line_of_text_and_what_cannot_be_seen_is_escaped() {
        let check = |text: &str| SettingKind::Path.check(&RawValue::Text(text.into()), &[]);
        assert!(check("a/b c.trace").is_ok_and(|path| path.to_string() == "\"a/b c.trace\""));
        assert!(check("a\"\\b").is_ok_and(|path| path.to_string() == r#""a\"\\b""#));
        let why = check("a\nb\u{1b}").expect_err("no line");
        assert!(why.starts_with(r#""a\u000Ab\u001B", expected a file's path"#), "{why}");
        assert!(check("").is_err() && check(&"a".repeat(4097)).is_err());
    }
}
