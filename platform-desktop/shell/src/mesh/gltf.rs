//! glTF through `gltf`: the default scene's triangles, each under the transform of its node.
//!
//! The crate parses and validates the JSON; buffers are read here, so that no image library comes
//! along and no offset is trusted.

use super::{MAX_FILE_BYTES, Mesh, ParseStop, malformed};
use crate::durable;
use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use gltf::{Accessor, Document, Gltf, Node, Primitive};
use std::borrow::Cow;
use std::path::Path;

/// Column-major, as in the format.
type NodeMatrix = [[f64; 4]; 4];

const IDENTITY: NodeMatrix =
    [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]];

pub(super) fn parse(bytes: &[u8], folder: &Path) -> Result<Mesh, ParseStop> {
    check_glb_length_fits(bytes)?;
    let Gltf { document, blob } =
        Gltf::from_slice_without_validation(bytes).map_err(|error| error.to_string())?;
    let json = document.into_json();
    check_version(&json.asset)?;
    check_attribute_accessors(&json)?;
    let gltf = Document::from_json(json).map_err(|error| error.to_string())?;
    let buffers = read_buffers(&gltf, blob.as_deref(), folder)?;
    let mut scene =
        SceneTriangles { buffers, mesh: Mesh::default(), seen: vec![false; gltf.nodes().len()] };
    match gltf.default_scene().or_else(|| gltf.scenes().next()) {
        Some(root) => scene.add_subtrees(
            root.nodes().map(|node| PlacedNode { node, world_from_parent: IDENTITY }).collect(),
        )?,
        None => {
            for mesh in gltf.meshes() {
                for primitive in mesh.primitives() {
                    scene.add_primitive(&primitive, &IDENTITY)?;
                }
            }
        }
    }
    Ok(scene.mesh)
}

/// The binary form states its length, which must be there before anything is cut by it.
fn check_glb_length_fits(bytes: &[u8]) -> Result<(), String> {
    if !bytes.starts_with(b"glTF") {
        return Ok(());
    }
    let stated = bytes.get(8..12).map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]));
    if stated < 20 || stated as usize > bytes.len() {
        return Err(format!(
            "its header states {stated} bytes; expected at least 20 and at most the {} there are",
            bytes.len()
        ));
    }
    Ok(())
}

/// Minor versions add only what a reader may leave out, unless a file asks for a least one.
fn check_version(asset: &gltf::json::Asset) -> Result<(), String> {
    let version = &asset.version;
    if version.split('.').next() != Some("2") {
        return Err(format!("`asset.version` is {version:?}; expected \"2.0\""));
    }
    match asset.min_version.as_deref() {
        None | Some("2.0") => Ok(()),
        Some(least) => Err(format!("`asset.minVersion` is {least:?}; expected at most \"2.0\"")),
    }
}

/// The crate's validation looks into the accessors of positions before it has checked their index.
fn check_attribute_accessors(json: &gltf::json::Root) -> Result<(), String> {
    let primitives = json.meshes.iter().flat_map(|mesh| &mesh.primitives);
    for index in primitives.flat_map(|primitive| primitive.attributes.values()) {
        if index.value() >= json.accessors.len() {
            let count = json.accessors.len();
            return Err(format!("an attribute names accessor {index}; expected less than {count}"));
        }
    }
    Ok(())
}

fn read_buffers<'a>(
    document: &Document,
    blob: Option<&'a [u8]>,
    folder: &Path,
) -> Result<Vec<Cow<'a, [u8]>>, String> {
    let mut buffers = Vec::new();
    // A file may be named by many buffers.
    let mut left = MAX_FILE_BYTES;
    for buffer in document.buffers() {
        let bytes = match buffer.source() {
            gltf::buffer::Source::Bin => {
                Cow::Borrowed(blob.ok_or("it has no binary chunk; expected one")?)
            }
            gltf::buffer::Source::Uri(uri) => match uri.strip_prefix("data:") {
                Some(data) => {
                    let (kind, text) = data.split_once(',').unwrap_or((data, ""));
                    let plain = kind.ends_with(";base64").then(|| decode_base64(text)).flatten();
                    Cow::Owned(plain.ok_or_else(|| {
                        format!("buffer {}: expected base64 data", buffer.index())
                    })?)
                }
                None => {
                    let file = folder.join(decode_percent(uri));
                    let bytes = durable::read_regular_file_up_to(&file, left).map_err(|e| {
                        format!("buffer {}: {}: {e}", buffer.index(), file.display())
                    })?;
                    left -= bytes.len() as u64;
                    Cow::Owned(bytes)
                }
            },
        };
        if bytes.len() < buffer.length() {
            return Err(format!(
                "buffer {} holds {} bytes; expected {}",
                buffer.index(),
                bytes.len(),
                buffer.length()
            ));
        }
        buffers.push(bytes);
    }
    Ok(buffers)
}

