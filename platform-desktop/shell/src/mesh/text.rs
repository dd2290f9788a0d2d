//! Text of mesh files: encodings, line ends, blanks and number formats of the programs that write them.

use memchr::memchr2;
use std::borrow::Cow;

/// Returns a text without its byte-order mark, in an encoding whose ASCII characters are one byte each. UTF-16
/// with a mark becomes UTF-8; other bytes stay, as comments and names may be in any encoding.
pub(super) fn decode(bytes: &[u8]) -> Cow<'_, [u8]> {
    let utf16 = |units: &[u8], unit: fn([u8; 2]) -> u16| {
        let units = units.as_chunks().0.iter().map(|&pair| unit(pair));
        let text = char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER));
        Cow::Owned(text.collect::<String>().into_bytes())
    };
    match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        [0xff, 0xfe, rest @ ..] => utf16(rest, u16::from_le_bytes),
        [0xfe, 0xff, rest @ ..] => utf16(rest, u16::from_be_bytes),
        _ => Cow::Borrowed(bytes),
    }
}

/// Returns `true` for blanks, control characters and the bytes of a no-break space in Latin-1 and UTF-8.
pub(super) fn is_blank(byte: u8) -> bool {
    byte <= b' ' || matches!(byte, 0x7f | 0xa0 | 0xc2)
}

/// Returns the words of a text between blanks.
pub(super) fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(|&byte| is_blank(byte)).filter(|word| !word.is_empty())
}

/// Returns a text without the blanks at its ends.
pub(super) fn trim(mut text: &[u8]) -> &[u8] {
    while let [first, rest @ ..] = text
        && is_blank(*first)
    {
        text = rest;
    }
    while let [rest @ .., last] = text
        && is_blank(*last)
    {
        text = rest;
    }
    text
}

/// The lines of a text, which end in LF, CR LF or CR.
#[derive(Clone)]
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    /// The number of the line that was returned last, from 1 on.
    pub(super) number: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Lines { rest: text, number: 0 }
    }

    /// Returns the text after the lines that were returned.
    pub(super) fn rest(&self) -> &'a [u8] {
        self.rest
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = memchr2(b'\n', b'\r', self.rest).unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(end);
        self.rest = match rest {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => rest,
        };
        Some(line)
    }
}

/// Parses a number as programs write it, including decimal commas, Fortran exponents, and the spellings of
/// infinities and NaN by several C libraries (`-nan(ind)`, `1.#QNAN`). Returns `None` for any other word.
pub(super) fn parse_number(word: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(value) = text.parse() {
        return Some(value);
    }
    let text = text.to_ascii_lowercase();
    let unsigned = text.trim_start_matches(['+', '-']);
    if unsigned.starts_with("1.#inf") {
        return Some(f64::INFINITY);
    }
    if ["nan", "ind", "1.#"].iter().any(|start| unsigned.starts_with(start)) {
        return Some(f64::NAN);
    }
    let has_decimal_comma = text.matches(',').count() == 1 && !text.contains('.');
    let text = if has_decimal_comma { text.replace(',', ".") } else { text };
    text.replace('d', "e").parse().ok()
}

/// Parses an index, which some programs write as a float (`3.0`). Returns `None` for any other word, or a
/// number that can't be an index.
pub(super) fn parse_index(word: &[u8]) -> Option<i64> {
    if let Some(index) = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok()) {
        return Some(index);
    }
    index_from_number(parse_number(word)?)
}

/// Returns a whole number of at most 2^53 as an index.
pub(super) fn index_from_number(value: f64) -> Option<i64> {
    const EXACT: f64 = (1u64 << 53) as f64;
    (value.abs() <= EXACT && value == value.trunc()).then_some(value as i64)
}

/// Returns a whole number from 0 on, of at most 2^53, as an index or a length.
pub(super) fn size_from_number(value: f64) -> Option<usize> {
    index_from_number(value).and_then(|index| usize::try_from(index).ok())
}

/// Quotes a text for a message, in back-quotes and cut to at most 40 characters.
pub(super) fn quote(text: &[u8]) -> String {
    let text = String::from_utf8_lossy(trim(text));
    let mut shown: String =
        text.chars().take(40).map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().nth(40).is_some() {
        shown.push_str("...");
    }
    format!("`{shown}`")
}
