//! The number of triangles of a mesh file is limited before memory is allocated for them.

use std::fs::{self, File};
use std::path::Path;

use paros_shell::mesh::{self, MAX_FILE_BYTES, MAX_TRIANGLES, Mesh, MeshFault, MeshFormat};
use paros_tests_files::mesh_samples::*;

fn refusal(kind: MeshFormat, bytes: &[u8]) -> MeshFault {
    Mesh::from_bytes(kind, bytes, Path::new("nowhere")).expect_err("a bad mesh was taken")
}

/// Asserts that a file is rejected because it would have `expected` triangles.
fn assert_too_large(kind: MeshFormat, bytes: &[u8], expected: usize) {
    let fault = refusal(kind, bytes);
    let MeshFault::TooManyTriangles { count } = fault else { panic!("{kind}: {fault}") };
    assert_eq!(count, expected, "{kind}");
    let said = fault.to_string();
    assert!(said.contains(&format!("{count} triangles")), "{said}");
    assert!(said.contains(&MAX_TRIANGLES.to_string()), "{said}");
}

#[test]
fn an_index_of_a_vertex_out_of_range_is_refused() {
    // The box has 8 vertices and 20 lines.
    let with = |line: &str| [obj_file(), format!("{line}\n").into_bytes()].concat();
    for (line, found) in [
        ("f 1 2 -9", "`-9` names vertex -9; expected one of the 8 `v` lines, counted from 1"),
        ("f 9/1/1 1 2", "`9/1/1` names vertex 9"),
        ("f 0 1 2", "vertex 0; expected one of the 8 `v` lines, counted from 1"),
        ("f 4611686018427387905 2 3", "vertex 4611686018427387905"),
        ("f -9223372036854775808 2 3", "vertex -9223372036854775808"),
        ("f 1 x 3", "found the corner `x`; expected `v`"),
    ] {
        let said = refusal(MeshFormat::Obj, &with(line)).to_string();
        assert!(said.contains("line 21: ") && said.contains(found), "{line}: {said}");
    }
    // Texture coordinates and normals are ignored.
    for line in ["f 1/-2/99 2/1/nan 3", "f 1// 2/ 3//x", "l 1/-2 99", "vn 1.#IND - x", "vt"] {
        assert!(Mesh::from_bytes(MeshFormat::Obj, &with(line), Path::new("")).is_ok(), "{line}");
    }
}

#[test]
fn an_obj_has_at_most_so_many() {
    let polygon = format!("v 0 0 0\nf{}\n", " 1".repeat(MAX_TRIANGLES + 3));
    assert_too_large(MeshFormat::Obj, polygon.as_bytes(), MAX_TRIANGLES + 1);
}

#[test]
fn an_stl_has_at_most_so_many() {
    let count = MAX_TRIANGLES + 1;
    // Only the header is written, so the rest of the allocation stays untouched.
    let mut bytes = vec![0; 84 + 50 * count];
    bytes[80..84].copy_from_slice(&(count as u32).to_le_bytes());
    assert_too_large(MeshFormat::Stl, &bytes, count);
}

#[test]
fn a_ply_has_at_most_so_many() {
    let header = |vertices: usize, faces: usize| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty uchar x\nproperty uchar y\n\
             property uchar z\n\
             element face {faces}\nproperty list uint uchar vertex_indices\nend_header\n"
        )
    };
    let with = |header: String, length: usize| {
        let mut bytes = header.into_bytes();
        bytes.resize(bytes.len() + length, 0);
        bytes
    };
    let many = with(header(0, MAX_TRIANGLES + 1), 4 * (MAX_TRIANGLES + 1));
    assert_too_large(MeshFormat::Ply, &many, MAX_TRIANGLES + 1);
    // One polygon.
    let corners = MAX_TRIANGLES + 3;
    let mut bytes = header(0, 1).into_bytes();
    bytes.extend((corners as u32).to_le_bytes());
    bytes.resize(bytes.len() + corners, 0);
    assert_too_large(MeshFormat::Ply, &bytes, MAX_TRIANGLES + 1);
}

/// Returns a binary glTF whose primitives share a list of equal positions, and a list of indices that are all
/// 0.
fn glb_of_shared_accessors(points: usize, corners: usize, primitives: usize) -> Vec<u8> {
    let (start, length) = (12 * points, 12 * points + corners);
    let primitive = r#"{"attributes":{"POSITION":0},"indices":1}"#;
    let primitives = vec![primitive; primitives].join(",");
    let json = format!(
        r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{{"mesh":0}}],
        "meshes":[{{"primitives":[{primitives}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{points},"type":"VEC3",
        "min":[0,0,0],"max":[0,0,0]}},
        {{"bufferView":1,"componentType":5121,"count":{corners},"type":"SCALAR"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{start}}},
        {{"buffer":0,"byteOffset":{start},"byteLength":{corners}}}],
        "buffers":[{{"byteLength":{length}}}]}}"#
    );
    glb_of(json.into_bytes(), &vec![0; length])
}

#[test]
fn a_gltf_has_at_most_so_many_whatever_its_primitives_share() {
    let triangles = 1 << 15;
    let enough = MAX_TRIANGLES / triangles + 1;
    let bytes = glb_of_shared_accessors(3, 3 * triangles, enough);
    assert_too_large(MeshFormat::Gltf, &bytes, enough * triangles);
}

#[test]
fn a_file_has_at_most_so_many_bytes() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("mesh-limits");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let said = |name: &str| mesh::read(&folder.join(name)).expect_err("too long").to_string();
    for name in ["long.obj", "long.stl", "long.ply", "long.gltf"] {
        File::create(folder.join(name)).unwrap().set_len(MAX_FILE_BYTES + 1).unwrap();
        let said = said(name);
        assert!(said.contains(name) && said.contains("expected at most 2147483648"), "{said}");
    }
    // A separate buffer file that is too long.
    fs::rename(folder.join("long.stl"), folder.join("long.bin")).unwrap();
    let json = gltf_json(r#""uri":"long.bin","#, r#"{"mesh":0}"#);
    fs::write(folder.join("a.gltf"), json).unwrap();
    let said = said("a.gltf");
    assert!(said.contains("buffer 0") && said.contains("long.bin"), "{said}");
    fs::remove_dir_all(&folder).unwrap();
}