/// A node whose triangles are still to be added.
struct PlacedNode<'a> {
    node: Node<'a>,
    world_from_parent: NodeMatrix,
}

struct SceneTriangles<'a> {
    buffers: Vec<Cow<'a, [u8]>>,
    mesh: Mesh,
    /// Nodes visited; a scene is a forest.
    seen: Vec<bool>,
}

impl SceneTriangles<'_> {
    fn add_subtrees(&mut self, mut pending: Vec<PlacedNode<'_>>) -> Result<(), ParseStop> {
        while let Some(PlacedNode { node, world_from_parent }) = pending.pop() {
            if std::mem::replace(&mut self.seen[node.index()], true) {
                return malformed(format!(
                    "node {} is reached twice; expected trees",
                    node.index()
                ));
            }
            let parent_from_node = node.transform().matrix().map(|column| column.map(f64::from));
            let matrix = matrix_product(&world_from_parent, &parent_from_node);
            for primitive in node.mesh().iter().flat_map(|mesh| mesh.primitives()) {
                self.add_primitive(&primitive, &matrix)?;
            }
            let children = node.children();
            pending.extend(
                children.map(|child| PlacedNode { node: child, world_from_parent: matrix }),
            );
        }
        Ok(())
    }

    fn add_primitive(
        &mut self,
        primitive: &Primitive<'_>,
        world_from_node: &NodeMatrix,
    ) -> Result<(), ParseStop> {
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            return Ok(());
        }
        let positions = primitive
            .get(&gltf::Semantic::Positions)
            .ok_or_else(|| format!("primitive {} has no positions", primitive.index()))?;
        let points =
            AccessorElements::find(&self.buffers, &positions, Dimensions::Vec3, &[DataType::F32])?;
        let kinds = [DataType::U8, DataType::U16, DataType::U32];
        let find =
            |indices| AccessorElements::find(&self.buffers, &indices, Dimensions::Scalar, &kinds);
        let indices = primitive.indices().map(find).transpose()?;
        let triangles =
            count_triangles(mode, indices.as_ref().map_or(points.count, |indices| indices.count));
        // Primitives and nodes may share an accessor, so the file's length is no bound.
        self.mesh.check_room_for_vertices(points.count)?;
        self.mesh.check_room_for_triangles(triangles)?;
        let base = self.mesh.positions.len() as u32;
        let mirrored = determinant(world_from_node) < 0.0;
        for triangle in 0..triangles {
            let [a, b, c] = corners_of_triangle(mode, triangle).map(|corner| match &indices {
                Some(indices) => little_endian(indices.bytes_of(corner)),
                None => corner as u64,
            });
            let triangle = if mirrored { [a, c, b] } else { [a, b, c] };
            if let Some(i) = triangle.iter().find(|&&i| i >= points.count as u64) {
                return malformed(format!(
                    "a primitive has the index {i}; expected less than {}",
                    points.count
                ));
            }
            self.mesh.triangles.push(triangle.map(|i| base + i as u32));
        }
        let coordinate = |bytes: &[u8]| f64::from(f32::from_bits(little_endian(bytes) as u32));
        self.mesh.positions.extend((0..points.count).map(|i| {
            let bytes = points.bytes_of(i);
            transform_point(
                world_from_node,
                [&bytes[..4], &bytes[4..8], &bytes[8..]].map(coordinate),
            )
        }));
        Ok(())
    }
}

/// The elements of an accessor, all of which lie inside its view.
struct AccessorElements<'a> {
    /// The view from the first element on.
    bytes: &'a [u8],
    /// Bytes from one element to the next.
    stride: usize,
    /// Bytes of an element.
    size: usize,
    count: usize,
}

