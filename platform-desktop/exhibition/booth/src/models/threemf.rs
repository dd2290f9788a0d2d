//! Writer of 3MF (3D Manufacturing Format, core specification 1.3). Vertices are shared and the file is
//! compressed: it is a third of the STL's size.

use std::collections::HashMap;
use std::fmt::Write as _;
use std::io::{self, Cursor, Write as _};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

/// The bytes of an STL's header, and of a triangle.
const STL_HEAD: usize = 84;
const STL_TRIANGLE: usize = 50;

/// The bytes of text that are compressed at once.
const PIECE: usize = 64 << 10;

const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

const RELATIONS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

const MODEL_HEAD: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<model unit="millimeter" xml:lang="en" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02"><resources><object id="1" type="model"><mesh><vertices>
"#;

const MODEL_END: &str =
    "</triangles></mesh></object></resources><build><item objectid=\"1\"/></build></model>\n";

/// Converts a binary STL in millimetres to 3MF. Leaves out triangles with fewer than three different corners,
/// which 3MF forbids.
///
/// # Errors
/// A description of what is wrong with the STL.
pub(crate) fn write_3mf(stl: &[u8]) -> Result<Vec<u8>, String> {
    let (corners, triangles) = read_stl(stl)?;
    pack(&corners, &triangles).map_err(|error| error.to_string())
}

pub(crate) type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// Reads an STL. Returns each different corner once, in order of first use, and the triangles as indices of
/// corners.
pub(crate) fn read_stl(stl: &[u8]) -> Result<Mesh, String> {
    let triangles = stl.get(STL_HEAD..).ok_or("an STL is longer")?;
    if triangles.len() % STL_TRIANGLE != 0 {
        return Err("an STL is whole triangles".into());
    }
    let (mut corners, mut numbers) = (Vec::new(), HashMap::new());
    let mut mesh = Vec::with_capacity(triangles.len() / STL_TRIANGLE);
    for triangle in triangles.chunks_exact(STL_TRIANGLE) {
        let mut of_triangle = [0; 3];
        for (number, bytes) in of_triangle.iter_mut().zip(triangle[12..48].chunks_exact(12)) {
            let float = |k: usize| f32::from_le_bytes([0, 1, 2, 3].map(|b| bytes[4 * k + b]));
            // Adding 0.0 turns -0.0 into 0.0.
            let corner = [0, 1, 2].map(|k| float(k) + 0.0);
            if !corner.iter().all(|place| place.is_finite()) {
                return Err("a corner of the STL is nowhere".into());
            }
            *number = *numbers.entry(corner.map(f32::to_bits)).or_insert_with(|| {
                corners.push(corner);
                corners.len() as u32 - 1
            });
        }
        let [a, b, c] = of_triangle;
        if a != b && b != c && c != a {
            mesh.push(of_triangle);
        }
    }
    Ok((corners, mesh))
}

fn pack(corners: &[[f32; 3]], triangles: &[[u32; 3]]) -> io::Result<Vec<u8>> {
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in [("[Content_Types].xml", CONTENT_TYPES), ("_rels/.rels", RELATIONS)] {
        zip.start_file(name, options)?;
        zip.write_all(text.as_bytes())?;
    }
    zip.start_file("3D/3dmodel.model", options)?;
    let mut text = MODEL_HEAD.to_owned();
    for [x, y, z] in corners {
        // Writing to a String doesn't fail.
        let _ = writeln!(text, "<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>");
        write_piece(&mut zip, &mut text, PIECE)?;
    }
    text.push_str("</vertices><triangles>\n");
    for [a, b, c] in triangles {
        let _ = writeln!(text, "<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\"/>");
        write_piece(&mut zip, &mut text, PIECE)?;
    }
    text.push_str(MODEL_END);
    write_piece(&mut zip, &mut text, 0)?;
    Ok(zip.finish()?.into_inner())
}

/// Compresses and clears the text if it has reached `length`.
fn write_piece(zip: &mut impl io::Write, text: &mut String, length: usize) -> io::Result<()> {
    if text.len() >= length {
        zip.write_all(text.as_bytes())?;
        text.clear();
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Read as _};

    use zip::ZipArchive;

    use super::{STL_HEAD, write_3mf};

    fn stl_of(triangles: &[[[f32; 3]; 3]]) -> Vec<u8> {
        let mut stl = vec![0; STL_HEAD];
        for triangle in triangles {
            stl.extend([0; 12]);
            let places = triangle.iter().flatten();
            stl.extend(places.flat_map(|place| place.to_le_bytes()));
            stl.extend([0; 2]);
        }
        stl
    }

    /// Reads the quoted numbers of all elements with a name.
    fn elements<T: std::str::FromStr>(model: &str, name: &str) -> Vec<[T; 3]> {
        let lines = model.lines().filter(|line| line.starts_with(&format!("<{name} ")));
        let numbers = lines.map(|line| {
            let quoted = line.split('"').skip(1).step_by(2);
            let numbers: Vec<T> = quoted.filter_map(|number| number.parse().ok()).collect();
            numbers.try_into().ok().expect("three numbers")
        });
        numbers.collect()
    }

    #[test]
    fn each_triangle_is_there_with_its_corners() {
        let corners =
            [[0.0f32, 0.0, 0.0], [1.5e-7, -0.1, 0.0], [0.0, 120.00001, 0.0], [3.0, 0.0, 1.0]];
        let of = |numbers: [usize; 3]| numbers.map(|number| corners[number]);
        let mut triangles = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]].map(of).to_vec();
        let expected = triangles.clone();
        // A triangle without an area is left out; -0.0 and 0.0 are the same corner.
        triangles.push(of([1, 1, 2]));
        triangles[1][0] = [-0.0, 0.0, -0.0];
        let packed = write_3mf(&stl_of(&triangles)).expect("a mesh");
        let mut zip = ZipArchive::new(Cursor::new(packed)).expect("a zip");
        assert_eq!(zip.len(), 3);
        let mut model = String::new();
        zip.by_name("3D/3dmodel.model").unwrap().read_to_string(&mut model).expect("text");
        let vertices: Vec<[f32; 3]> = elements(&model, "vertex");
        assert_eq!(vertices.len(), 4, "each once");
        let read = elements::<usize>(&model, "triangle");
        let read: Vec<_> = read.into_iter().map(|triangle| triangle.map(|v| vertices[v])).collect();
        assert_eq!(read, expected);
    }

    #[test]
    fn what_is_no_stl_is_refused() {
        let fine = stl_of(&[[[0.0; 3], [1.0; 3], [2.0; 3]]]);
        for bad in [&[][..], &fine[..83], &fine[..fine.len() - 1]] {
            assert!(write_3mf(bad).is_err());
        }
        assert!(write_3mf(&stl_of(&[[[f32::NAN; 3], [1.0; 3], [2.0; 3]]])).is_err());
    }
}
