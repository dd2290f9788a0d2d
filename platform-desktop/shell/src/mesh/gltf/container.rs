//! The parts of a glTF file: its JSON, and the bytes of its buffers.

use super::super::{MAX_FILE_BYTES, text};
use super::items;
use crate::durable;
use serde_json::Value;
use std::borrow::Cow;
use std::path::Path;

/// The JSON of a file and its binary chunk.
pub(super) struct Parts<'a> {
    pub(super) json: Value,
    pub(super) binary: Option<&'a [u8]>,
}

/// Splits a file into its parts. The contents, not the name, decide whether it is binary or text.
pub(super) fn split(bytes: &[u8]) -> Result<Parts<'_>, String> {
    if !bytes.starts_with(b"glTF") {
        return Ok(Parts { json: parse_json(bytes)?, binary: None });
    }
    let number = |at: usize| {
        let bytes = bytes.get(at..at + 4)?;
        Some(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    };
    match number(4) {
        Some(2) => {}
        Some(version) => {
            return Err(format!(
                "byte 4: found version {version}; expected 2. Export it as glTF 2.0"
            ));
        }
        None => return Err("the file ends in its header; expected 12 bytes".into()),
    }
    let (mut json, mut binary) = (None, None);
    let mut at = 12;
    while let (Some(length), Some(kind)) = (number(at), bytes.get(at + 4..at + 8)) {
        let data = bytes.get(at + 8..).and_then(|rest| rest.get(..length as usize));
        let data = data.ok_or_else(|| {
            format!(
                "byte {at}: found a chunk of {length} bytes; expected at most {}",
                bytes.len() - at - 8
            )
        })?;
        match kind {
            b"JSON" if json.is_none() => json = Some(data),
            b"BIN\0" if binary.is_none() => binary = Some(data),
            _ => {}
        }
        at = (at + 8).saturating_add(length as usize);
    }
    let json = json.ok_or("the file has no chunk `JSON`; expected one at byte 12")?;
    Ok(Parts { json: parse_json(json)?, binary })
}

/// Parses JSON. Also accepts a byte-order mark, other text encodings, trailing NULs, and numbers that C
/// printed as `nan` or `inf`.
fn parse_json(bytes: &[u8]) -> Result<Value, String> {
    let text = text::decode(bytes);
    let text = String::from_utf8_lossy(&text);
    let text = text.trim_end_matches(|c: char| c == '\0' || c.is_whitespace());
    serde_json::from_str(text).or_else(|error| {
        serde_json::from_str(&replace_bare_words(text)).map_err(|_| {
            let found = if error.is_eof() { "the JSON ends early" } else { "found no valid JSON" };
            format!("line {}, column {}: {found}", error.line(), error.column())
        })
    })
}

/// Replaces words outside strings that JSON doesn't have (`NaN`, `-inf`, `-nan(ind)`) by `null`.
fn replace_bare_words(text: &str) -> String {
    let mut replaced = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let length = match c {
            '"' => {
                let mut is_escaped = false;
                let end = rest[1..].find(|c| {
                    let ends = c == '"' && !is_escaped;
                    is_escaped = c == '\\' && !is_escaped;
                    ends
                });
                end.map_or(rest.len(), |end| end + 2)
            }
            ',' | ':' | '[' | ']' | '{' | '}' => 1,
            c if c.is_whitespace() => c.len_utf8(),
            _ => {
                let ends = |c: char| ",:[]{}\"".contains(c) || c.is_whitespace();
                rest.find(ends).unwrap_or(rest.len())
            }
        };
        let (word, tail) = rest.split_at(length);
        let is_bare = word.contains(|c: char| c.is_ascii_alphabetic() && c != 'e' && c != 'E');
        if is_bare && !word.starts_with('"') && !matches!(word, "true" | "false" | "null") {
            replaced.push_str("null");
        } else {
            replaced.push_str(word);
        }
        rest = tail;
    }
    replaced
}

