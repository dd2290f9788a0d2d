//! One box, encoded in every supported mesh format.

use paros_shell::mesh::{Mesh, MeshFormat};
use std::fmt::Write;

/// The corners of the box.
pub const CORNERS: [[f32; 3]; 8] = [
    [0.0, 0.0, 0.0],
    [1.5, 0.0, 0.0],
    [0.0, 2.5, 0.0],
    [1.5, 2.5, 0.0],
    [0.0, 0.0, -3.25],
    [1.5, 0.0, -3.25],
    [0.0, 2.5, -3.25],
    [1.5, 2.5, -3.25],
];

/// The box's sides, as corners counter-clockwise seen from outside.
pub const SIDES: [[u32; 4]; 6] =
    [[0, 1, 3, 2], [5, 4, 6, 7], [4, 0, 2, 6], [1, 5, 7, 3], [2, 3, 7, 6], [4, 5, 1, 0]];

/// Returns the triangle fans that readers make of the sides.
pub fn sample_triangles() -> Vec<[u32; 3]> {
    SIDES.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect()
}

/// Returns the corners of a mesh's triangles.
pub fn triangle_points(mesh: &Mesh) -> Vec<[[f32; 3]; 3]> {
    mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])).collect()
}

/// Returns the corners of the box's triangles, in the order of every file.
pub fn expected_points() -> Vec<[[f32; 3]; 3]> {
    sample_triangles().iter().map(|t| t.map(|i| CORNERS[i as usize])).collect()
}

/// Encodes the box as OBJ, with indices counted from the start and from the end.
pub fn obj_file() -> Vec<u8> {
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

/// Encodes the box as ASCII STL, in two solids.
pub fn stl_text() -> Vec<u8> {
    let mut text = String::new();
    for (name, part) in [("a part", &expected_points()[..5]), ("", &expected_points()[5..])] {
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

/// Encodes the box as binary STL.
pub fn stl_binary() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(12u32.to_le_bytes());
    for corners in expected_points() {
        bytes.extend([0; 12]);
        bytes.extend(corners.as_flattened().iter().flat_map(|c| c.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

/// Encodes the box as PLY of a format: `ascii`, `binary_little_endian` or `binary_big_endian`.
pub fn ply_file(format: &str) -> Vec<u8> {
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

/// Returns the glTF buffer: positions, then indices of two bytes.
pub fn gltf_buffer() -> Vec<u8> {
    let positions = CORNERS.iter().flatten().flat_map(|c| c.to_le_bytes());
    let indices = sample_triangles().into_iter().flatten().flat_map(|i| (i as u16).to_le_bytes());
    positions.chain(indices).collect()
}

/// Returns a glTF JSON with its nodes. `uri` is the buffer's URI property, followed by a comma.
pub fn gltf_json(uri: &str, nodes: &str) -> String {
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

/// Encodes the box as glTF with an embedded buffer.
pub fn gltf_file() -> Vec<u8> {
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

/// Encodes the box as binary glTF.
pub fn glb_file() -> Vec<u8> {
    let json = gltf_json("", r#"{"mesh":0}"#).into_bytes();
    glb_of(json, &gltf_buffer())
}

/// Encodes a JSON and its buffer as binary glTF.
pub fn glb_of(mut json: Vec<u8>, buffer: &[u8]) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
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

/// Returns a file of every format: name, format and bytes.
pub fn all_samples() -> Vec<(&'static str, MeshFormat, Vec<u8>)> {
    vec![
        ("obj", MeshFormat::Obj, obj_file()),
        ("stl text", MeshFormat::Stl, stl_text()),
        ("stl binary", MeshFormat::Stl, stl_binary()),
        ("ply text", MeshFormat::Ply, ply_file("ascii")),
        ("ply little", MeshFormat::Ply, ply_file("binary_little_endian")),
        ("ply big", MeshFormat::Ply, ply_file("binary_big_endian")),
        ("gltf", MeshFormat::Gltf, gltf_file()),
        ("glb", MeshFormat::Gltf, glb_file()),
    ]
}
