//! The meshes made at build time: one table of vertices, one of indices.

use bytemuck::{Pod, Zeroable};
use paros_core::tools::{Bit, Tool};

/// A corner of a triangle: 20 bytes.
#[derive(Clone, Copy, PartialEq, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct Vertex {
    /// In metres.
    pub position: [f32; 3],
    /// Unit, outward, as signed parts of 127; the fourth is 0.
    pub normal: [i8; 4],
    /// Linear reflectance, as parts of 255; the fourth is the part of the ambient light that
    /// arrives.
    pub colour: [u8; 4],
}

/// Where a mesh is in the tables.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Mesh {
    /// Its first index.
    pub first_index: u32,
    /// Its indices: three a triangle, counter-clockwise as seen from outside.
    pub index_count: u32,
    /// What is added to its indices.
    pub base_vertex: u32,
    /// Its vertices.
    pub vertex_count: u32,
    /// Radius of the ball about its origin that holds it, in metres.
    pub radius: f32,
}

include!(concat!(env!("OUT_DIR"), "/meshes.rs"));

impl MeshId {
    /// The body of a tool.
    #[must_use]
    pub const fn of_tool(tool: Tool) -> Self {
        match tool {
            Tool::Rotary => MeshId::Rotary,
            Tool::Impact => MeshId::Impact,
            Tool::FillGun => MeshId::FillGun,
            Tool::Rasp => MeshId::Rasp,
        }
    }

    /// A bit.
    #[must_use]
    pub const fn of_bit(bit: Bit) -> Self {
        match bit {
            Bit::SmallBall => MeshId::SmallBall,
            Bit::MediumBall => MeshId::MediumBall,
            Bit::LargeBall => MeshId::LargeBall,
            Bit::Cylinder => MeshId::Cylinder,
            Bit::Grinder => MeshId::Grinder,
            Bit::PointChisel => MeshId::PointChisel,
            Bit::FlatChisel => MeshId::FlatChisel,
            Bit::Nozzle => MeshId::Nozzle,
            Bit::File => MeshId::File,
        }
    }

    /// A hand: 0 left, 1 right; closed on a handle or open.
    #[must_use]
    pub const fn of_hand(hand: usize, closed: bool) -> Self {
        match (hand, closed) {
            (0, false) => MeshId::OpenLeftHand,
            (0, true) => MeshId::ClosedLeftHand,
            (_, false) => MeshId::OpenRightHand,
            (_, true) => MeshId::ClosedRightHand,
        }
    }

    /// Where it is in the tables.
    #[must_use]
    pub const fn mesh(self) -> &'static Mesh {
        &TABLE[self as usize]
    }

    /// Whether it keeps the sun off others. The garden is beyond the sun's way, specks are too
    /// small.
    #[must_use]
    pub const fn casts_shadow(self) -> bool {
        !matches!(self, MeshId::Outside | MeshId::Speck)
    }

    /// Its vertices.
    #[must_use]
    pub fn vertices(self) -> &'static [Vertex] {
        let mesh = self.mesh();
        &vertices()[mesh.base_vertex as usize..][..mesh.vertex_count as usize]
    }

    /// Its indices, from its own first vertex.
    #[must_use]
    pub fn indices(self) -> &'static [u16] {
        let mesh = self.mesh();
        &indices()[mesh.first_index as usize..][..mesh.index_count as usize]
    }
}

/// All vertices.
#[must_use]
pub fn vertices() -> &'static [Vertex] {
    bytemuck::cast_slice(&VERTICES.0)
}

/// All indices, each from its mesh's first vertex.
#[must_use]
pub fn indices() -> &'static [u16] {
    bytemuck::cast_slice(&INDICES.0)
}

/// Bytes at an address that floats can have.
#[repr(C, align(4))]
struct Aligned<const N: usize>([u8; N]);

static VERTICES: Aligned<{ include_bytes!(concat!(env!("OUT_DIR"), "/vertices.bin")).len() }> =
    Aligned(*include_bytes!(concat!(env!("OUT_DIR"), "/vertices.bin")));
static INDICES: Aligned<{ include_bytes!(concat!(env!("OUT_DIR"), "/indices.bin")).len() }> =
    Aligned(*include_bytes!(concat!(env!("OUT_DIR"), "/indices.bin")));
