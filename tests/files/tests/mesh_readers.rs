//! Mesh files of every kind: all give the same mesh, and incomplete files are rejected with a reason.

use paros_models::cases::scaled_cases;
use paros_shell::mesh::{self, Mesh, MeshBounds, MeshFault, MeshFormat};
use paros_tests_files::mesh_samples::*;
use proptest::prelude::*;
use std::path::Path;

fn parse_mesh(kind: MeshFormat, bytes: &[u8]) -> Result<Mesh, MeshFault> {
    Mesh::from_bytes(kind, bytes, Path::new("nowhere"))
}

/// Parses a bad mesh and returns the error's text. Asserts that the error is of the expected kind.
fn parse_refusal(kind: MeshFormat, bytes: &[u8], like: impl Fn(&MeshFault) -> bool) -> String {
    let fault = parse_mesh(kind, bytes).expect_err("a bad mesh was taken");
    assert!(like(&fault), "{fault:?}");
    fault.to_string()
}

fn is_malformed(fault: &MeshFault) -> bool {
    matches!(fault, MeshFault::Malformed { .. })
}

fn replace_text(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let text = String::from_utf8_lossy(bytes);
    assert!(text.contains(from));
    text.replacen(from, to, 1).into_bytes()
}

#[test]
fn every_kind_reads_alike() {
    for (name, kind, bytes) in all_samples() {
        let mesh = parse_mesh(kind, &bytes).unwrap_or_else(|fault| panic!("{name}: {fault}"));
        assert_eq!(triangle_points(&mesh), expected_points(), "{name}");
        assert_eq!((mesh.findings.winding_faults, mesh.findings.open_edges), (0, 0), "{name}");
        assert_eq!(mesh.findings.closed_shells, 1, "{name}");
    }
}

