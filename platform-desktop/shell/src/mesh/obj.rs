//! OBJ through `tobj`, with the line at which it stopped.

use super::Mesh;
use std::io::{self, BufRead, Read};

/// Some programs start a text with it; it would make the first line an unknown one.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, String> {
    // Comments and names may be in any encoding; what counts is ASCII.
    let text = String::from_utf8_lossy(bytes.strip_prefix(BYTE_ORDER_MARK).unwrap_or(bytes));
    if let Some(line) = text.lines().position(|line| {
        let mut words = line.split_whitespace();
        words.next() == Some("f") && words.count() < 3
    }) {
        return Err(format!("line {}: a face of fewer than three corners", line + 1));
    }
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
        let base = u32::try_from(mesh.positions.len()).map_err(|_| "too many vertices")?;
        mesh.positions.extend(model.mesh.positions.as_chunks().0);
        let (triangles, _) = model.mesh.indices.as_chunks::<3>();
        mesh.triangles.extend(triangles.iter().map(|t| t.map(|i| i.saturating_add(base))));
    }
    Ok(mesh)
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
