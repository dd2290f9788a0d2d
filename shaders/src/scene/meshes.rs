//! The meshes generated at build time, in one vertex table and one index table.

use bytemuck::{Pod, Zeroable};
use paros_core::session::{Tool, ToolBit};

/// A mesh vertex: 20 bytes.
#[derive(Clone, Copy, PartialEq, Debug, Pod, Zeroable)]
#[repr(C)]
pub struct MeshVertex {
    /// Position, in metres.
    pub position: [f32; 3],
    /// Unit outward normal, signed normalised; the fourth is 0.
    pub normal: [i8; 4],
    /// Linear reflectance, unsigned normalised; the fourth is the openness, the part of the ambient
    /// light that arrives.
    pub colour: [u8; 4],
}

/// The range of a mesh in the tables.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct MeshRange {
    /// The mesh's first index.
    pub first_index: u32,
    /// Number of indices: three a triangle, counter-clockwise as seen from outside.
    pub index_count: u32,
    /// Offset added to the mesh's indices.
    pub base_vertex: u32,
    /// Number of vertices.
    pub vertex_count: u32,
    /// Bounding radius about the mesh's origin, in metres.
    pub radius: f32,
}

/// Groups of meshes in draw order; the sculpture comes after the first.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum DrawGroup {
    /// Tools, bits and hands.
    Handheld,
    /// The room, bench and stool.
    Surroundings,
    /// Chips, dust and guides, blended by the tint's fourth component.
    Particles,
    /// Guides seen only where something is in front of them, blended by the tint's fourth component.
    Hidden,
}

/// A hand's shape.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum HandShape {
    /// Held open.
    Open,
    /// Closed on a handle.
    Closed,
}

include!(concat!(env!("OUT_DIR"), "/meshes.rs"));

impl DrawGroup {
    /// Number of groups.
    pub(crate) const COUNT: usize = 4;
}

impl MeshId {
    /// Returns the mesh of a tool's body.
    #[must_use]
    pub const fn of_tool(tool: Tool) -> Self {
        match tool {
            Tool::Rotary => MeshId::Rotary,
            Tool::Impact => MeshId::Impact,
            Tool::FillGun => MeshId::FillGun,
            Tool::Rasp => MeshId::Rasp,
        }
    }

    /// Returns the mesh of a bit.
    #[must_use]
    pub const fn of_bit(bit: ToolBit) -> Self {
        match bit {
            ToolBit::SmallBall => MeshId::SmallBall,
            ToolBit::MediumBall => MeshId::MediumBall,
            ToolBit::LargeBall => MeshId::LargeBall,
            ToolBit::Cylinder => MeshId::Cylinder,
            ToolBit::Grinder => MeshId::Grinder,
            ToolBit::PointChisel => MeshId::PointChisel,
            ToolBit::FlatChisel => MeshId::FlatChisel,
            ToolBit::RoughingBall => MeshId::RoughingBall,
            ToolBit::DiscSaw => MeshId::DiscSaw,
            ToolBit::Nozzle => MeshId::Nozzle,
            ToolBit::File => MeshId::File,
            ToolBit::Float => MeshId::Float,
            ToolBit::PitchingChisel => MeshId::PitchingChisel,
        }
    }

    /// Returns the mesh of the left hand.
    #[must_use]
    pub const fn of_left_hand(shape: HandShape) -> Self {
        match shape {
            HandShape::Open => MeshId::OpenLeftHand,
            HandShape::Closed => MeshId::ClosedLeftHand,
        }
    }

    /// Returns the mesh of the right hand.
    #[must_use]
    pub const fn of_right_hand(shape: HandShape) -> Self {
        match shape {
            HandShape::Open => MeshId::OpenRightHand,
            HandShape::Closed => MeshId::ClosedRightHand,
        }
    }

    /// Returns the mesh's range in the tables.
    #[must_use]
    pub const fn range(self) -> &'static MeshRange {
        &TABLE[self as usize]
    }

    /// Returns `true` if the mesh is drawn into the shadow map. The garden isn't, as it is out of the sun's
    /// way, nor are particles, which are too small.
    #[must_use]
    pub const fn casts_shadow(self) -> bool {
        !matches!(self, MeshId::Outside | MeshId::Speck | MeshId::Chip)
    }

    /// Returns the mesh's draw group.
    #[must_use]
    pub const fn draw_group(self) -> DrawGroup {
        match self {
            MeshId::Room
            | MeshId::Outside
            | MeshId::Workbench
            | MeshId::StoolBase
            | MeshId::StoolTop => DrawGroup::Surroundings,
            MeshId::Chip | MeshId::Speck => DrawGroup::Particles,
            _ => DrawGroup::Handheld,
        }
    }

    /// Returns the mesh's vertices.
    #[must_use]
    pub fn vertices(self) -> &'static [MeshVertex] {
        let mesh = self.range();
        &all_vertices()[mesh.base_vertex as usize..][..mesh.vertex_count as usize]
    }

    /// Returns the mesh's indices, relative to its first vertex.
    #[must_use]
    pub fn indices(self) -> &'static [u16] {
        let mesh = self.range();
        &all_indices()[mesh.first_index as usize..][..mesh.index_count as usize]
    }
}

/// Returns all vertices.
#[must_use]
pub fn all_vertices() -> &'static [MeshVertex] {
    bytemuck::cast_slice(&VERTICES.0)
}

/// Returns all indices, each relative to its mesh's first vertex.
#[must_use]
pub fn all_indices() -> &'static [u16] {
    bytemuck::cast_slice(&INDICES.0)
}

/// Bytes aligned for `f32`.
#[repr(C, align(4))]
struct Aligned<const N: usize>([u8; N]);

static VERTICES: Aligned<{ include_bytes!(concat!(env!("OUT_DIR"), "/vertices.bin")).len() }> =
    Aligned(*include_bytes!(concat!(env!("OUT_DIR"), "/vertices.bin")));
static INDICES: Aligned<{ include_bytes!(concat!(env!("OUT_DIR"), "/indices.bin")).len() }> =
    Aligned(*include_bytes!(concat!(env!("OUT_DIR"), "/indices.bin")));
