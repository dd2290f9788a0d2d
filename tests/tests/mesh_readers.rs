//! Mesh files of every kind: read alike, and refused with a reason when they are not whole.
//!
//! Planted faults, and what catches each (tried by hand):
//! - `gltf.rs`: `mirrored` always false -> `gltf_nodes_place_and_mirror`.
//! - `ply.rs`: the test of `element.count` dropped -> `a_count_beyond_the_file_is_refused`.
//! - `stl.rs`: told apart by `solid` alone -> `a_binary_stl_may_start_with_solid`.

use paros_desktop::mesh::{self, Fault, Kind, Mesh};
use proptest::prelude::*;
use std::fmt::Write;
use std::path::Path;

const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.5, 0.0, 0.0],
    [0.0, 2.5, 0.0],
    [1.5, 2.5, 0.0],
    [0.0, 0.0, -3.25],
    [1.5, 0.0, -3.25],
    [0.0, 2.5, -3.25],
    [1.5, 2.5, -3.25],
];

const SIDES: [[u32; 4]; 6] =
    [[0, 1, 3, 2], [5, 4, 6, 7], [4, 0, 2, 6], [1, 5, 7, 3], [2, 3, 7, 6], [4, 5, 1, 0]];

/// Each side as the fan a reader makes of it.
fn triangles() -> Vec<[u32; 3]> {
    SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

fn points(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])).collect()
}

fn expected() -> Vec<[[f32; 3]; 3]> {
    triangles().iter().map(|t| t.map(|i| CORNERS[i as usize])).collect()
}

fn obj() -> Vec<u8> {
    let mut text = String::from("# caf\u{e9}\nmtllib none.mtl\no box\n");
    CORNERS.iter().for_each(|[x, y, z]| writeln!(text, "v {x} {y} {z}").unwrap());
    text.push_str("vt 0 0\nusemtl stone\n");
    let (some, rest) = SIDES.split_at(2);
    for [a, b, c, d] in some {
        writeln!(text, "f {}/1 {}/1 {}/1 {}/1", a + 1, b + 1, c + 1, d + 1).unwrap();
    }
    text.push_str("g rest\n");
    for side in rest {
        let [a, b, c, d] = side.map(|i| i as i32 - 8);
        writeln!(text, "f {a} {b} {c} {d}").unwrap();
    }
    text.into_bytes()
}

fn stl_text() -> Vec<u8> {
    let mut text = String::new();
    for (name, part) in [("a part", &expected()[..5]), ("", &expected()[5..])] {
        writeln!(text, "solid {name}").unwrap();
        for corners in part {
            text.push_str(" facet normal 0 0 0\n  outer loop\n");
            corners.iter().for_each(|[x, y, z]| writeln!(text, "   vertex {x} {y} {z}").unwrap());
            text.push_str("  endloop\n endfacet\n");
        }
        writeln!(text, "endsolid {name}").unwrap();
    }
    text.into_bytes()
}

fn stl_binary() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(12u32.to_le_bytes());
    for corners in expected() {
        bytes.extend([0; 12]);
        bytes.extend(corners.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

fn ply(format: &str) -> Vec<u8> {
    let header = format!(
        "ply\nformat {format} 1.0\ncomment a box\nelement vertex 8\nproperty float x\n\
         property uchar red\nproperty double y\nproperty float z\nelement seam 1\n\
         property short of\nelement face 6\nproperty list uchar int vertex_indices\nend_header\n"
    );
    let mut bytes = header.into_bytes();
    if format == "ascii" {
        let mut text = String::new();
        CORNERS.iter().for_each(|[x, y, z]| writeln!(text, "{x} 9 {y} {z}").unwrap());
        text.push_str("-3\n");
        SIDES.iter().for_each(|[a, b, c, d]| writeln!(text, "4 {a} {b} {c} {d}").unwrap());
        bytes.extend(text.bytes());
        return bytes;
    }
    let mut push = |mut value: Vec<u8>| {
        if format == "binary_big_endian" {
            value.reverse();
        }
        bytes.extend(value);
    };
    for [x, y, z] in CORNERS {
        push(x.to_le_bytes().into());
        push(vec![9]);
        push(f64::from(y).to_le_bytes().into());
        push(z.to_le_bytes().into());
    }
    push((-3i16).to_le_bytes().into());
    for side in SIDES {
        push(vec![4]);
        side.iter().for_each(|i| push(i.to_le_bytes().into()));
    }
    bytes
}

/// Positions, then indices of two bytes.
fn gltf_buffer() -> Vec<u8> {
    let positions = CORNERS.iter().flatten().flat_map(|c| c.to_le_bytes());
    let indices = triangles().into_iter().flatten().flat_map(|i| (i as u16).to_le_bytes());
    positions.chain(indices).collect()
}

fn gltf_json(uri: &str, nodes: &str) -> String {
    format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],
        "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3",
        "min":[0,0,-3.25],"max":[1.5,2.5,0]}},
        {{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":96}},
        {{"buffer":0,"byteOffset":96,"byteLength":72}}],
        "buffers":[{{{uri}"byteLength":168}}]}}"#
    )
}