#[test]
fn names_tell_the_kind_and_errors_name_the_file() {
    let folder = std::env::temp_dir().join(format!("paros-mesh-readers-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    for (name, bytes) in
        [("A.OBJ", obj_file()), ("b.stl", stl_binary()), ("c.ply", ply_file("ascii"))]
    {
        std::fs::write(folder.join(name), bytes).unwrap();
        assert_eq!(triangle_points(&mesh::read(&folder.join(name)).unwrap()), expected_points());
    }
    std::fs::write(folder.join("a box.bin"), gltf_buffer()).unwrap();
    let json = gltf_json(r#""uri":"a%20box.bin","#, r#"{"mesh":0}"#);
    std::fs::write(folder.join("d.gltf"), json).unwrap();
    assert_eq!(triangle_points(&mesh::read(&folder.join("d.gltf")).unwrap()), expected_points());

    std::fs::write(folder.join("e.step"), obj_file()).unwrap();
    let error = mesh::read(&folder.join("e.step")).unwrap_err();
    assert!(matches!(error.fault, MeshFault::UnknownKind));
    assert!(error.to_string().contains("e.step") && error.to_string().contains(".ply"));
    let error = mesh::read(&folder.join("none.obj")).unwrap_err();
    assert!(matches!(error.fault, MeshFault::Unreadable(_)));
    assert!(error.to_string().contains("none.obj"));
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_file_cut_anywhere_is_refused_or_whole() {
    for (name, kind, bytes) in all_samples() {
        // The last line break of a text may be missing.
        let spare = bytes.iter().rev().take_while(|b| b.is_ascii_whitespace()).count();
        for end in 0..bytes.len() - spare {
            let result = parse_mesh(kind, &bytes[..end]);
            let lenient = match name {
                // OBJ states no length, so any prefix may be valid.
                "obj" => true,
                // A text may end after any facet.
                "stl text" => String::from_utf8_lossy(&bytes[..end])
                    .lines()
                    .rfind(|line| line.contains("facet"))
                    .is_some_and(|line| line.trim() == "endfacet"),
                _ => false,
            };
            if let Ok(mesh) = &result {
                assert!(lenient, "{name} cut to {end} of {} was taken", bytes.len());
                assert!(triangle_points(mesh).len() <= 12);
            }
        }
    }
}

#[test]
fn an_empty_file_or_one_without_triangles_is_refused() {
    for kind in [MeshFormat::Stl, MeshFormat::Ply, MeshFormat::Gltf] {
        parse_refusal(kind, b"", is_malformed);
    }
    let empty = |fault: &MeshFault| matches!(fault, MeshFault::Empty);
    parse_refusal(MeshFormat::Obj, b"", empty);
    parse_refusal(MeshFormat::Obj, b"v 0 0 0\nv 1 0 0\nl 1 2\n", empty);
    parse_refusal(MeshFormat::Stl, b"solid\nendsolid\n", empty);
    parse_refusal(MeshFormat::Stl, &[0; 84], empty);
    let header = "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n\
                  property float z\nelement face 0\n\
                  property list uchar int vertex_index\nend_header\n";
    parse_refusal(MeshFormat::Ply, header.as_bytes(), empty);
    parse_refusal(MeshFormat::Gltf, br#"{"asset":{"version":"2.0"}}"#, empty);
}

#[test]
fn only_degenerate_triangles_are_refused() {
    let text = "v 0 0 0\nv 1 1 1\nv 3 3 3\nf 1 2 3\nf 1 1 2\nf 3 3 3\n";
    parse_refusal(MeshFormat::Obj, text.as_bytes(), |fault| matches!(fault, MeshFault::NoArea));
    let one_good = format!("{text}v 0 5 0\nf 1 2 4\n");
    let mesh = parse_mesh(MeshFormat::Obj, one_good.as_bytes()).unwrap();
    assert_eq!((mesh.triangles.len(), mesh.findings.dropped_facets), (1, 3));
}

#[test]
fn coordinates_that_are_no_place_are_refused() {
    for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.1e12, -3e38] {
        let refuses = |kind, bytes: &[u8], place: &str| {
            let said = parse_refusal(kind, bytes, is_malformed);
            assert!(said.contains(place) && said.contains("at most 1e12"), "{said}");
        };
        let mut binary = stl_binary();
        binary[84 + 12 + 50 * 3..][..4].copy_from_slice(&value.to_le_bytes());
        refuses(MeshFormat::Stl, &binary, "byte 234: facet 3");
        let text = replace_text(&obj_file(), "v 1.5 2.5 0", &format!("v 1.5 {value} 0"));
        refuses(MeshFormat::Obj, &text, "line 14: ");
        let text = replace_text(&stl_text(), "vertex 1.5 2.5 0", &format!("vertex 1.5 {value} 0"));
        refuses(MeshFormat::Stl, &text, "line 2: the facet");
        let text = replace_text(&ply_file("ascii"), "1.5 9 2.5 0", &format!("1.5 9 {value} 0"));
        refuses(MeshFormat::Ply, &text, "line 23: face 0");
        let mut binary = glb_file();
        let start = binary.len() - 168;
        binary[start + 4..][..4].copy_from_slice(&value.to_le_bytes());
        refuses(MeshFormat::Gltf, &binary, "node 0: primitive 0");
    }
    let at_the_bound = replace_text(&obj_file(), "v 1.5 2.5 0", "v 1.5 1e12 0");
    assert!(parse_mesh(MeshFormat::Obj, &at_the_bound).is_ok());
    // A vertex that no facet uses may have any coordinates.
    let unused = [obj_file(), b"v nan -inf 1e300\n".to_vec()].concat();
    assert_eq!(triangle_points(&parse_mesh(MeshFormat::Obj, &unused).unwrap()), expected_points());
}

#[test]
fn indices_out_of_range_are_refused() {
    for bad in ["f 1 2 9", "f 0 1 2", "f -9 1 2", "f 99999999999999999999 1 2"] {
        let text = [obj_file(), bad.as_bytes().to_vec()].concat();
        let said = parse_refusal(MeshFormat::Obj, &text, is_malformed);
        assert!(said.contains("line 21"), "{said}");
    }
    let text = replace_text(&ply_file("ascii"), "4 5 4 6 7", "4 5 4 6 8");
    let said = parse_refusal(MeshFormat::Ply, &text, is_malformed);
    assert!(said.contains("face 1: found vertex 8; expected one of 8"), "{said}");
    let text = replace_text(&ply_file("ascii"), "4 5 4 6 7", "4 5 4 6 -1");
    assert!(
        parse_refusal(MeshFormat::Ply, &text, is_malformed).contains("face 1: found vertex -1")
    );
    let mut binary = glb_file();
    let end = binary.len() - 2;
    binary[end..].copy_from_slice(&8u16.to_le_bytes());
    assert!(parse_refusal(MeshFormat::Gltf, &binary, is_malformed).contains("index 8"));
}

#[test]
fn a_count_beyond_the_file_is_refused() {
    let many = "element vertex 99999999999";
    let said = parse_refusal(
        MeshFormat::Ply,
        &replace_text(&ply_file("ascii"), "element vertex 8", many),
        is_malformed,
    );
    assert!(said.contains("99999999999"), "{said}");
    // A binary element without properties takes no bytes.
    let binary = ply_file("binary_little_endian");
    let hollow =
        replace_text(&binary, "element seam 1", "element hollow 99999999999\nelement seam 1");
    parse_refusal(MeshFormat::Ply, &hollow, is_malformed);
    let mut binary = stl_binary();
    binary[80..84].copy_from_slice(&u32::MAX.to_le_bytes());
    assert!(parse_refusal(MeshFormat::Stl, &binary, is_malformed).contains("4294967295"));
    for (from, to) in [
        (r#""count":8"#, r#""count":9"#),
        (r#""count":36"#, r#""count":99999999999999999"#),
        (r#""byteLength":96"#, r#""byteLength":18446744073709551615"#),
        (r#""byteOffset":96"#, r#""byteOffset":97"#),
        (r#""byteLength":168"#, r#""byteLength":169"#),
    ] {
        parse_refusal(MeshFormat::Gltf, &replace_text(&gltf_file(), from, to), is_malformed);
    }
}

#[test]
fn vertices_without_a_triangle_are_dropped() {
    let text = "v 9 9 9\nv 0 0 0\nv 1 0 0\nv -9 9 9\nv 0 1 0\nf 2 3 5\n";
    let mesh = parse_mesh(MeshFormat::Obj, text.as_bytes()).unwrap();
    assert_eq!(mesh.bounding_box(), Some(MeshBounds { min: [0.0; 3], max: [1.0, 1.0, 0.0] }));
    let text = replace_text(&ply_file("ascii"), "vertex 8", "vertex 9");
    let mesh = parse_mesh(MeshFormat::Ply, &replace_text(&text, "-3\n", "7 7 7 7\n-3\n")).unwrap();
    assert_eq!((triangle_points(&mesh), mesh.positions.len()), (expected_points(), 8));
}

#[test]
fn a_binary_stl_may_start_with_solid() {
    let mut bytes = stl_binary();
    bytes[..6].copy_from_slice(b"solid ");
    assert_eq!(triangle_points(&parse_mesh(MeshFormat::Stl, &bytes).unwrap()), expected_points());
}

#[test]
fn gltf_nodes_place_and_mirror() {
    let child = r#"{"children":[1],"translation":[10,0,0]},{"mesh":0,"scale":[-2,1,1]}"#;
    let mesh =
        parse_mesh(MeshFormat::Gltf, &replace_text(&gltf_file(), r#"{"mesh":0}"#, child)).unwrap();
    let moved = |[a, b, c]: [[f32; 3]; 3]| [a, c, b].map(|p| [10.0 - 2.0 * p[0], p[1], p[2]]);
    assert_eq!(
        triangle_points(&mesh),
        expected_points().into_iter().map(moved).collect::<Vec<_>>()
    );
    let ring = r#"{"children":[1]},{"mesh":0,"children":[0]}"#;
    parse_refusal(
        MeshFormat::Gltf,
        &replace_text(&gltf_file(), r#"{"mesh":0}"#, ring),
        is_malformed,
    );
}

#[test]
fn another_gltf_than_2_is_refused() {
    let given = r#""version":"2.0""#;
    for good in [r#""version":"2.1""#, r#""version":"2.0","minVersion":"2.0""#] {
        assert!(parse_mesh(MeshFormat::Gltf, &replace_text(&gltf_file(), given, good)).is_ok());
    }
    for (bad, word) in [
        (r#""version":"1.0""#, r#""1.0"; expected "2.0""#),
        (r#""version":"20""#, r#""20"; expected "2.0""#),
        (r#""version":"""#, r#"""; expected "2.0""#),
        (r#""version":"2.1","minVersion":"2.1""#, r#""2.1"; expected at most "2.0""#),
    ] {
        let said =
            parse_refusal(MeshFormat::Gltf, &replace_text(&gltf_file(), given, bad), is_malformed);
        assert!(said.contains(word), "{said}");
    }
}

#[test]
fn an_obj_may_start_with_a_byte_order_mark() {
    let text = String::from_utf8(obj_file()).unwrap();
    let first = text.lines().position(|line| line.starts_with("v ")).unwrap();
    let vertex_first: String = text.lines().skip(first).map(|line| format!("{line}\n")).collect();
    let mesh = parse_mesh(MeshFormat::Obj, format!("\u{feff}{vertex_first}").as_bytes()).unwrap();
    assert_eq!(triangle_points(&mesh), expected_points());
}

#[test]
fn gltf_strips_and_fans_are_split() {
    // The first indices of the box are 0, 1, 3, 0. The fan's second facet has no area.
    for (mode, split) in [(5, &[[0, 1, 3], [3, 1, 0]][..]), (6, &[[0, 1, 3]])] {
        let text =
            replace_text(&gltf_file(), r#""indices":1"#, &format!(r#""indices":1,"mode":{mode}"#));
        let text = replace_text(&text, r#""count":36"#, r#""count":4"#);
        let mesh = parse_mesh(MeshFormat::Gltf, &text).unwrap();
        let expected: Vec<_> = split.iter().map(|t| t.map(|i| CORNERS[i])).collect();
        assert_eq!(triangle_points(&mesh), expected);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(scaled_cases(6000)) })]

    /// Any bytes give either a mesh that keeps its invariants, or an error with a message.
    #[test]
    fn spoilt_bytes_never_panic(
        sample in 0..8usize,
        spoil in prop::collection::vec((any::<prop::sample::Index>(), 0..4u8, any::<u8>()), 1..6),
    ) {
        let (_, kind, mut bytes) = all_samples().swap_remove(sample);
        for (place, how, byte) in spoil {
            let at = place.index(bytes.len());
            match how {
                0 => bytes[at] = byte,
                1 => bytes[at] ^= 1 << (byte % 8),
                2 => bytes.insert(at, byte),
                _ => drop(bytes.remove(at)),
            }
        }
        match parse_mesh(kind, &bytes) {
            Ok(mesh) => {
                prop_assert!(!mesh.triangles.is_empty());
                let vertices = mesh.positions.len() as u32;
                prop_assert!(mesh.triangles.as_flattened().iter().all(|&i| i < vertices));
                prop_assert!(mesh.positions.as_flattened().iter().all(|c| c.abs() <= 1e12));
            }
            Err(fault) => prop_assert!(!fault.to_string().is_empty()),
        }
    }

    #[test]
    fn bytes_of_any_sort_never_panic(kind in 0..4usize, bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        let kind = [MeshFormat::Obj, MeshFormat::Stl, MeshFormat::Ply, MeshFormat::Gltf][kind];
        let _ = parse_mesh(kind, &bytes);
    }
}
