//! What a mesh file may become is bounded, and what a library would panic at is refused before it is asked.
//!
//! Planted faults (tried by hand), each caught by the test of its format: a corner's indices unchecked, which
//! panics in tobj; vertices or triangles uncounted, of OBJ, PLY, one polygon or glTF. STL counts twice.

use std::fs::{self, File};
use std::path::Path;

use paros_shell::mesh::{
    self, MAX_FILE_BYTES, MAX_TRIANGLES, MAX_VERTICES, Mesh, MeshFault, MeshFormat,
};
use paros_tests_files::mesh_samples::*;

fn refusal(kind: MeshFormat, bytes: &[u8]) -> MeshFault {
    Mesh::from_bytes(kind, bytes, Path::new("nowhere")).expect_err("a bad mesh was taken")
}

/// The file becomes `count` vertices or triangles, too many.
fn assert_too_large(kind: MeshFormat, bytes: &[u8], expected: (&str, usize)) {
    let fault = refusal(kind, bytes);
    let MeshFault::TooLarge { what, count, most } = fault else { panic!("{kind}: {fault}") };
    assert_eq!((what, count), expected, "{kind}");
    assert_eq!(most, if what == "triangles" { MAX_TRIANGLES } else { MAX_VERTICES });
    let said = fault.to_string();
    assert!(said.contains(&format!("{count} {what}")) && said.contains(&most.to_string()));
}

#[test]
fn an_index_of_any_kind_out_of_range_is_refused() {
    // The box has 8 vertices, a texture coordinate and 20 lines; a normal stands in line 21.
    let with = |line: &str| [obj_file(), format!("vn 0 0 1\n{line}\n").into_bytes()].concat();
    for (line, found) in [
        ("f 1/-2 2/1 3/1", "`1/-2` names texture coordinate -2; expected one of the 1 `vt` lines"),
        ("f 1 2/2 3", "`2/2` names texture coordinate 2"),
        ("f 1//-3 2 3", "`1//-3` names normal -3"),
        ("f 1/1/-2 2 3", "`1/1/-2` names normal -2"),
        ("f 1/4611686018427387905 2 3", "texture coordinate 4611686018427387905"),
        ("f 1//-9223372036854775808 2 3", "normal -9223372036854775808"),
        ("f 1 2 -9", "vertex -9"),
        ("f 0 1 2", "vertex 0; expected one of the 8 `v` lines, counted from 1"),
        ("l 1/-2 2", "texture coordinate -2"),
    ] {
        let said = refusal(MeshFormat::Obj, &with(line)).to_string();
        assert!(said.contains("line 22: ") && said.contains(found), "{line}: {said}");
    }
    // What the file gives none of is never looked at.
    let plain = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/7/9 2/7/-9 3/0/0\n";
    assert!(Mesh::from_bytes(MeshFormat::Obj, plain.as_bytes(), Path::new("")).is_ok());
    let below = format!("{plain}o next\nvt 0 0\nvn 0 0 1\n");
    let said = refusal(MeshFormat::Obj, below.as_bytes()).to_string();
    assert!(said.contains("line 4: `1/7/9` names texture coordinate 7"), "{said}");
    assert!(
        Mesh::from_bytes(MeshFormat::Obj, &with("f 1/-1/1 2/1/-1 -6/0/0"), Path::new("")).is_ok()
    );
}

#[test]
fn an_obj_has_at_most_so_many() {
    let vertices = "v\n".repeat(MAX_VERTICES + 1);
    assert_too_large(MeshFormat::Obj, vertices.as_bytes(), ("vertices", MAX_VERTICES + 1));
    let polygon = format!("v 0 0 0\nf{}\n", " 1".repeat(MAX_TRIANGLES + 3));
    assert_too_large(MeshFormat::Obj, polygon.as_bytes(), ("triangles", MAX_TRIANGLES + 1));
    // Two groups that share a vertex have one each.
    let group = |name: &str| format!("g {name}\n{}", "f 1 2 3\n".repeat(3));
    let text = format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{}{}", group("a"), group("b"));
    let mesh = Mesh::from_bytes(MeshFormat::Obj, text.as_bytes(), Path::new("")).unwrap();
    assert_eq!((mesh.positions.len(), mesh.triangles.len()), (6, 6));
}

/// Ninety-nine vertices of which each group has its own: a file of 12 MB becomes more than may be.
#[test]
fn an_obj_has_at_most_so_many_whatever_its_groups_share() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".repeat(33);
    let corners: String = (1..=99).map(|i| format!(" {i}")).collect();
    let enough = MAX_VERTICES / 99 + 1;
    let text = vertices + &format!("g a\nf{corners}\ng b\nf{corners}\n").repeat(enough / 2 + 1);
    assert_too_large(MeshFormat::Obj, text.as_bytes(), ("vertices", enough * 99));
}

#[test]
fn an_stl_has_at_most_so_many() {
    let count = MAX_TRIANGLES + 1;
    // Nothing of it is touched but the header.
    let mut bytes = vec![0; 84 + 50 * count];
    bytes[80..84].copy_from_slice(&(count as u32).to_le_bytes());
    assert_too_large(MeshFormat::Stl, &bytes, ("triangles", count));
}

#[test]
fn a_ply_has_at_most_so_many() {
    let header = |vertices: usize, faces: usize| {
        format!(
            "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty uchar x\n\
             element face {faces}\nproperty list uint uchar vertex_indices\nend_header\n"
        )
    };
    let with = |header: String, length: usize| {
        let mut bytes = header.into_bytes();
        bytes.resize(bytes.len() + length, 0);
        bytes
    };
    let many = with(header(MAX_VERTICES + 1, 0), MAX_VERTICES + 1);
    assert_too_large(MeshFormat::Ply, &many, ("vertices", MAX_VERTICES + 1));
    let many = with(header(0, MAX_TRIANGLES + 1), MAX_TRIANGLES + 1);
    assert_too_large(MeshFormat::Ply, &many, ("triangles", MAX_TRIANGLES + 1));
    // One polygon.
    let corners = MAX_TRIANGLES + 3;
    let mut bytes = header(0, 1).into_bytes();
    bytes.extend((corners as u32).to_le_bytes());
    bytes.resize(bytes.len() + corners, 0);
    assert_too_large(MeshFormat::Ply, &bytes, ("triangles", MAX_TRIANGLES + 1));
}

/// Binary glTF of primitives that share a list of positions, all the same, and one of corners, all the first.
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
    let (points, triangles) = (1 << 14, 1 << 15);
    let enough = MAX_VERTICES / points + 1;
    let bytes = glb_of_shared_accessors(points, 3, enough + 40);
    assert!(bytes.len() < 400_000, "{} bytes", bytes.len());
    assert_too_large(MeshFormat::Gltf, &bytes, ("vertices", enough * points));
    let enough = MAX_TRIANGLES / triangles + 1;
    let bytes = glb_of_shared_accessors(3, 3 * triangles, enough);
    assert_too_large(MeshFormat::Gltf, &bytes, ("triangles", enough * triangles));
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
    // A buffer beside the file, and the file whole.
    fs::rename(folder.join("long.stl"), folder.join("long.bin")).unwrap();
    let json = gltf_json(r#""uri":"long.bin","#, r#"{"mesh":0}"#);
    fs::write(folder.join("a.gltf"), json).unwrap();
    let said = said("a.gltf");
    assert!(said.contains("buffer 0") && said.contains("long.bin"), "{said}");
    fs::remove_dir_all(&folder).unwrap();
}
