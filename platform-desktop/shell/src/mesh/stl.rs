//! STL: the corners of its facets. Normals are ignored. Binary and text files are distinguished by length
//! first, as binary files may start with `solid` too.

use super::builder::MeshBuilder;
use super::text::{self, parse_number, quote};
use super::{MAX_TRIANGLES, Mesh, MeshFault, malformed};
use std::io::{self, Read};

/// The length of a binary file's header: a free text and the number of facets.
const HEADER: usize = 84;
const FACET: usize = 50;
/// The first bytes, within which a text must have its first facet.
const HEAD: usize = 4096;

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, MeshFault> {
    if let Some(header) = bytes.first_chunk()
        && let Some(count) = find_binary_count(header, bytes.len() as u64)
    {
        return parse_binary(&bytes[HEADER..], count);
    }
    let text = text::decode(bytes);
    if is_text(&text[..text.len().min(HEAD)]) {
        return parse_text(&text);
    }
    let Some(header) = bytes.first_chunk() else {
        let found = bytes.len();
        return malformed(format!(
            "found {found} bytes; expected a text that starts with `solid`, or at least {HEADER} bytes"
        ));
    };
    let count = read_count(header);
    if length_of(count) <= bytes.len() as u64 {
        return parse_binary(&bytes[HEADER..], count);
    }
    malformed(format!(
        "byte 80: found {count} as the number of facets, which take {} bytes; expected as many as the file \
         has, {}",
        length_of(count),
        bytes.len()
    ))
}

fn read_count(header: &[u8; HEADER]) -> u32 {
    u32::from_le_bytes([header[80], header[81], header[82], header[83]])
}

/// Returns the length of a binary file of that many facets.
fn length_of(facets: u32) -> u64 {
    HEADER as u64 + u64::from(facets) * FACET as u64
}

/// Returns the number of facets if the file has exactly the length for it, which no text has.
pub(super) fn find_binary_count(header: &[u8; HEADER], length: u64) -> Option<u32> {
    let count = read_count(header);
    (length_of(count) == length).then_some(count)
}

/// Returns `true` for the start of a text: one of its keywords, and another one in the first kilobytes.
fn is_text(head: &[u8]) -> bool {
    let is = |word: &[u8], keyword: &str| word.eq_ignore_ascii_case(keyword.as_bytes());
    let first = text::words(head).next().unwrap_or_default();
    is(first, "facet")
        || is(first, "solid")
            && text::words(head).skip(1).any(|word| {
                ["facet", "endsolid", "solid", "vertex"].iter().any(|keyword| is(word, keyword))
            })
}

/// Reads the facets of a binary file, a block at a time.
///
/// # Errors
/// Returns the errors of [`parse`], and an error if the source ends early.
pub(super) fn parse_binary(mut source: impl Read, count: u32) -> Result<Mesh, MeshFault> {
    let count = count as usize;
    if count > MAX_TRIANGLES {
        return Err(MeshFault::TooManyTriangles { count });
    }
    let mut builder = MeshBuilder::default();
    builder.reserve_triangles(count);
    let mut block = vec![0; FACET * count.min(1 << 14)];
    let mut at = 0;
    while at < count {
        let facets = (count - at).min(1 << 14);
        let block = &mut block[..facets * FACET];
        source.read_exact(block).map_err(MeshFault::Unreadable)?;
        for facet in block.as_chunks::<FACET>().0 {
            let coordinate = |at: usize| {
                let bytes = [facet[at], facet[at + 1], facet[at + 2], facet[at + 3]];
                f64::from(f32::from_le_bytes(bytes))
            };
            let corners = [12, 24, 36].map(|at| {
                builder.add_vertex([coordinate(at), coordinate(at + 4), coordinate(at + 8)])
            });
            builder.add_triangle(corners).map_err(|fault| {
                fault.at(|| format!("byte {}: facet {at}", HEADER + at * FACET))
            })?;
            at += 1;
        }
    }
    builder.finish()
}

