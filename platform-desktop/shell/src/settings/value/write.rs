//! Writes values as TOML.

use std::fmt;

use super::{RawValue, SettingDefault, SettingValue};

/// Writes TOML, with invisible characters escaped.
impl fmt::Display for RawValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RawValue::Switch(on) => write!(f, "{on}"),
            RawValue::Whole(whole) => write!(f, "{whole}"),
            RawValue::Text(text) => write_quoted(f, text),
            RawValue::Untyped(text) => write!(f, "{}", text.escape_debug()),
            RawValue::List(_) => f.write_str("a list"),
            RawValue::Other(what) => f.write_str(what),
        }
    }
}

/// Writes TOML; for a PIN only that it is set.
impl fmt::Display for SettingValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SettingValue::Switch(on) => write!(f, "{on}"),
            SettingValue::Number(number) => write!(f, "{number}"),
            SettingValue::Word(word) => write_quoted(f, word),
            SettingValue::Mode(name, _) => write_quoted(f, name),
            SettingValue::Path(path) => write_quoted(f, &path.to_string_lossy()),
            SettingValue::Words(words) => write_list(f, words.iter().copied()),
            SettingValue::Modes(modes) => write_list(f, modes.iter().map(|(name, _)| &**name)),
            SettingValue::Pin(_) => f.write_str("set"),
        }
    }
}

/// Writes TOML; for [`SettingDefault::Unset`] its text.
impl fmt::Display for SettingDefault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SettingDefault::Switch(on) => write!(f, "{on}"),
            SettingDefault::Whole(number) => write!(f, "{number}"),
            SettingDefault::Word(word) => write_quoted(f, word),
            SettingDefault::Words(words) => write_list(f, words.iter().copied()),
            SettingDefault::Unset(what) => f.write_str(what),
        }
    }
}

/// Writes a TOML basic string: quotes, backslashes and control characters are escaped.
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

/// Writes a list of TOML basic strings.
fn write_list<'a>(f: &mut fmt::Formatter<'_>, texts: impl Iterator<Item = &'a str>) -> fmt::Result {
    f.write_str("[")?;
    for (place, text) in texts.enumerate() {
        f.write_str(if place == 0 { "" } else { ", " })?;
        write_quoted(f, text)?;
    }
    f.write_str("]")
}
