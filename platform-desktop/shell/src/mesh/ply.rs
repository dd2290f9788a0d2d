//! PLY through `ply-rs-bw`: the elements `vertex` and `face`, the others read over.

use super::{Mesh, ParseStop, malformed};
use ply_rs_bw::parser::Parser;
use ply_rs_bw::ply::{ElementDef, Header, Property, PropertyAccess};
use std::io::BufRead;

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, ParseStop> {
    let mut rest = bytes;
    let header =
        Parser::<SkippedElement>::new().read_header(&mut rest).map_err(|e| e.to_string())?;
    let mut mesh = Mesh::default();
    for name in ["vertex", "face"] {
        if !header.elements.contains_key(name) {
            return malformed(format!(
                "its header has no element `{name}`; expected `vertex` and `face`"
            ));
        }
    }
    for element in header.elements.values() {
        // Also an element without properties takes a line; in binary it would take nothing, forever.
        if element.count > rest.len() {
            return malformed(format!(
                "{} bytes follow the header's {} elements `{}`; expected at least one for each",
                rest.len(),
                element.count,
                element.name
            ));
        }
        match element.name.as_str() {
            "vertex" => {
                mesh.check_room_for_vertices(element.count)?;
                push_vertices(&mut mesh, &read_elements(&mut rest, element, &header)?)?;
            }
            "face" => {
                mesh.check_room_for_triangles(element.count)?;
                push_faces(&mut mesh, &read_elements(&mut rest, element, &header)?)?;
            }
            _ => drop(read_elements::<SkippedElement>(&mut rest, element, &header)?),
        }
    }
    Ok(mesh)
}

fn read_elements<E: PropertyAccess>(
    rest: &mut impl BufRead,
    element: &ElementDef,
    header: &Header,
) -> Result<Vec<E>, String> {
    Parser::<E>::new()
        .read_payload_for_element(rest, element, header)
        .map_err(|e| format!("in the elements `{}`: {e}", element.name))
}

fn push_vertices(mesh: &mut Mesh, vertices: &[VertexElement]) -> Result<(), ParseStop> {
    for (i, vertex) in vertices.iter().enumerate() {
        let [Some(x), Some(y), Some(z)] = vertex.0 else {
            return malformed(format!(
                "vertex {i} lacks a coordinate; expected numbers x, y and z"
            ));
        };
        mesh.positions.push([x, y, z]);
    }
    Ok(())
}

fn push_faces(mesh: &mut Mesh, faces: &[FaceElement]) -> Result<(), ParseStop> {
    for (i, face) in faces.iter().enumerate() {
        let Some(corners) = &face.0 else {
            return malformed(format!(
                "face {i} lacks its corners; expected a list `vertex_indices` of numbers from 0"
            ));
        };
        mesh.push_polygon(corners)?;
    }
    Ok(())
}

struct SkippedElement;

impl PropertyAccess for SkippedElement {
    fn new() -> Self {
        SkippedElement
    }
}

struct VertexElement([Option<f32>; 3]);

impl PropertyAccess for VertexElement {
    fn new() -> Self {
        VertexElement([None; 3])
    }

    fn set_property(&mut self, name: &str, value: Property) {
        let axis = match name {
            "x" => 0,
            "y" => 1,
            "z" => 2,
            _ => return,
        };
        self.0[axis] = match value {
            Property::Float(v) => Some(v),
            Property::Double(v) => Some(v as f32),
            Property::Char(v) => Some(v.into()),
            Property::UChar(v) => Some(v.into()),
            Property::Short(v) => Some(v.into()),
            Property::UShort(v) => Some(v.into()),
            Property::Int(v) => Some(v as f32),
            Property::UInt(v) => Some(v as f32),
            _ => None,
        };
    }
}

struct FaceElement(Option<Vec<u32>>);

impl PropertyAccess for FaceElement {
    fn new() -> Self {
        FaceElement(None)
    }

    fn set_property(&mut self, name: &str, value: Property) {
        if name != "vertex_indices" && name != "vertex_index" {
            return;
        }
        self.0 = match value {
            Property::ListChar(list) => to_indices(list),
            Property::ListUChar(list) => to_indices(list),
            Property::ListShort(list) => to_indices(list),
            Property::ListUShort(list) => to_indices(list),
            Property::ListInt(list) => to_indices(list),
            Property::ListUInt(list) => Some(list),
            _ => None,
        };
    }
}

/// `None` where a number is negative.
fn to_indices<T: TryInto<u32>>(list: Vec<T>) -> Option<Vec<u32>> {
    list.into_iter().map(|index| index.try_into().ok()).collect()
}