fn gltf() -> Vec<u8> {
    let mut text = String::new();
    for chunk in gltf_buffer().chunks(3) {
        let bits = chunk.iter().fold(0, |bits, &byte| bits << 8 | u32::from(byte));
        for shift in [18, 12, 6, 0] {
            let alphabet = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
            text.push(char::from(alphabet[(bits >> shift & 63) as usize]));
        }
    }
    let uri = format!(r#""uri":"data:application/octet-stream;base64,{text}","#);
    gltf_json(&uri, r#"{"mesh":0}"#).into_bytes()
}

fn glb() -> Vec<u8> {
    let mut json = gltf_json("", r#"{"mesh":0}"#).into_bytes();
    json.resize(json.len().next_multiple_of(4), b' ');
    let buffer = gltf_buffer();
    let mut bytes = b"glTF".to_vec();
    let length = 12 + 8 + json.len() + 8 + buffer.len();
    bytes.extend([2, length as u32, json.len() as u32].iter().flat_map(|n| n.to_le_bytes()));
    bytes.extend(b"JSON");
    bytes.extend(json);
    bytes.extend((buffer.len() as u32).to_le_bytes());
    bytes.extend(b"BIN\0");
    bytes.extend(buffer);
    bytes
}

fn samples() -> Vec<(&'static str, Kind, Vec<u8>)> {
    vec![
        ("obj", Kind::Obj, obj()),
        ("stl text", Kind::Stl, stl_text()),
        ("stl binary", Kind::Stl, stl_binary()),
        ("ply text", Kind::Ply, ply("ascii")),
        ("ply little", Kind::Ply, ply("binary_little_endian")),
        ("ply big", Kind::Ply, ply("binary_big_endian")),
        ("gltf", Kind::Gltf, gltf()),
        ("glb", Kind::Gltf, glb()),
    ]
}

fn parse(kind: Kind, bytes: &[u8]) -> Result<Mesh, Fault> {
    Mesh::from_bytes(kind, bytes, Path::new("nowhere"))
}

/// What the error says, which must be the kind of error asked for.
fn refused(kind: Kind, bytes: &[u8], like: impl Fn(&Fault) -> bool) -> String {
    let fault = parse(kind, bytes).expect_err("a bad mesh was taken");
    assert!(like(&fault), "{fault:?}");
    fault.to_string()
}

fn malformed(fault: &Fault) -> bool {
    matches!(fault, Fault::Malformed { .. })
}

fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let text = String::from_utf8_lossy(bytes);
    assert!(text.contains(from));
    text.replacen(from, to, 1).into_bytes()
}

#[test]
fn every_kind_reads_alike() {
    for (name, kind, bytes) in samples() {
        let mesh = parse(kind, &bytes).unwrap_or_else(|fault| panic!("{name}: {fault}"));
        assert_eq!(points(&mesh), expected(), "{name}");
        assert_eq!(mesh.winding_faults(), 0);
    }
}

#[test]
fn names_tell_the_kind_and_errors_name_the_file() {
    let folder = std::env::temp_dir().join(format!("paros-mesh-readers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (name, bytes) in [("A.OBJ", obj()), ("b.stl", stl_binary()), ("c.ply", ply("ascii"))] {
        std::fs::write(folder.join(name), bytes).unwrap();
        assert_eq!(points(&mesh::read(&folder.join(name)).unwrap()), expected());
    }
    std::fs::write(folder.join("a box.bin"), gltf_buffer()).unwrap();
    let json = gltf_json(r#""uri":"a%20box.bin","#, r#"{"mesh":0}"#);
    std::fs::write(folder.join("d.gltf"), json).unwrap();
    assert_eq!(points(&mesh::read(&folder.join("d.gltf")).unwrap()), expected());

    std::fs::write(folder.join("e.step"), obj()).unwrap();
    let error = mesh::read(&folder.join("e.step")).unwrap_err();
    assert!(matches!(error.fault, Fault::UnknownKind));
    assert!(error.to_string().contains("e.step") && error.to_string().contains(".ply"));
    let error = mesh::read(&folder.join("none.obj")).unwrap_err();
    assert!(matches!(error.fault, Fault::Unreadable(_)));
    assert!(error.to_string().contains("none.obj"));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_file_cut_anywhere_is_refused_or_whole() {
    for (name, kind, bytes) in samples() {
        // The last line break of a text may go.
        let spare = bytes.iter().rev().take_while(|b| b.is_ascii_whitespace()).count();
        for end in 0..bytes.len() - spare {
            let result = parse(kind, &bytes[..end]);
            let lenient = match name {
                // It tells no length.
                "obj" => true,
                // One solid of two is a whole file.
                "stl text" => String::from_utf8_lossy(&bytes[..end])
                    .lines()
                    .rfind(|line| !line.is_empty())
                    .is_some_and(|line| line.starts_with("endsolid")),
                _ => false,
            };
            if let Ok(mesh) = &result {
                assert!(lenient, "{name} cut to {end} of {} was taken", bytes.len());
                assert!(points(mesh).len() <= 12);
            }
        }
    }
}

#[test]
fn an_empty_file_or_one_without_triangles_is_refused() {
    for kind in [Kind::Stl, Kind::Ply, Kind::Gltf] {
        refused(kind, b"", malformed);
    }
    let empty = |fault: &Fault| matches!(fault, Fault::Empty);
    refused(Kind::Obj, b"", empty);
    refused(Kind::Obj, b"v 0 0 0\nv 1 0 0\nl 1 2\n", empty);
    refused(Kind::Stl, b"solid\nendsolid\n", empty);
    refused(Kind::Stl, &[0; 84], empty);
    let header = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nelement face 0\n\
                  property list uchar int vertex_index\nend_header\n";
    refused(Kind::Ply, header.as_bytes(), empty);
    refused(Kind::Gltf, br#"{"asset":{"version":"2.0"}}"#, empty);
}

#[test]
fn only_degenerate_triangles_are_refused() {
    let text = "v 0 0 0\nv 1 1 1\nv 3 3 3\nf 1 2 3\nf 1 1 2\nf 3 3 3\n";
    refused(Kind::Obj, text.as_bytes(), |fault| matches!(fault, Fault::NoArea));
    let one_good = format!("{text}v 0 5 0\nf 1 2 4\n");
    assert_eq!(parse(Kind::Obj, one_good.as_bytes()).unwrap().triangles.len(), 4);
}

#[test]
fn coordinates_that_are_no_place_are_refused() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.1e9, -3e38] {
        let mut binary = stl_binary();
        binary[84 + 12 + 50 * 3..][..4].copy_from_slice(&value.to_le_bytes());
        let bad = |fault: &Fault| matches!(fault, Fault::Coordinate { vertex: 9, .. });
        let said = refused(Kind::Stl, &binary, bad);
        assert!(said.contains("vertex 9") && said.contains("1e9"), "{said}");
        let text = replaced(&obj(), "v 1.5 2.5 0", &format!("v 1.5 {value} 0"));
        refused(Kind::Obj, &text, |fault| matches!(fault, Fault::Coordinate { .. }));
        // In text, a reader may refuse the word before the number is looked at.
        let text = replaced(&stl_text(), "vertex 1.5 2.5 0", &format!("vertex 1.5 {value} 0"));
        refused(Kind::Stl, &text, |_| true);
        let text = replaced(&ply("ascii"), "1.5 9 2.5 0", &format!("1.5 9 {value} 0"));
        refused(Kind::Ply, &text, |_| true);
        let mut binary = glb();
        let start = binary.len() - 168;
        binary[start + 4..][..4].copy_from_slice(&value.to_le_bytes());
        refused(Kind::Gltf, &binary, |fault| matches!(fault, Fault::Coordinate { vertex: 0, .. }));
    }
    let at_the_bound = replaced(&obj(), "v 1.5 2.5 0", "v 1.5 1e9 0");
    assert!(parse(Kind::Obj, &at_the_bound).is_ok());
}

#[test]
fn indices_out_of_range_are_refused() {
    for bad in ["f 1 2 9", "f 0 1 2", "f -9 1 2", "f 1/2 2/1 3/1", "f 99999999999999999999 1 2"] {
        let text = [obj(), bad.as_bytes().to_vec()].concat();
        let said = refused(Kind::Obj, &text, malformed);
        assert!(said.contains("line 21"), "{said}");
    }
    let text = replaced(&ply("ascii"), "4 5 4 6 7", "4 5 4 6 8");
    let index = |fault: &Fault| matches!(fault, Fault::Index { index: 8, vertices: 8, .. });
    refused(Kind::Ply, &text, index);
    let text = replaced(&ply("ascii"), "4 5 4 6 7", "4 5 4 6 -1");
    assert!(refused(Kind::Ply, &text, malformed).contains("face 1"));
    let mut binary = glb();
    let end = binary.len() - 2;
    binary[end..].copy_from_slice(&8u16.to_le_bytes());
    assert!(refused(Kind::Gltf, &binary, malformed).contains("index 8"));
}

#[test]
fn a_count_beyond_the_file_is_refused() {
    let many = "element vertex 99999999999";
    let said = refused(Kind::Ply, &replaced(&ply("ascii"), "element vertex 8", many), malformed);
    assert!(said.contains("99999999999"), "{said}");
    // Without properties a binary element is no bytes long.
    let binary = ply("binary_little_endian");
    let hollow = replaced(&binary, "element seam 1", "element hollow 99999999999\nelement seam 1");
    refused(Kind::Ply, &hollow, malformed);
    let mut binary = stl_binary();
    binary[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(refused(Kind::Stl, &binary, malformed).contains("4294967295"));
    for (from, to) in [
        (r#""count":8"#, r#""count":9"#),
        (r#""count":36"#, r#""count":99999999999999999"#),
        (r#""byteLength":96"#, r#""byteLength":18446744073709551615"#),
        (r#""byteOffset":96"#, r#""byteOffset":97"#),
        (r#""byteLength":168"#, r#""byteLength":169"#),
    ] {
        refused(Kind::Gltf, &replaced(&gltf(), from, to), malformed);
    }
}

#[test]
fn vertices_without_a_triangle_are_dropped() {
    let text = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv -9 9 9\nv 0 1 0\nf 2 3 5\n";
    let mesh = parse(Kind::Obj, text.as_bytes()).unwrap();
    assert_eq!(mesh.bounds(), Some(([0.0; 3], [1.0, 1.0, 0.0])));
    let text = replaced(&ply("ascii"), "vertex 8", "vertex 9");
    let mesh = parse(Kind::Ply, &replaced(&text, "-3\n", "7 7 7 7\n-3\n")).unwrap();
    assert_eq!((points(&mesh), mesh.positions.len()), (expected(), 8));
}

#[test]
fn a_binary_stl_may_start_with_solid() {
    let mut bytes = stl_binary();
    bytes[..6].copy_from_slice(b"solid ");
    assert_eq!(points(&parse(Kind::Stl, &bytes).unwrap()), expected());
}

#[test]
fn gltf_nodes_place_and_mirror() {
    let child = r#"{"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[-2,1,1]}"#;
    let mesh = parse(Kind::Gltf, &replaced(&gltf(), r#"{"mesh":0}"#, child)).unwrap();
    let moved = |[a, b, c]: [[f32; 3]; 3]| [a, c, b].map(|p| [10.0 - 2.0 * p[0], p[1], p[2]]);
    assert_eq!(points(&mesh), expected().into_iter().map(moved).collect::<Vec<_>>());
    let ring = r#"{"children":[1]},{"mesh":0,"children":[0]}"#;
    refused(Kind::Gltf, &replaced(&gltf(), r#"{"mesh":0}"#, ring), malformed);
}

#[test]
fn gltf_strips_and_fans_are_split() {
    // The first indices of the box are 0, 1, 3, 0.
    for (mode, split) in [(5, [[0, 1, 3], [3, 1, 0]]), (6, [[0, 1, 3], [0, 3, 0]])] {
        let text = replaced(&gltf(), r#""indices":1"#, &format!(r#""indices":1,"mode":{mode}"#));
        let text = replaced(&text, r#""count":36"#, r#""count":4"#);
        let mesh = parse(Kind::Gltf, &text).unwrap();
        assert_eq!(points(&mesh), split.map(|t| t.map(|i| CORNERS[i])));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(6000) })]

    /// Whatever the bytes: a mesh that keeps its promises, or an error with something to say.
    #[test]
    fn spoilt_bytes_never_panic(
        sample in 0..8usize,
        spoil in prop::collection::vec((any::<prop::sample::Index>(), 0..4u8, any::<u8>()), 1..6),
    ) {
        let (_, kind, mut bytes) = samples().swap_remove(sample);
        for (place, how, byte) in spoil {
            let at = place.index(bytes.len());
            match how {
                0 => bytes[at] = byte,
                1 => bytes[at] ^= 1 << (byte % 8),
                2 => bytes.insert(at, byte),
                _ => drop(bytes.remove(at)),
            }
        }
        match parse(kind, &bytes) {
            Ok(mesh) => {
                prop_assert!(!mesh.triangles.is_empty());
                let vertices = mesh.positions.len() as u32;
                prop_assert!(mesh.triangles.as_flattened().iter().all(|&i| i < vertices));
                prop_assert!(mesh.positions.as_flattened().iter().all(|c| c.abs() <= 1e9));
            }
            Err(fault) => prop_assert!(!fault.to_string().is_empty()),
        }
    }

    #[test]
    fn bytes_of_any_sort_never_panic(kind in 0..4usize, bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let kind = [Kind::Obj, Kind::Stl, Kind::Ply, Kind::Gltf][kind];
        let _ = parse(kind, &bytes);
    }
}
