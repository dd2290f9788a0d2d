//! PLY: the elements `vertex`, `face` and `tristrips`. Other elements are skipped.

mod body;
mod header;

use super::builder::{MeshBuilder, VertexIndex};
use super::text::{self, size_from_number};
use super::{MAX_TRIANGLES, Mesh, MeshFault, malformed};
use body::Body;
use header::{Element, Header};

pub(super) fn parse(bytes: &[u8]) -> Result<Mesh, MeshFault> {
    let bytes = text::decode(bytes);
    let (header, bytes) = header::parse(&bytes)?;
    let has = |kind: Kind| header.elements.iter().any(|element| Kind::of(element) == kind);
    if !has(Kind::Vertices) || !(has(Kind::Faces) || has(Kind::Strips)) {
        return malformed(
            "its header has no elements `vertex` and `face`; expected both, or `vertex` and \
             `tristrips`"
                .into(),
        );
    }
    let mut mesh = PlyMesh::default();
    // Faces may come before the vertices.
    mesh.read_elements(&header, bytes, |kind| kind == Kind::Vertices)?;
    mesh.read_elements(&header, bytes, |kind| kind == Kind::Faces || kind == Kind::Strips)?;
    mesh.builder.finish()
}

/// The use of an element.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Vertices,
    Faces,
    /// Triangle strips; within a list, -1 ends a strip.
    Strips,
    Other,
}

impl Kind {
    fn of(element: &Element) -> Self {
        match element.name.as_str() {
            "vertex" | "vertices" => Kind::Vertices,
            "face" | "faces" => Kind::Faces,
            "tristrips" | "tristrip" => Kind::Strips,
            _ => Kind::Other,
        }
    }
}

#[derive(Default)]
struct PlyMesh {
    builder: MeshBuilder,
    vertices: Vec<VertexIndex>,
}

impl PlyMesh {
    /// Reads all elements up to the last wanted one, and adds the wanted ones.
    fn read_elements(
        &mut self,
        header: &Header,
        bytes: &[u8],
        is_wanted: impl Fn(Kind) -> bool,
    ) -> Result<(), MeshFault> {
        let mut body = Body::new(header, bytes);
        let last = header.elements.iter().rposition(|element| is_wanted(Kind::of(element)));
        for element in header.elements.iter().take(last.map_or(0, |last| last + 1)) {
            let kind = Kind::of(element);
            if !is_wanted(kind) {
                body.skip_elements(element)?;
                continue;
            }
            body.check_room_for(element)?;
            match kind {
                Kind::Vertices => self.read_vertices(element, &mut body)?,
                _ => self.read_faces(element, kind, &mut body)?,
            }
        }
        Ok(())
    }

    fn read_vertices(&mut self, element: &Element, body: &mut Body<'_>) -> Result<(), MeshFault> {
        let mut axes = Vec::new();
        for property in &element.properties {
            let axis = ["x", "y", "z"].iter().position(|name| *name == property.name);
            axes.push(axis.filter(|_| property.count.is_none()));
        }
        if let Some(axis) = (0..3).find(|axis| !axes.contains(&Some(*axis))) {
            return malformed(format!(
                "its header gives vertices no `{}`; expected numbers `x`, `y` and `z`",
                ["x", "y", "z"][axis]
            ));
        }
        // More than the corners of all triangles.
        if element.count > 3 * MAX_TRIANGLES {
            return Err(MeshFault::TooManyTriangles { count: element.count.div_ceil(3) });
        }
        for i in 0..element.count {
            let mut position = [f64::NAN; 3];
            body.begin_element();
            for (property, axis) in element.properties.iter().zip(&axes) {
                let read = match axis {
                    Some(axis) => body.read_number(property.number).map(|c| position[*axis] = c),
                    None => body.skip_property(property),
                };
                read.map_err(|why| body.place(element, i, &why))?;
            }
            self.vertices.push(self.builder.add_vertex(position));
        }
        Ok(())
    }

    fn read_faces(
        &mut self,
        element: &Element,
        kind: Kind,
        body: &mut Body<'_>,
    ) -> Result<(), MeshFault> {
        let lists = || element.properties.iter().enumerate().filter(|(_, p)| p.count.is_some());
        let named = lists().find(|(_, p)| matches!(&*p.name, "vertex_indices" | "vertex_index"));
        // A single list can only be the corners.
        let Some((of_corners, _)) =
            named.or_else(|| lists().next().filter(|_| lists().count() == 1))
        else {
            return malformed(format!(
                "its header gives `{}` no corners; expected a list `vertex_indices`",
                element.name
            ));
        };
        if kind == Kind::Faces {
            self.builder.check_room(element.count)?;
        }
        let mut corners = Vec::new();
        for i in 0..element.count {
            body.begin_element();
            for (at, property) in element.properties.iter().enumerate() {
                let read = if at == of_corners {
                    body.read_list(property, &mut corners)
                } else {
                    body.skip_property(property)
                };
                read.map_err(|why| body.place(element, i, &why))?;
            }
            let added = match kind {
                Kind::Strips => self.add_strips(&corners),
                _ => self.add_face(&corners),
            };
            added.map_err(|fault| fault.at(|| body.place(element, i, "")))?;
        }
        Ok(())
    }

    fn add_face(&mut self, corners: &[f64]) -> Result<(), MeshFault> {
        self.builder.check_room(corners.len().saturating_sub(2))?;
        let corners: Result<Vec<_>, _> = corners.iter().map(|&c| self.find_corner(c)).collect();
        self.builder.add_polygon(&corners?)
    }

    /// Adds strips. An index of -1, or the greatest unsigned number, ends a strip and starts the next.
    fn add_strips(&mut self, corners: &[f64]) -> Result<(), MeshFault> {
        let is_restart = |&corner: &f64| corner == -1.0 || corner == f64::from(u32::MAX);
        for strip in corners.split(is_restart) {
            self.builder.check_room(strip.len().saturating_sub(2))?;
            for (i, triangle) in strip.windows(3).enumerate() {
                let [mut a, mut b, c] = [triangle[0], triangle[1], triangle[2]];
                if i % 2 == 1 {
                    (a, b) = (b, a);
                }
                let corners = [self.find_corner(a)?, self.find_corner(b)?, self.find_corner(c)?];
                self.builder.add_triangle(corners)?;
            }
        }
        Ok(())
    }

    fn find_corner(&self, corner: f64) -> Result<VertexIndex, String> {
        let vertex = size_from_number(corner).and_then(|index| self.vertices.get(index).copied());
        vertex.ok_or_else(|| {
            format!("found vertex {corner}; expected one of {}, from 0 on", self.vertices.len())
        })
    }
}