impl<'a> AccessorElements<'a> {
    /// Finds the elements of an accessor, which must have these dimensions and one of these types.
    fn find(
        buffers: &'a [Cow<'_, [u8]>],
        accessor: &Accessor<'_>,
        dimensions: Dimensions,
        kinds: &[DataType],
    ) -> Result<Self, String> {
        let at = |what: &str| format!("accessor {}: {what}", accessor.index());
        if accessor.dimensions() != dimensions || !kinds.contains(&accessor.data_type()) {
            return Err(at(&format!("expected {dimensions:?} of one of {kinds:?}")));
        }
        if accessor.sparse().is_some() {
            return Err(at("sparse data; expected plain data"));
        }
        let view = accessor.view().ok_or_else(|| at("expected a buffer view"))?;
        let buffer = buffers.get(view.buffer().index());
        let end = view.offset().checked_add(view.length());
        let bytes = end.and_then(|end| buffer?.get(view.offset()..end));
        let bytes = bytes.ok_or_else(|| at("its view ends outside its buffer"))?;
        let (size, count) = (accessor.size(), accessor.count());
        let stride = view.stride().unwrap_or(size).max(1);
        let bytes = bytes.get(accessor.offset()..).unwrap_or(&[]);
        let fitting = bytes.len().checked_sub(size).map_or(0, |last| last / stride + 1);
        if count > fitting {
            return Err(at(&format!("its view holds {fitting} elements; expected {count}")));
        }
        Ok(AccessorElements { bytes, stride, size, count })
    }

    /// The bytes of element `i`, which must be less than the count.
    fn bytes_of(&self, i: usize) -> &'a [u8] {
        &self.bytes[i * self.stride..][..self.size]
    }
}

/// Decodes up to eight bytes as a little-endian number.
fn little_endian(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |value, &byte| value << 8 | u64::from(byte))
}

fn count_triangles(mode: Mode, corners: usize) -> usize {
    if mode == Mode::Triangles { corners / 3 } else { corners.saturating_sub(2) }
}

/// The corners of a triangle of a list, a strip or a fan, by their number.
fn corners_of_triangle(mode: Mode, triangle: usize) -> [usize; 3] {
    let i = triangle;
    match mode {
        Mode::TriangleStrip if i.is_multiple_of(2) => [i, i + 1, i + 2],
        Mode::TriangleStrip => [i + 1, i, i + 2],
        Mode::TriangleFan => [0, i + 1, i + 2],
        _ => [3 * i, 3 * i + 1, 3 * i + 2],
    }
}

fn matrix_product(a: &NodeMatrix, b: &NodeMatrix) -> NodeMatrix {
    b.map(|column| [0, 1, 2, 3].map(|row| (0..4).map(|k| a[k][row] * column[k]).sum()))
}

fn transform_point(matrix: &NodeMatrix, p: [f64; 3]) -> [f32; 3] {
    let row =
        |k: usize| matrix[0][k] * p[0] + matrix[1][k] * p[1] + matrix[2][k] * p[2] + matrix[3][k];
    [0, 1, 2].map(|k| row(k) as f32)
}

fn determinant(m: &NodeMatrix) -> f64 {
    m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
        - m[1][0] * (m[0][1] * m[2][2] - m[0][2] * m[2][1])
        + m[2][0] * (m[0][1] * m[1][2] - m[0][2] * m[1][1])
}

/// Decodes base64 (RFC 4648), with or without padding. `None` for a character outside the alphabet.
fn decode_base64(text: &str) -> Option<Vec<u8>> {
    let mut bytes = Vec::new();
    let (mut bits, mut held) = (0u32, 0);
    for c in text.trim_end_matches('=').bytes() {
        let value = match c {
            b'A'..=b'Z' => c - b'A',
            b'a'..=b'z' => c - b'a' + 26,
            b'0'..=b'9' => c - b'0' + 52,
            b'+' => 62,
            b'/' => 63,
            _ => return None,
        };
        bits = bits << 6 | u32::from(value);
        held += 6;
        if held >= 8 {
            held -= 8;
            bytes.push((bits >> held) as u8);
        }
    }
    Some(bytes)
}

/// Decodes a URI's percent-encoding.
fn decode_percent(uri: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = uri.as_bytes();
    while let Some((&first, tail)) = rest.split_first() {
        let digits = tail.get(..2).and_then(|d| std::str::from_utf8(d).ok());
        match digits.and_then(|d| u8::from_str_radix(d, 16).ok()) {
            Some(byte) if first == b'%' => {
                bytes.push(byte);
                rest = &tail[2..];
            }
            _ => {
                bytes.push(first);
                rest = tail;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}
