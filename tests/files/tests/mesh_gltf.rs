//! The box in every variant of glTF: component types, sparse data, instances, skins, extensions.

use paros_shell::mesh::{Mesh, MeshFault, MeshFormat};
use paros_tests_files::mesh_samples::*;
use std::path::Path;

/// A glTF file under construction: accessors over one buffer.
#[derive(Default)]
struct GltfFile {
    buffer: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
}

const BYTE: u32 = 5120;
const UBYTE: u32 = 5121;
const SHORT: u32 = 5122;
const USHORT: u32 = 5123;
const FLOAT: u32 = 5126;

impl GltfFile {
    fn add_view(&mut self, bytes: &[u8]) -> usize {
        self.buffer.resize(self.buffer.len().next_multiple_of(4), 0);
        let (at, length) = (self.buffer.len(), bytes.len());
        self.buffer.extend(bytes);
        self.views.push(format!(r#"{{"buffer":0,"byteOffset":{at},"byteLength":{length}}}"#));
        self.views.len() - 1
    }

    /// Adds an accessor; `more` is JSON with a comma before it.
    fn add(&mut self, component: u32, kind: &str, count: usize, bytes: &[u8], more: &str) -> usize {
        let view = self.add_view(bytes);
        self.add_accessor(&format!(
            r#""bufferView":{view},"componentType":{component},"type":"{kind}","count":{count}{more}"#
        ))
    }

    fn add_accessor(&mut self, json: &str) -> usize {
        self.accessors.push(format!("{{{json}}}"));
        self.accessors.len() - 1
    }

    fn add_floats<const M: usize>(&mut self, kind: &str, elements: &[[f32; M]]) -> usize {
        let bytes: Vec<u8> = elements.as_flattened().iter().flat_map(|c| c.to_le_bytes()).collect();
        self.add(FLOAT, kind, elements.len(), &bytes, "")
    }

    /// Adds the box's corners and indices.
    fn with_box() -> Self {
        let mut file = GltfFile::default();
        file.add_floats("VEC3", &CORNERS);
        file.add_indices();
        file
    }

    fn add_indices(&mut self) -> usize {
        let indices: Vec<u8> = sample_triangles().as_flattened().iter().map(|i| *i as u8).collect();
        self.add(UBYTE, "SCALAR", 36, &indices, "")
    }

    /// Encodes the file with its nodes and primitives; `more` is JSON with a comma before it.
    fn encode(&self, nodes: &str, primitives: &str, more: &str) -> Vec<u8> {
        glb_of(self.json(nodes, primitives, more).into_bytes(), &self.buffer)
    }

    fn json(&self, nodes: &str, primitives: &str, more: &str) -> String {
        let (views, accessors) = (self.views.join(","), self.accessors.join(","));
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}],
            "meshes":[{{"primitives":[{primitives}]}}],"accessors":[{accessors}],
            "bufferViews":[{views}],"buffers":[{{"byteLength":{}}}]{more}}}"#,
            self.buffer.len()
        )
    }
}

const NODE: &str = r#"{"mesh":0}"#;
const PRIMITIVE: &str = r#"{"attributes":{"POSITION":0},"indices":1}"#;

fn parse(bytes: &[u8]) -> Result<Mesh, MeshFault> {
    Mesh::from_bytes(MeshFormat::Gltf, bytes, Path::new("nowhere"))
}

fn read(bytes: &[u8]) -> Mesh {
    parse(bytes).unwrap_or_else(|fault| panic!("{fault}"))
}

fn assert_is_box(bytes: &[u8]) {
    assert_eq!(triangle_points(&read(bytes)), expected_points());
}

/// Returns the box's triangles, with each corner mapped by a function.
fn moved(by: impl Fn([f32; 3]) -> [f32; 3]) -> Vec<[[f32; 3]; 3]> {
    expected_points().into_iter().map(|t| t.map(&by)).collect()
}