/// The words of a text, and their line numbers.
struct Words<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Words<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let blanks = self.rest.iter().take_while(|&&byte| text::is_blank(byte)).count();
        self.skip(blanks);
        let length = self.rest.iter().take_while(|&&byte| !text::is_blank(byte)).count();
        let word = &self.rest[..length];
        self.skip(length);
        (length > 0).then_some(word)
    }

    fn skip(&mut self, length: usize) {
        let (skipped, rest) = self.rest.split_at(length);
        let mut last = 0;
        for &byte in skipped {
            // CR LF is a single line end.
            self.line += usize::from(byte == b'\r' || byte == b'\n' && last != b'\r');
            last = byte;
        }
        self.rest = rest;
    }

    fn skip_line(&mut self) {
        let end = self.rest.iter().take_while(|&&byte| byte != b'\n' && byte != b'\r').count();
        self.skip(end);
    }
}

/// The keywords that structure a facet.
#[derive(Clone, Copy, PartialEq)]
enum Keyword {
    Solid,
    Facet,
    Vertex,
    EndLoop,
    EndFacet,
    /// Any other word: `outer`, `loop`, `normal` and its numbers, words between facets.
    Other,
}

impl Keyword {
    fn from_word(word: &[u8]) -> Self {
        match word.to_ascii_lowercase().as_slice() {
            b"solid" | b"endsolid" => Keyword::Solid,
            b"facet" => Keyword::Facet,
            b"vertex" => Keyword::Vertex,
            b"endloop" => Keyword::EndLoop,
            b"endfacet" => Keyword::EndFacet,
            _ => Keyword::Other,
        }
    }
}

fn parse_text(text: &[u8]) -> Result<Mesh, MeshFault> {
    let mut builder = MeshBuilder::default();
    let mut words = Words { rest: text, line: 1 };
    // The line in which the current facet starts.
    let mut facet: Option<usize> = None;
    let mut corners = Vec::new();
    while let Some(word) = words.next() {
        let keyword = Keyword::from_word(word);
        match (keyword, facet) {
            (Keyword::Solid, None) => words.skip_line(),
            (Keyword::Facet, None) => facet = Some(words.line),
            (Keyword::Vertex, Some(_)) => {
                corners.push(builder.add_vertex(read_vertex(&mut words)?));
            }
            (Keyword::EndLoop | Keyword::EndFacet, Some(start)) => {
                if !corners.is_empty() {
                    let added = builder.add_polygon(&corners);
                    added.map_err(|fault| fault.at(|| format!("line {start}: the facet")))?;
                    corners.clear();
                }
                facet = facet.filter(|_| keyword != Keyword::EndFacet);
            }
            (Keyword::Other, _) => {}
            (_, facet) => {
                let (line, found) = (words.line, quote(word));
                let expected = if facet.is_some() { "`endfacet`" } else { "`facet`" };
                let before = if facet.is_some() { "inside" } else { "outside" };
                return malformed(format!(
                    "line {line}: found {found} {before} a facet; expected {expected} before it"
                ));
            }
        }
    }
    match facet {
        None => builder.finish(),
        Some(start) => malformed(format!(
            "line {}: the text ends inside the facet of line {start}; expected `endfacet`",
            words.line
        )),
    }
}

fn read_vertex(words: &mut Words<'_>) -> Result<[f64; 3], MeshFault> {
    let mut position = [0.0; 3];
    for coordinate in &mut position {
        let word = words.next().unwrap_or_default();
        *coordinate = parse_number(word).ok_or_else(|| {
            let (line, found) = (words.line, quote(word));
            format!("line {line}: found {found}; expected `vertex` and three numbers")
        })?;
    }
    Ok(position)
}

/// Reads the header of a source. Returns `None` if the source is shorter.
pub(super) fn read_header(source: &mut impl Read) -> io::Result<Option<[u8; HEADER]>> {
    let mut header = [0; HEADER];
    match source.read_exact(&mut header) {
        Ok(()) => Ok(Some(header)),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => Ok(None),
        Err(error) => Err(error),
    }
}
