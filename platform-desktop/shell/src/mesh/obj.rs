//! OBJ through `tobj`, with the line at which it stopped.

use super::{MAX_TRIANGLES, MAX_VERTICES, Mesh, ParseStop, check_count, malformed};
use std::io::{self, BufRead, Read};

/// Some programs start a text with it; it would make the first line an unknown one.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, ParseStop> {
    // Comments and names may be in any encoding; what counts is ASCII.
    let text = String::from_utf8_lossy(bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes));
    let given = Given::count_in(&text);
    check_count("vertices", given.0[0], MAX_VERTICES)?;
    check_faces_and_lines(&text, &given)?;
    let mut lines = LineCounter { rest: text.as_bytes(), read: 0 };
    let options = tobj::LoadOptions {
        triangulate: true,
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    let no_materials = |_: &std::path::Path| Ok(Default::default());
    let (models, _) = tobj::load_obj_buf(&mut lines, &options, no_materials).map_err(|error| {
        format!("line {}: {error}; expected {}", lines.read, describe_expected_syntax(error))
    })?;
    let mut mesh = Mesh::default();
    for model in models {
        // Parts that share a vertex have one each.
        mesh.check_room_for_vertices(model.mesh.positions.len() / 3)?;
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(model.mesh.positions.as_chunks().0);
        let (triangles, _) = model.mesh.indices.as_chunks::<3>();
        mesh.triangles.extend(triangles.iter().map(|t| t.map(|i| i.saturating_add(base))));
    }
    Ok(mesh)
}

/// What the indices of a corner name, `v/vt/vn`: the keyword of its lines, and what it is.
const KINDS: [(&str, &str); 3] = [("v", "vertex"), ("vt", "texture coordinate"), ("vn", "normal")];

/// How many there are of each of [`KINDS`].
#[derive(Clone, Copy, Default)]
struct Given([usize; 3]);

impl Given {
    fn count_in(text: &str) -> Self {
        let mut given = Given::default();
        text.lines().for_each(|line| given.count_line(line));
        given
    }

    fn count_line(&mut self, line: &str) {
        let word = line.split_whitespace().next();
        if let Some(kind) = KINDS.iter().position(|(keyword, _)| word == Some(keyword)) {
            self.0[kind] += 1;
        }
    }
}

/// Checks what `tobj` would panic at or has no bound for: the corners of faces and lines.
fn check_faces_and_lines(text: &str, all: &Given) -> Result<(), ParseStop> {
    let (mut above, mut triangles) = (Given::default(), 0);
    for (i, line) in text.lines().enumerate() {
        above.count_line(line);
        let mut words = line.split_whitespace();
        let keyword = words.next();
        if keyword != Some("f") && keyword != Some("l") {
            continue;
        }
        let mut corners = 0;
        for corner in words {
            check_corner(corner, all, &above).map_err(|why| format!("line {}: {why}", i + 1))?;
            corners += 1;
        }
        if keyword == Some("f") {
            if corners < 3 {
                return malformed(format!("line {}: a face of fewer than three corners", i + 1));
            }
            triangles += corners - 2;
        }
    }
    check_count("triangles", triangles, MAX_TRIANGLES)
}

/// Checks the indices of a corner: of those given in the whole file from 1 on, of those given above it
/// from -1 back. A word that is no index is left to `tobj`, and so are texture coordinates and normals
/// where the file gives none: it never looks at them.
fn check_corner(corner: &str, all: &Given, above: &Given) -> Result<(), String> {
    for (kind, word) in corner.split('/').enumerate().take(KINDS.len()) {
        let Ok(index) = word.parse::<isize>() else { continue };
        let (all, above) = (all.0[kind], above.0[kind]);
        let optional = kind > 0;
        let fits = match index {
            0 => optional,
            1.. => index.unsigned_abs() <= all || optional && all == 0,
            _ => index.unsigned_abs() <= above || optional && all == 0,
        };
        if !fits {
            let (keyword, name) = KINDS[kind];
            return Err(format!(
                "`{corner}` names {name} {index}; expected one of the {all} `{keyword}` lines, counted \
                 from 1, or of the {above} above it, counted back from -1"
            ));
        }
    }
    Ok(())
}

fn describe_expected_syntax(error: tobj::LoadError) -> &'static str {
    match error {
        tobj::LoadError::PositionParseError => "`v x y z` with three numbers",
        tobj::LoadError::FaceParseError | tobj::LoadError::InvalidPolygon => {
            "`f a b c ...` with at least three corners, each `v`, `v/vt`, `v//vn` or `v/vt/vn`"
        }
        tobj::LoadError::FaceVertexOutOfBounds
        | tobj::LoadError::FaceTexCoordOutOfBounds
        | tobj::LoadError::FaceNormalOutOfBounds => "indices from 1 to the number given above it",
        _ => "a line as the OBJ format has it",
    }
}

/// A reader that counts the lines read from it.
struct LineCounter<'a> {
    rest: &'a [u8],
    read: usize,
}

impl Read for LineCounter<'_> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let n = self.rest.len().min(into.len());
        into[..n].copy_from_slice(&self.rest[..n]);
        self.consume(n);
        Ok(n)
    }
}

impl BufRead for LineCounter<'_> {
    fn fill_buf(&mut self) -> io::Result<&[u8]> {
        Ok(self.rest)
    }

    fn consume(&mut self, n: usize) {
        let (taken, rest) = self.rest.split_at(n);
        self.read += taken.iter().filter(|&&byte| byte == b'\n').count();
        // The last line may end without one.
        self.read +=
            usize::from(rest.is_empty() && taken.last().is_some_and(|&byte| byte != b'\n'));
        self.rest = rest;
    }
}