/// The buffers, which are read when they are first needed: those of textures and animations may be missing.
pub(super) struct Buffers<'a> {
    definitions: &'a [Value],
    binary: Option<&'a [u8]>,
    folder: &'a Path,
    /// For each buffer that was read, its bytes or an error.
    read: Vec<Option<Result<Cow<'a, [u8]>, String>>>,
    /// The number of bytes that may still be read, as many buffers may name the same file.
    left: u64,
}

impl<'a> Buffers<'a> {
    pub(super) fn new(json: &'a Value, binary: Option<&'a [u8]>, folder: &'a Path) -> Self {
        let definitions = items(&json["buffers"]);
        let read = definitions.iter().map(|_| None).collect();
        Buffers { definitions, binary, folder, read, left: MAX_FILE_BYTES }
    }

    /// Reads a buffer if it hasn't been read.
    pub(super) fn load(&mut self, index: usize) -> Result<(), String> {
        if self.read.get(index).is_some_and(Option::is_none) {
            self.read[index] = Some(self.read_buffer(index));
        }
        self.bytes(index).map(drop)
    }

    /// Returns the bytes of a buffer that was loaded.
    pub(super) fn bytes(&self, index: usize) -> Result<&[u8], String> {
        match self.read.get(index) {
            Some(Some(Ok(bytes))) => Ok(bytes),
            Some(Some(Err(why))) => Err(format!("buffer {index}: {why}")),
            _ => Err(format!("found buffer {index}; expected less than {}", self.read.len())),
        }
    }

    fn read_buffer(&mut self, index: usize) -> Result<Cow<'a, [u8]>, String> {
        let definition = &self.definitions[index];
        let Some(uri) = definition["uri"].as_str() else {
            let binary = self.binary.filter(|_| index == 0);
            let binary = binary.ok_or("found neither `uri` nor a binary chunk; expected one")?;
            return check_length(definition, Cow::Borrowed(binary));
        };
        let bytes = match uri.split_once(':') {
            Some((scheme, data)) if scheme.eq_ignore_ascii_case("data") => {
                let (kind, text) = data.split_once(',').unwrap_or((data, ""));
                let is_base64 = kind.to_ascii_lowercase().ends_with(";base64");
                let decoded = decode_percent(text);
                if is_base64 { decode_base64(&decoded) } else { Some(decoded) }
                    .ok_or("found a data URI that isn't base64; expected base64")?
            }
            _ => {
                let name = String::from_utf8_lossy(&decode_percent(uri)).into_owned();
                let file = self.folder.join(name);
                let bytes = durable::read_regular_file_up_to(&file, self.left)
                    .map_err(|error| format!("{}: {error}", file.display()))?;
                self.left -= bytes.len() as u64;
                bytes
            }
        };
        check_length(definition, Cow::Owned(bytes))
    }
}

fn check_length<'a>(definition: &Value, bytes: Cow<'a, [u8]>) -> Result<Cow<'a, [u8]>, String> {
    let stated = definition["byteLength"].as_u64().unwrap_or(0);
    if bytes.len() as u64 >= stated {
        return Ok(bytes);
    }
    Err(format!("found {} bytes; expected {stated}", bytes.len()))
}

/// Decodes base64 (RFC 4648, including the URL-safe alphabet), with or without padding, and with blanks.
/// Returns `None` for any other character.
fn decode_base64(text: &[u8]) -> Option<Vec<u8>> {
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3);
    let (mut bits, mut held) = (0u32, 0);
    for &c in text {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            b'=' | b' ' | b'\t' | b'\r' | b'\n' => continue,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    Some(bytes)
}

/// Decodes a URI's percent-encoding.
fn decode_percent(uri: &str) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let digits = tail.get(..2).filter(|_| first == b'%');
        let digits = digits.and_then(|d| std::str::from_utf8(d).ok());
        match digits.and_then(|d| u8::from_str_radix(d, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            None => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    bytes
}
