//! STL through `stl_io`, told apart by length and not by the first word, which binary files use too.

use super::{MAX_TRIANGLES, Mesh, ParseStop, check_count, malformed};
use std::io::Cursor;

const HEADER: usize = 80;
const TRIANGLE: usize = 50;

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, ParseStop> {
    let stated = bytes.get(HEADER..HEADER + 4).map(|count| {
        let count = u32::from_le_bytes([count[0], count[1], count[2], count[3]]);
        (count, HEADER as u64 + 4 + u64::from(count) * TRIANGLE as u64)
    });
    let text = bytes.starts_with(b"solid");
    match stated {
        Some((count, length))
            if length == bytes.len() as u64 || (!text && length < bytes.len() as u64) =>
        {
            parse_binary(bytes, count)
        }
        _ if text => parse_text(bytes),
        Some((count, length)) => malformed(format!(
            "its {} bytes are too few for the {count} triangles it states; expected {length}",
            bytes.len()
        )),
        None => malformed(format!(
            "{} bytes; expected `solid`, or a header of {HEADER} bytes and a count",
            bytes.len()
        )),
    }
}

fn parse_binary(bytes: &[u8], count: u32) -> Result<Mesh, ParseStop> {
    check_count("triangles", count as usize, MAX_TRIANGLES)?;
    // The header may start with `solid`, which would be taken for text.
    let mut plain = vec![0; HEADER];
    plain.extend_from_slice(&bytes[HEADER..HEADER + 4 + count as usize * TRIANGLE]);
    let mut mesh = Mesh::default();
    push_solid(&mut mesh, plain)?;
    Ok(mesh)
}

/// Text may hold several solids; each is handed over by itself, under a plain first line.
fn parse_text(bytes: &[u8]) -> Result<Mesh, ParseStop> {
    let text = String::from_utf8_lossy(bytes);
    let mut mesh = Mesh::default();
    let mut solid = None;
    for (i, line) in text.lines().enumerate() {
        let word = line.split_whitespace().next();
        match (word, &mut solid) {
            (Some("solid"), None) => solid = Some(String::from("solid \n")),
            (Some("endsolid"), Some(lines)) => {
                lines.push_str("endsolid\n");
                push_solid(&mut mesh, std::mem::take(lines).into_bytes()).map_err(
                    |stop| match stop {
                        ParseStop::Malformed(what) => ParseStop::Malformed(format!(
                            "in the solid that ends in line {}: {what}",
                            i + 1
                        )),
                        too_large => too_large,
                    },
                )?;
                solid = None;
            }
            (Some(word), None) => {
                return malformed(format!("line {}: found `{word}`; expected `solid`", i + 1));
            }
            (None, _) => {}
            (Some(_), Some(lines)) => {
                lines.push_str(line);
                lines.push('\n');
            }
        }
    }
    match solid {
        None => Ok(mesh),
        Some(_) => malformed("the text ends inside a solid; expected `endsolid`".into()),
    }
}

fn push_solid(mesh: &mut Mesh, solid: Vec<u8>) -> Result<(), ParseStop> {
    let mut cursor = Cursor::new(solid);
    let triangles = stl_io::create_stl_reader(&mut cursor).map_err(|error| error.to_string())?;
    for triangle in triangles {
        let corners = triangle.map_err(|error| error.to_string())?.vertices;
        mesh.check_room_for_triangles(1)?;
        let base = mesh.positions.len() as u32;
        mesh.positions.extend(corners.map(|corner| corner.0));
        mesh.triangles.push([0, 1, 2].map(|i| base + i));
    }
    Ok(())
}
