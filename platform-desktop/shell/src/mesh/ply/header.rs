//! The header of a PLY file: its format, and the elements and properties that follow.

use super::super::text::{self, Lines, quote};

/// The encoding of the numbers after the header.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Number {
    Signed(usize),
    Unsigned(usize),
    Float(usize),
}

/// A property of an element: a number, or a list of numbers with their count before them.
pub(super) struct Property {
    pub(super) name: String,
    /// The type of a list's count.
    pub(super) count: Option<Number>,
    pub(super) number: Number,
}

pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: usize,
    pub(super) properties: Vec<Property>,
}

pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// The number of the header's lines.
    pub(super) lines: usize,
}

impl Number {
    fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Number::Signed(1),
            "uchar" | "uint8" => Number::Unsigned(1),
            "short" | "int16" => Number::Signed(2),
            "ushort" | "uint16" => Number::Unsigned(2),
            "int" | "int32" => Number::Signed(4),
            "uint" | "uint32" => Number::Unsigned(4),
            "long" | "int64" => Number::Signed(8),
            "ulong" | "uint64" => Number::Unsigned(8),
            "float" | "float32" => Number::Float(4),
            "double" | "float64" => Number::Float(8),
            _ => return None,
        })
    }

    /// Returns the number's size in a binary file, in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Number::Signed(size) | Number::Unsigned(size) | Number::Float(size) => size,
        }
    }
}

impl Element {
    /// Returns the size of an element in a binary file, in bytes; `None` if it has lists.
    pub(super) fn fixed_size(&self) -> Option<usize> {
        let sizes = self.properties.iter().map(|p| p.count.is_none().then(|| p.number.size()));
        sizes.sum()
    }
}

/// Reads a header. Returns it and the bytes after it. Comments may be in any encoding, and lines may be
/// blank.
pub(super) fn parse(bytes: &[u8]) -> Result<(Header, &[u8]), String> {
    // A file whose lines end in CR may have data that starts with LF.
    let ends_in_cr = bytes.iter().find(|&&byte| byte == b'\r' || byte == b'\n') == Some(&b'\r')
        && !bytes.windows(2).take(256).any(|pair| pair == b"\r\n");
    let mut lines = Lines::new(bytes);
    let mut header = Header { encoding: Encoding::Text, elements: Vec::new(), lines: 0 };
    let (mut is_ply, mut has_format) = (false, false);
    loop {
        let before = lines.rest();
        let Some(line) = lines.next() else {
            return Err(if is_ply {
                "the file ends inside the header; expected `end_header`".into()
            } else {
                format!("line 1: found {}; expected `ply`", quote(&bytes[..bytes.len().min(40)]))
            });
        };
        let text = String::from_utf8_lossy(text::trim(line)).to_ascii_lowercase();
        let words: Vec<&str> =
            text.split(|c: char| c <= ' ').filter(|word| !word.is_empty()).collect();
        let at = |expected: &str| {
            let (number, found) = (lines.number, quote(line));
            Err(format!("line {number}: found {found}; expected {expected}"))
        };
        match words[..] {
            [] | ["comment" | "obj_info", ..] => {}
            ["ply", ..] if !is_ply => is_ply = true,
            _ if !is_ply => return at("`ply`"),
            ["format", name, ..] => {
                has_format = true;
                header.encoding = match name {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    _ => return at("`ascii`, `binary_little_endian` or `binary_big_endian`"),
                };
            }
            ["element", name, count, ..] => {
                let Ok(count) = count.parse() else { return at("the number of elements") };
                let properties = Vec::new();
                header.elements.push(Element { name: name.into(), count, properties });
            }
            ["property", ref definition @ ..] => {
                let property = parse_property(definition);
                match (property, header.elements.last_mut()) {
                    (Some(property), Some(element)) => element.properties.push(property),
                    _ => return at("`property TYPE NAME` or `property list TYPE TYPE NAME`"),
                }
            }
            ["end_header", ..] if !has_format => return at("`format` before it"),
            ["end_header", ..] => {
                header.lines = lines.number;
                let end = before.len() - lines.rest().len();
                let has_lf = ends_in_cr && before[..end].ends_with(b"\r\n");
                return Ok((header, &before[end - usize::from(has_lf)..]));
            }
            _ => return at("`format`, `element`, `property`, `comment` or `end_header`"),
        }
    }
}

fn parse_property(words: &[&str]) -> Option<Property> {
    let (count, number, name) = match *words {
        ["list", count, number, name, ..] => (Some(Number::from_name(count)?), number, name),
        [number, name, ..] => (None, number, name),
        _ => return None,
    };
    Some(Property { name: name.into(), count, number: Number::from_name(number)? })
}