#[test]
fn whatever_is_not_used_may_be_missing_or_wrong() {
    let file = GltfFile::with_box();
    for more in [
        r#","extensionsRequired":["KHR_texture_transform","EXT_texture_webp","KHR_materials_x","ABC_y"]"#,
        r#","textures":[{"source":9}],"images":[{"uri":"gone.png"}],"materials":[{"normalTexture":{}}]"#,
        r#","animations":[{"channels":[{"sampler":7}],"samplers":[]}],"cameras":[{"type":"odd"}]"#,
        r#","extras":{"min":[NaN,-nan(ind),Infinity,-inf]}"#,
    ] {
        assert_is_box(&file.encode(NODE, PRIMITIVE, more));
    }
    let primitive = r#"{"attributes":{"POSITION":0,"NORMAL":77,"TEXCOORD_0":5,"_ID":"x"},"indices":1,"material":3}"#;
    assert_is_box(&file.encode(r#"{"mesh":0,"camera":4,"name":7}"#, primitive, ""));
    // Lines, and a primitive without positions.
    let others =
        format!(r#"{PRIMITIVE},{{"attributes":{{"POSITION":0}},"mode":1}},{{"attributes":{{}}}}"#);
    assert_is_box(&file.encode(NODE, &others, ""));
    // A buffer that only an image needs.
    let text = String::from_utf8(gltf_file()).unwrap();
    let more = text.replace(
        "\"byteLength\":168}",
        "\"byteLength\":168},{\"uri\":\"gone.bin\",\"byteLength\":9}",
    );
    assert_is_box(more.as_bytes());
    assert_is_box(format!("\u{feff}{text}\0\0").as_bytes());
    assert_is_box(text.replace("data:application/octet-stream;base64", "data:;BASE64").as_bytes());
}

#[test]
fn quantized_positions_are_fractions_where_they_are_normalised() {
    let numbers = |scale: f32| CORNERS.map(|p| p.map(|c| (c * scale) as i32));
    let scaled = r#"{"mesh":0,"scale":[0.25,0.25,0.25]}"#;
    for (component, size) in [(BYTE, 1), (SHORT, 2)] {
        let mut bytes = Vec::new();
        for p in numbers(4.0) {
            p.iter().for_each(|c| bytes.extend(&c.to_le_bytes()[..size]));
            bytes.resize(bytes.len().next_multiple_of(4), 0);
        }
        let stride = if size == 1 { 4 } else { 8 };
        let mut file = GltfFile::default();
        file.add(component, "VEC3", 8, &bytes, "");
        file.views[0] = file.views[0].replace('}', &format!(r#","byteStride":{stride}}}"#));
        file.add_indices();
        let more = r#","extensionsRequired":["KHR_mesh_quantization"]"#;
        assert_is_box(&file.encode(scaled, PRIMITIVE, more));
    }
    // For unsigned types, 0 and the maximum decode to 0 and 1.
    for (component, greatest) in [(UBYTE, &[0xff][..]), (USHORT, &[0xff, 0xff])] {
        let bit = |on: bool| if on { greatest.to_vec() } else { vec![0; greatest.len()] };
        let mut bytes = Vec::new();
        for [x, y, z] in CORNERS {
            [x > 0.0, y > 0.0, z == 0.0].map(bit).into_iter().for_each(|b| bytes.extend(b));
        }
        let mut file = GltfFile::default();
        file.add(component, "VEC3", 8, &bytes, r#","normalized":true"#);
        file.add_indices();
        let node = r#"{"mesh":0,"translation":[0,0,-3.25],"scale":[1.5,2.5,3.25]}"#;
        assert_is_box(&file.encode(node, PRIMITIVE, ""));
    }
}

#[test]
fn sparse_elements_replace_those_of_a_view_or_zeros() {
    let replaced: Vec<usize> = vec![1, 4, 7];
    let indices: Vec<u8> = replaced.iter().flat_map(|&i| (i as u16).to_le_bytes()).collect();
    let values: Vec<u8> =
        replaced.iter().flat_map(|&i| CORNERS[i]).flat_map(f32::to_le_bytes).collect();
    let mut others = CORNERS;
    replaced.iter().for_each(|&i| others[i] = [f32::NAN; 3]);
    let mut file = GltfFile::default();
    let others: Vec<u8> = others.as_flattened().iter().flat_map(|c| c.to_le_bytes()).collect();
    let [base, indices, values] = [&others, &indices, &values].map(|bytes| file.add_view(bytes));
    let sparse = format!(
        r#""sparse":{{"count":3,"indices":{{"bufferView":{indices},"componentType":{USHORT}}},
        "values":{{"bufferView":{values}}}}}"#
    );
    let plain = format!(r#""componentType":{FLOAT},"type":"VEC3","count":8"#);
    file.add_accessor(&format!(r#""bufferView":{base},{plain},{sparse}"#));
    file.add_indices();
    assert_is_box(&file.encode(NODE, PRIMITIVE, ""));
    // Without a buffer view, all other corners are at the origin.
    file.accessors[0] = format!("{{{plain},{sparse}}}");
    let mesh = read(&file.encode(NODE, PRIMITIVE, ""));
    assert_eq!(mesh.positions.len(), 4);
}

#[test]
fn instances_have_any_part_of_a_transform() {
    let node = |attributes: &str| {
        format!(
            r#"{{"mesh":0,"translation":[0,0,5],"extensions":{{"EXT_mesh_gpu_instancing":{{"attributes":{{{attributes}}}}}}}}}"#
        )
    };
    let mut file = GltfFile::with_box();
    let places = file.add_floats("VEC3", &[[0.0; 3], [10.0, 0.0, 0.0]]);
    let scales = file.add_floats("VEC3", &[[1.0; 3], [2.0; 3]]);
    // A half turn about y, as floats and as normalised integers.
    let turns = file.add_floats("VEC4", &[[0.0, 0.0, 0.0, 1.0], [0.0, 1.0, 0.0, 0.0]]);
    let bytes = file.add(BYTE, "VEC4", 2, &[0, 0, 0, 127, 0, 127, 0, 0], r#","normalized":true"#);
    let shorts = [0i16, 0, 0, i16::MAX, 0, i16::MAX, 0, 0].map(i16::to_le_bytes);
    let shorts = file.add(SHORT, "VEC4", 2, shorts.as_flattened(), r#","normalized":true"#);
    let check = |attributes: &str, place: [f32; 3], turn: f32, scale: f32| {
        let mesh = read(&file.encode(&node(attributes), PRIMITIVE, ""));
        let points = triangle_points(&mesh);
        let (first, second) = points.split_at(12);
        let at = |[x, y, z]: [f32; 3]| [x, y, z + 5.0];
        assert_eq!(first, moved(at), "{attributes}");
        let placed = |[x, y, z]: [f32; 3]| {
            let [x, y, z] = [turn * x, y, turn * z].map(|c| c * scale);
            at([x + place[0], y + place[1], z + place[2]])
        };
        assert_eq!(second, moved(placed), "{attributes}");
    };
    check(&format!(r#""TRANSLATION":{places}"#), [10.0, 0.0, 0.0], 1.0, 1.0);
    check(&format!(r#""SCALE":{scales}"#), [0.0; 3], 1.0, 2.0);
    for turns in [turns, bytes, shorts] {
        check(&format!(r#""ROTATION":{turns}"#), [0.0; 3], -1.0, 1.0);
        let all = format!(r#""TRANSLATION":{places},"ROTATION":{turns},"SCALE":{scales}"#);
        check(&all, [10.0, 0.0, 0.0], -1.0, 2.0);
    }
    // Without any instance attribute the count is one.
    assert_eq!(read(&file.encode(&node(r#""_ID":0"#), PRIMITIVE, "")).triangles.len(), 12);
}

/// The joint moves by (1, 2, 3), its inverse bind matrix by (-1, 0, 0); the mesh's own node is ignored.
#[test]
fn a_skin_places_its_mesh_and_the_node_does_not() {
    let mut file = GltfFile::with_box();
    let joints = file.add(UBYTE, "VEC4", 8, &[[1, 0, 0, 0]; 8].concat(), "");
    let weights = file.add_floats("VEC4", &[[0.5, 0.0, 0.0, 0.0]; 8]);
    let bytes = file.add(UBYTE, "VEC4", 8, &[[255, 0, 0, 0]; 8].concat(), r#","normalized":true"#);
    let none = file.add_floats("VEC4", &[[0.0; 4]; 8]);
    let mut inverse = [0.0; 16];
    for i in [0, 5, 10, 15] {
        inverse[i] = 1.0;
    }
    let identity = inverse;
    inverse[12] = -1.0;
    let inverses = file.add_floats("MAT4", &[identity, inverse]);
    let nodes = r#"{"children":[1,2],"translation":[0,0,3]},{"mesh":0,"skin":0,"scale":[9,9,9]},
        {"translation":[1,2,0]}"#;
    let primitive = |weights: usize| {
        format!(
            r#"{{"attributes":{{"POSITION":0,"JOINTS_0":{joints},"WEIGHTS_0":{weights}}},"indices":1}}"#
        )
    };
    let skin = |inverses: &str| format!(r#","skins":[{{"joints":[1,2]{inverses}}}]"#);
    let with = skin(&format!(r#","inverseBindMatrices":{inverses}"#));
    for weights in [weights, bytes] {
        let mesh = read(&file.encode(nodes, &primitive(weights), &with));
        assert_eq!(triangle_points(&mesh), moved(|[x, y, z]| [x, y + 2.0, z + 3.0]));
        let mesh = read(&file.encode(nodes, &primitive(weights), &skin("")));
        assert_eq!(triangle_points(&mesh), moved(|[x, y, z]| [x + 1.0, y + 2.0, z + 3.0]));
    }
    // Without weights the first joint has full weight.
    assert!(parse(&file.encode(nodes, &primitive(none), &with)).is_ok());
    // A mesh without joints is placed by its node.
    let mesh = read(&file.encode(nodes, PRIMITIVE, &with));
    assert_eq!(triangle_points(&mesh), moved(|p| [9.0 * p[0], 9.0 * p[1], 9.0 * p[2] + 3.0]));
}

#[test]
fn morph_targets_count_by_their_weights() {
    let mut file = GltfFile::with_box();
    let target = file.add_floats("VEC3", &[[0.0, 0.0, 4.0]; 8]);
    let primitive = format!(
        r#"{{"attributes":{{"POSITION":0}},"indices":1,"targets":[{{"POSITION":{target}}}]}}"#
    );
    let raised = |by: f32| moved(move |[x, y, z]| [x, y, z + by]);
    let of_node = file.encode(r#"{"mesh":0,"weights":[0.5]}"#, &primitive, "");
    assert_eq!(triangle_points(&read(&of_node)), raised(2.0));
    assert_is_box(&file.encode(NODE, &primitive, ""));
}

#[test]
fn corners_without_indices_and_strips_and_fans_are_split() {
    let corners = |order: &[u32]| order.iter().map(|&i| CORNERS[i as usize]).collect::<Vec<_>>();
    type Case = (u32, &'static [u32], &'static [[u32; 3]]);
    let cases: [Case; 4] = [
        (4, &[0, 1, 3, 0, 3, 2, 5], &[[0, 1, 3], [0, 3, 2]]),
        (5, &[0, 1, 2, 3], &[[0, 1, 2], [2, 1, 3]]),
        (6, &[0, 1, 3, 2], &[[0, 1, 3], [0, 3, 2]]),
        (5, &[0, 1], &[]),
    ];
    for (mode, order, expected) in cases {
        let mut file = GltfFile::default();
        file.add_floats("VEC3", &corners(order));
        let primitive = format!(r#"{{"attributes":{{"POSITION":0}},"mode":{mode}}}"#);
        let expected: Vec<_> = expected.iter().map(|t| t.map(|i| CORNERS[i as usize])).collect();
        match parse(&file.encode(NODE, &primitive, "")) {
            Ok(mesh) => assert_eq!(triangle_points(&mesh), expected, "mode {mode}"),
            Err(fault) => assert!(matches!(fault, MeshFault::Empty) && expected.is_empty()),
        }
    }
}

#[test]
fn nodes_without_a_scene_are_placed_and_hidden_ones_left_out() {
    let file = GltfFile::with_box();
    let without_scene = |nodes: &str| {
        let json = file.json(nodes, PRIMITIVE, "");
        let json = json.replace(r#""scene":0,"scenes":[{"nodes":[0]}],"#, "");
        glb_of(json.into_bytes(), &file.buffer)
    };
    let bytes = without_scene(r#"{"mesh":0,"translation":[0,0,1]}"#);
    assert_eq!(triangle_points(&read(&bytes)), moved(|[x, y, z]| [x, y, z + 1.0]));
    let nodes = r#"{"mesh":0,"children":[1]},{"mesh":0,"translation":[0,0,9],
        "extensions":{"KHR_node_visibility":{"visible":false}}}"#;
    assert_is_box(&file.encode(nodes, PRIMITIVE, ""));
}

#[test]
fn compressed_meshes_are_refused_by_name_unless_they_hold_plain_data() {
    let mut file = GltfFile::with_box();
    let draco = r#","extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}}"#;
    let primitive = PRIMITIVE.replace(":1}", &format!(":1{draco}"));
    assert_is_box(&file.encode(NODE, &primitive, ""));
    file.accessors[0] = r#"{"componentType":5126,"type":"VEC3","count":8}"#.into();
    let fault = parse(&file.encode(NODE, &primitive, "")).unwrap_err().to_string();
    let expected = "node 0: primitive 0: mesh compression KHR_draco_mesh_compression is not supported; \
                    expected plain data. Export the file without compression";
    assert_eq!(fault, expected);
    for name in ["EXT_meshopt_compression", "KHR_meshopt_compression"] {
        let mut file = GltfFile::with_box();
        file.views[0] = format!(
            r#"{{"buffer":1,"byteLength":96,"extensions":{{"{name}":{{"buffer":0,"byteLength":9}}}}}}"#
        );
        let fallback =
            format!(r#"}},{{"byteLength":96,"extensions":{{"{name}":{{"fallback":true}}}}}}]}}"#);
        let json = file.json(NODE, PRIMITIVE, "").replace("}]}", &fallback);
        let json = json.replacen(&fallback, "}]}", json.matches(&fallback).count() - 1);
        let fault = parse(&glb_of(json.into_bytes(), &file.buffer)).unwrap_err().to_string();
        assert!(fault.contains(&format!("mesh compression {name} is not supported")), "{fault}");
    }
}

#[test]
fn faults_of_a_container_name_the_byte_or_the_line() {
    let good = glb_file();
    let with = |at: usize, byte: u8| {
        let mut bytes = good.clone();
        bytes[at] = byte;
        bytes
    };
    for (bytes, expected) in [
        (with(4, 1), "byte 4: found version 1; expected 2. Export it as glTF 2.0"),
        (with(14, 9), "byte 12: found a chunk of"),
        (with(16, b'X'), "no chunk `JSON`; expected one at byte 12"),
        (b"{\"asset\":".to_vec(), "line 1, column 9: the JSON ends early"),
        (b"{\n \"asset\" 5}".to_vec(), "line 2, column 10: found no valid JSON"),
    ] {
        let fault = parse(&bytes).unwrap_err().to_string();
        assert!(fault.contains(expected), "{fault}");
    }
    // The stated length is ignored if the chunks are complete.
    assert_is_box(&with(8, 0));
    assert_is_box(&[&good[..], b"\0\0\0"].concat());
}
