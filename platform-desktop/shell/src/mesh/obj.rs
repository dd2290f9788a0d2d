//! OBJ: the lines `v` and `f`. All other lines are ignored, as they make no surface.

use super::builder::{MeshBuilder, VertexIndex};
use super::text::{self, Lines, parse_index, parse_number, quote};
use super::{MAX_TRIANGLES, Mesh, MeshFault};
use std::borrow::Cow;

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, MeshFault> {
    let text = text::decode(bytes);
    let mut builder = MeshBuilder::default();
    // Faces may name vertices that are defined below them.
    let vertices = read_vertices(&text, &mut builder)?;
    read_faces(&text, &vertices, &mut builder)?;
    builder.finish()
}

/// Reads all lines `v x y z`. A weight or colour after them is ignored.
fn read_vertices(text: &[u8], builder: &mut MeshBuilder) -> Result<Vec<VertexIndex>, MeshFault> {
    let mut vertices = Vec::new();
    let mut lines = LogicalLines::new(text);
    while let Some((number, line)) = lines.next() {
        let mut words = text::words(&line);
        if !words.next().is_some_and(|word| word.eq_ignore_ascii_case(b"v")) {
            continue;
        }
        let mut position = [0.0; 3];
        for coordinate in &mut position {
            *coordinate = words.next().and_then(parse_number).ok_or_else(|| {
                format!("line {number}: found {}; expected `v` and three numbers", quote(&line))
            })?;
        }
        // More than the corners of all triangles.
        if vertices.len() >= 3 * MAX_TRIANGLES {
            return Err(MeshFault::TooManyTriangles { count: vertices.len() / 3 + 1 });
        }
        vertices.push(builder.add_vertex(position));
    }
    Ok(vertices)
}

/// Reads all lines `f`, and `fo` in old files.
fn read_faces(
    text: &[u8],
    vertices: &[VertexIndex],
    builder: &mut MeshBuilder,
) -> Result<(), MeshFault> {
    let mut above = 0;
    let mut corners = Vec::new();
    let mut lines = LogicalLines::new(text);
    while let Some((number, line)) = lines.next() {
        let mut words = text::words(&line);
        match words.next() {
            Some(b"v" | b"V") => above += 1,
            Some(b"f" | b"F" | b"fo") => {
                corners.clear();
                for word in words.take_while(|word| word[0] != b'#') {
                    let corner = find_corner(word, vertices, above);
                    corners.push(corner.map_err(|why| format!("line {number}: {why}"))?);
                }
                let added = builder.add_polygon(&corners);
                added.map_err(|fault| fault.at(|| format!("line {number}")))?;
            }
            _ => {}
        }
    }
    Ok(())
}

/// Returns the vertex that a corner names: `v`, `v/vt`, `v//vn` or `v/vt/vn`, of which only `v` is used.
/// Positive indices count from 1; negative ones count back from the last vertex above the line, from -1.
fn find_corner(word: &[u8], vertices: &[VertexIndex], above: usize) -> Result<VertexIndex, String> {
    let first = word.split(|byte| matches!(byte, b'/' | b'#')).next().unwrap_or_default();
    let Some(index) = parse_index(first) else {
        return Err(format!(
            "found the corner {}; expected `v`, `v/vt`, `v//vn` or `v/vt/vn`",
            quote(word)
        ));
    };
    let back = usize::try_from(index.unsigned_abs()).unwrap_or(usize::MAX);
    let at = if index < 0 { above.checked_sub(back) } else { back.checked_sub(1) };
    at.and_then(|at| vertices.get(at).copied()).ok_or_else(|| {
        format!(
            "{} names vertex {index}; expected one of the {} `v` lines, counted from 1, or of the \
             {above} above it, counted back from -1",
            quote(word),
            vertices.len()
        )
    })
}

/// The lines of a text. Vertices and faces that end in `\` are joined with the next line; other lines aren't,
/// as a comment or a name may end in a folder's name.
struct LogicalLines<'a> {
    lines: Lines<'a>,
}

impl<'a> LogicalLines<'a> {
    fn new(text: &'a [u8]) -> Self {
        LogicalLines { lines: Lines::new(text) }
    }

    /// Returns the next line, and its number, from 1.
    fn next(&mut self) -> Option<(usize, Cow<'a, [u8]>)> {
        let line = self.lines.next()?;
        let number = self.lines.number;
        let is_used = matches!(text::words(line).next(), Some(b"v" | b"V" | b"f" | b"F" | b"fo"));
        let Some(start) = strip_continuation(line).filter(|_| is_used) else {
            return Some((number, Cow::Borrowed(line)));
        };
        let mut joined = start.to_vec();
        for line in self.lines.by_ref() {
            joined.push(b' ');
            match strip_continuation(line) {
                Some(part) => joined.extend(part),
                None => {
                    joined.extend(line);
                    break;
                }
            }
        }
        Some((number, Cow::Owned(joined)))
    }
}

/// Returns a line without the `\` at its end; `None` if there is none.
fn strip_continuation(line: &[u8]) -> Option<&[u8]> {
    if line.last().is_some_and(|&byte| byte == b'\\' || text::is_blank(byte)) {
        text::trim(line).strip_suffix(b"\\")
    } else {
        None
    }
}
