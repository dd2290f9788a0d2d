//! Lists: an array in a file, or comma-separated in an untyped text.

use super::RawValue;

/// Reads a list of at most `most` items in order. `find` converts each text; repetitions are errors.
///
/// # Errors
/// Returns a text that says what was found.
pub(super) fn check<T>(
    raw: &RawValue,
    most: usize,
    find: impl Fn(&str) -> Option<T>,
) -> Result<Vec<T>, String> {
    let texts = split(raw)?;
    if texts.is_empty() {
        return Err("an empty list".into());
    }
    let mut found = Vec::new();
    for (place, text) in texts.iter().enumerate() {
        let quoted = || RawValue::Text((*text).into());
        found.push(find(text).ok_or_else(|| format!("a list with {}", quoted()))?);
        if texts[..place].contains(text) {
            return Err(format!("a list with {} twice", quoted()));
        }
        if place == most {
            return Err(format!("a list of {}", texts.len()));
        }
    }
    Ok(found)
}

fn split(raw: &RawValue) -> Result<Vec<&str>, String> {
    match raw {
        RawValue::List(values) => {
            let text =
                |value| RawValue::as_text(value).ok_or_else(|| format!("a list with {value}"));
            values.iter().map(text).collect()
        }
        RawValue::Untyped(text) if text.trim().is_empty() => Ok(Vec::new()),
        RawValue::Untyped(text) => Ok(text.split(',').map(str::trim).collect()),
        other => Err(other.to_string()),
    }
}
