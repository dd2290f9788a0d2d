//! Dialects of mesh files: the sample box as other programs write it, with additional unused data.

use paros_shell::mesh::{Mesh, MeshFormat};
use paros_tests_files::mesh_samples::*;
use std::fmt::Write;
use std::path::Path;

fn read(kind: MeshFormat, bytes: &[u8]) -> Mesh {
    Mesh::from_bytes(kind, bytes, Path::new("nowhere"))
        .unwrap_or_else(|fault| panic!("{kind}: {fault}\n{}", String::from_utf8_lossy(bytes)))
}

fn assert_is_box(kind: MeshFormat, bytes: impl AsRef<[u8]>) {
    let mesh = read(kind, bytes.as_ref());
    assert_eq!(
        triangle_points(&mesh),
        expected_points(),
        "{}",
        String::from_utf8_lossy(bytes.as_ref())
    );
}

fn text_of(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn utf16(text: &str, bytes_of: fn(u16) -> [u8; 2]) -> Vec<u8> {
    std::iter::once(0xfeff).chain(text.encode_utf16()).flat_map(bytes_of).collect()
}

#[test]
fn texts_have_any_line_end_mark_and_encoding() {
    for (kind, text) in [
        (MeshFormat::Obj, text_of(&obj_file())),
        (MeshFormat::Stl, text_of(&stl_text())),
        (MeshFormat::Ply, text_of(&ply_file("ascii"))),
    ] {
        for end in ["\r\n", "\r", " \t\n", "\n"] {
            assert_is_box(kind, text.replace('\n', end));
        }
        assert_is_box(kind, format!("\u{feff}{text}"));
        assert_is_box(kind, utf16(&text, u16::to_le_bytes));
        assert_is_box(kind, utf16(&text, u16::to_be_bytes));
        assert_is_box(kind, text.replace(' ', "\t \u{b}"));
        assert_is_box(kind, format!("{text}\0\0\0\0"));
        assert_is_box(kind, format!("{text}\n\n\u{1a}"));
    }
    for format in ["binary_little_endian", "binary_big_endian"] {
        let bytes = ply_file(format);
        let end = bytes.windows(10).position(|w| w == b"end_header").unwrap() + 11;
        let header = text_of(&bytes[..end]);
        for line_end in ["\r\n", "\r"] {
            assert_is_box(
                MeshFormat::Ply,
                [header.replace('\n', line_end).as_bytes(), &bytes[end..]].concat(),
            );
        }
    }
}

/// Returns the box as OBJ with `tail` after each vertex and `corner` after each corner.
fn obj_with(tail: &str, corner: &str) -> String {
    let mut text = String::new();
    CORNERS.iter().for_each(|[x, y, z]| writeln!(text, "v {x} {y} {z}{tail}").unwrap());
    for side in SIDES {
        let corners: Vec<String> = side.iter().map(|i| format!("{}{corner}", i + 1)).collect();
        writeln!(text, "f {}", corners.join(" ")).unwrap();
    }
    text
}

#[test]
fn obj_lines_hold_more_than_is_used() {
    for tail in ["", " 1", " 0.5 0.5 0.5", " 1 0 0 0.5", " -nan(ind)", " # corner", " 1.#IND x"] {
        assert_is_box(MeshFormat::Obj, obj_with(tail, ""));
    }
    for corner in ["/", "//", "/1", "//1", "/1/1", "/-1/-1", "/nan", ".0", "/9999//"] {
        assert_is_box(MeshFormat::Obj, obj_with("", corner));
    }
    let unused = "vn -nan(ind) 1.#QNAN\nvt 0\nvt\nvp 1\nmtllib C:\\parts\\\nusemtl\ns off\nl 1 99\n\
                  p 7\ncurv2 1\ncall x\ng \\\n# C:\\models\\\n";
    assert_is_box(MeshFormat::Obj, format!("{unused}{}", obj_with("", "")));
    assert_is_box(MeshFormat::Obj, obj_with("", "").replace("v ", "V ").replace("f ", "F "));
    assert_is_box(MeshFormat::Obj, obj_with("", "").replace("f ", "fo "));
    assert_is_box(MeshFormat::Obj, obj_with("", "").replace("1.5", "1,5").replace("2.5", "2.5D0"));
    // Every line of a face continues over two line ends.
    assert_is_box(MeshFormat::Obj, obj_with("", "").replace("f ", "f \\\n  \\\r\n"));
    assert_is_box(MeshFormat::Obj, obj_with("", " \\\n").replace("\\\n\n", "\n"));
}

#[test]
fn obj_faces_may_stand_above_their_vertices_and_count_back() {
    let text = obj_with("", "");
    let (vertices, faces) = text.split_at(text.find('f').unwrap());
    assert_is_box(MeshFormat::Obj, format!("{faces}{vertices}"));
    // Each face has its own vertices, with indices counted back from the end.
    let mut own = String::new();
    for side in SIDES {
        for [x, y, z] in side.map(|i| CORNERS[i as usize]) {
            writeln!(own, "v {x} {y} {z}").unwrap();
        }
        own.push_str("f -4/-4 -3 -2 -1\n");
    }
    assert_is_box(MeshFormat::Obj, &own);
    assert_eq!(read(MeshFormat::Obj, own.as_bytes()).positions.len(), 8, "they are welded");
    // Invalid facets are dropped and counted.
    let mesh = read(MeshFormat::Obj, format!("{own}f 1 2\nf\nf 1 1 2\n").as_bytes());
    assert_eq!((mesh.triangles.len(), mesh.findings.dropped_facets), (12, 3));
}

#[test]
fn stl_texts_have_any_case_and_layout() {
    let text = text_of(&stl_text());
    let normal = |numbers: &str| text.replace("normal 0 0 0", &format!("normal {numbers}"));
    for numbers in ["-nan(ind) -nan(ind) -nan(ind)", "1.#IND 1.#QNAN 0", "nan nan nan", "", "x"] {
        assert_is_box(MeshFormat::Stl, normal(numbers));
    }
    assert_is_box(MeshFormat::Stl, text.to_uppercase());
    assert_is_box(MeshFormat::Stl, text.replace("facet", "Facet").replace("solid", "Solid"));
    assert_is_box(MeshFormat::Stl, format!(" \r\n\t{text}"));
    assert_is_box(MeshFormat::Stl, text.replace("endsolid a part\n", "").replace("endsolid", ""));
    assert_is_box(MeshFormat::Stl, text.trim_end().trim_end_matches("endsolid"));
    // A facet in one line, and extra words between facets.
    let lines = text.replace("\n  outer", " outer").replace("\n   v", " v").replace("\n  e", " e");
    assert_is_box(MeshFormat::Stl, lines.replace("\n e", " e"));
    assert_is_box(MeshFormat::Stl, format!("{text}\n# made by a program\ncolor 1 0 0\n"));
    // Faces with four corners.
    let mut quads = String::from("solid\n");
    for side in SIDES {
        quads.push_str("facet normal 0 0 0\nouter loop\n");
        for [x, y, z] in side.map(|i| CORNERS[i as usize]) {
            writeln!(quads, "vertex {x} {y} {z}").unwrap();
        }
        quads.push_str("endloop\nendfacet\n");
    }
    assert_is_box(MeshFormat::Stl, quads);
}

#[test]
fn stl_faults_name_the_line() {
    for (text, expected) in [
        ("solid\nfacet\nouter loop\nvertex 0 0\nendloop\n", "line 5: found `endloop`; expected"),
        ("solid\nvertex 0 0 0\n", "line 2: found `vertex` outside a facet"),
        ("solid\nfacet\nfacet\n", "line 3: found `facet` inside a facet; expected `endfacet`"),
        ("solid\r\nfacet\r\nouter loop\r\n", "the text ends inside the facet of line 2"),
    ] {
        let fault = Mesh::from_bytes(MeshFormat::Stl, text.as_bytes(), Path::new("")).unwrap_err();
        assert!(fault.to_string().contains(expected), "{fault}");
    }
}

#[test]
fn a_binary_stl_is_one_by_its_length() {
    for header in [
        &b"solid facet outer loop"[..],
        b"SOLID a\n facet",
        b"COLOR=\xff\xff",
        b"\xef\xbb\xbfsolid",
    ] {
        let mut bytes = stl_binary();
        bytes[..header.len()].copy_from_slice(header);
        assert_is_box(MeshFormat::Stl, &bytes);
    }
    let mut bytes = stl_binary();
    bytes[..6].copy_from_slice(b"solid ");
    // Normals and attributes that aren't numbers, and bytes after the last facet.
    for facet in 0..12 {
        bytes[84 + 50 * facet..][..12].fill(0xff);
        bytes[84 + 50 * facet + 48..][..2].fill(0xff);
    }
    assert_is_box(MeshFormat::Stl, &bytes);
    assert_is_box(MeshFormat::Stl, [&bytes[..], b"\0\0\0"].concat());
}

/// Returns a PLY text of the box from its header after the format, and the rows of its elements.
fn ply_with(header: &str, rows: &str) -> String {
    format!("ply\nformat ascii 1.0\n{header}end_header\n{rows}")
}

fn rows_of_vertices(behind: &str) -> String {
    CORNERS.iter().map(|[x, y, z]| format!("{x} {y} {z}{behind}\n")).collect()
}

fn rows_of_faces(before: &str, index: &str) -> String {
    let row = |side: &[u32; 4]| {
        let [a, b, c, d] = side.map(|i| format!("{i}{index}"));
        format!("{before}4 {a} {b} {c} {d}\n")
    };
    SIDES.iter().map(row).collect()
}

const PLY_VERTICES: &str =
    "element vertex 8\nproperty float x\nproperty float y\nproperty float z\n";
const PLY_FACES: &str = "element face 6\nproperty list uchar int vertex_indices\n";

#[test]
fn ply_headers_and_rows_hold_more_than_is_used() {
    let plain = ply_with(
        &format!("{PLY_VERTICES}{PLY_FACES}"),
        &(rows_of_vertices("") + &rows_of_faces("", "")),
    );
    assert_is_box(MeshFormat::Ply, &plain);
    let blank = plain.replace("element face", "\n \ncomment caf\u{e9}\nobj_info x\nelement face");
    assert_is_box(MeshFormat::Ply, &blank);
    let latin1: Vec<u8> = blank.chars().map(|c| c as u8).collect();
    assert_is_box(MeshFormat::Ply, &latin1);
    assert_is_box(MeshFormat::Ply, plain.replace("float", "float64").replace("int v", "float v"));
    assert_is_box(MeshFormat::Ply, plain.replace("vertex_indices", "vertex_index"));
    assert_is_box(MeshFormat::Ply, plain.replace("vertex_indices", "corners"));
    let unused = ply_with(
        &format!(
            "{PLY_VERTICES}property float nx\nproperty list uchar float u\n{PLY_FACES}property uchar r\n"
        ),
        &(rows_of_vertices(" -nan(ind) 2 nan 1.#IND")
            + &rows_of_faces("", ".0").replace('\n', " x\n")),
    );
    assert_is_box(MeshFormat::Ply, unused);
    // Columns that the header doesn't name, blank lines, everything in one line, and faces first.
    let more = ply_with(
        &format!("{PLY_VERTICES}{PLY_FACES}"),
        &(rows_of_vertices(" 1 2 3\n") + &rows_of_faces("", "").replace('\n', " 255\n\n")),
    );
    assert_is_box(MeshFormat::Ply, more);
    let (header, rows) = plain.split_at(plain.find("end_header\n").unwrap() + 11);
    assert_is_box(MeshFormat::Ply, format!("{header}{}", rows.replace('\n', " ")));
    let faces_first = ply_with(
        &format!("{PLY_FACES}{PLY_VERTICES}"),
        &(rows_of_faces("", "") + &rows_of_vertices("")),
    );
    assert_is_box(MeshFormat::Ply, faces_first);
}

#[test]
fn ply_lists_are_of_any_type() {
    let header =
        format!("{PLY_VERTICES}element face 6\nproperty list COUNT INDEX vertex_indices\n");
    type WriteNumber = fn(u32) -> Vec<u8>;
    let types: [(&str, WriteNumber); 8] = [
        ("char", |i| (i as i8).to_be_bytes().into()),
        ("uchar", |i| (i as u8).to_be_bytes().into()),
        ("int16", |i| (i as i16).to_be_bytes().into()),
        ("ushort", |i| (i as u16).to_be_bytes().into()),
        ("int32", |i| (i as i32).to_be_bytes().into()),
        ("uint", |i| i.to_be_bytes().into()),
        ("float", |i| (i as f32).to_be_bytes().into()),
        ("double", |i| f64::from(i).to_be_bytes().into()),
    ];
    for (count, count_bytes) in &types {
        for (index, index_bytes) in &types {
            for is_big in [true, false] {
                let format = if is_big { "big" } else { "little" };
                let header = header.replace("COUNT", count).replace("INDEX", index);
                let mut bytes =
                    format!("ply\nformat binary_{format}_endian 1.0\n{header}end_header\n")
                        .into_bytes();
                let mut push = |mut value: Vec<u8>| {
                    if !is_big {
                        value.reverse();
                    }
                    bytes.extend(value);
                };
                CORNERS.as_flattened().iter().for_each(|c| push(c.to_be_bytes().into()));
                for side in SIDES {
                    push(count_bytes(4));
                    side.iter().for_each(|&i| push(index_bytes(i)));
                }
                assert_is_box(MeshFormat::Ply, bytes);
            }
        }
    }
}

/// Strips end at -1, in one list or several, and each starts with its first side outwards.
#[test]
fn ply_strips_are_split() {
    let strip = |[a, b, c, d]: &[u32; 4]| format!("{a} {b} {d} {c}");
    let strips: Vec<String> = SIDES.iter().map(strip).collect();
    let mut expected = Vec::new();
    for [a, b, c, d] in SIDES {
        expected.extend([[a, b, d], [d, b, c]].map(|t| t.map(|i| CORNERS[i as usize])));
    }
    let element = |count: usize, index: &str| {
        format!(
            "{PLY_VERTICES}element tristrips {count}\nproperty list int {index} vertex_indices\n"
        )
    };
    let one = format!("29 {}\n", strips.join(" -1 "));
    let several: String = strips.iter().map(|strip| format!("4 {strip}\n")).collect();
    let ended: String = strips.iter().map(|strip| format!("5 {strip} -1\n")).collect();
    for (header, rows) in [
        (element(1, "int"), one.clone()),
        (element(1, "uint"), one.replace("-1", "4294967295")),
        (element(1, "float"), one.replace("-1", "-1.0")),
        (element(6, "int"), several),
        (element(6, "int"), ended),
    ] {
        let text = ply_with(&header, &(rows_of_vertices("") + &rows));
        assert_eq!(triangle_points(&read(MeshFormat::Ply, text.as_bytes())), expected, "{text}");
    }
}

#[test]
fn ply_faults_name_the_place() {
    let good = ply_with(
        &format!("{PLY_VERTICES}{PLY_FACES}"),
        &(rows_of_vertices("") + &rows_of_faces("", "")),
    );
    for (from, to, expected) in [
        ("ply\n", "plx\n", "line 1: found `plx`; expected `ply`"),
        ("ascii", "ebcdic", "line 2: found `format ebcdic 1.0`; expected `ascii`"),
        (
            "property float y",
            "property real y",
            "line 5: found `property real y`; expected `property TYPE",
        ),
        ("property float y\n", "", "its header gives vertices no `y`"),
        ("element face", "element facet", "its header has no elements `vertex` and `face`"),
        ("end_header", "header_end", "line 9: found `header_end`; expected `format`"),
        ("4 5 4 6 7", "4 5 x 6 7", "line 19: face 1: found `x`; expected a number"),
        ("4 5 4 6 7", "-4 5 4 6 7", "face 1: found -4 as a list's length"),
    ] {
        let text = good.replace(from, to);
        let fault = Mesh::from_bytes(MeshFormat::Ply, text.as_bytes(), Path::new("")).unwrap_err();
        assert!(fault.to_string().contains(expected), "{fault}");
    }
}
