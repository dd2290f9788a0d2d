//! Vertex input states: bindings and attributes of the vertex programs.

use core::mem::offset_of;

use ash::vk;

use super::panel;
use super::panel_instance::PanelInstance;
use crate::panel::PanelQuad;
use crate::scene::{MeshInstance, MeshVertex};

/// The vertex input of a program.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum VertexInput {
    /// No buffers: the vertex index alone.
    VertexIndex,
    /// Mesh vertices and instances.
    Mesh,
    /// Positions of mesh vertices, and transforms of instances.
    MeshPositions,
    /// Panel vertices.
    Panel,
    /// Instances of quads of panels in the room.
    PanelQuads,
}

/// Attributes (location, format, offset) of a mesh vertex, a panel vertex and an instance.
const VERTEX: [(u32, vk::Format, u32); 3] = [
    (0, vk::Format::R32G32B32_SFLOAT, offset_of!(MeshVertex, position) as u32),
    (1, vk::Format::R8G8B8A8_SNORM, offset_of!(MeshVertex, normal) as u32),
    (2, vk::Format::R8G8B8A8_UNORM, offset_of!(MeshVertex, colour) as u32),
];
const PANEL: [(u32, vk::Format, u32); 3] = [
    (0, vk::Format::R32G32_SFLOAT, offset_of!(panel::PanelVertex, position) as u32),
    (1, vk::Format::R32G32_SFLOAT, offset_of!(panel::PanelVertex, texel) as u32),
    (2, vk::Format::R8G8B8A8_UNORM, offset_of!(panel::PanelVertex, color) as u32),
];
const INSTANCE: [(u32, vk::Format, u32); 4] = [
    (3, vk::Format::R32G32B32A32_SFLOAT, transform_row_offset(0)),
    (4, vk::Format::R32G32B32A32_SFLOAT, transform_row_offset(1)),
    (5, vk::Format::R32G32B32A32_SFLOAT, transform_row_offset(2)),
    (6, vk::Format::R32G32B32A32_SFLOAT, offset_of!(MeshInstance, tint) as u32),
];

const PANEL_QUADS: [(u32, vk::Format, u32); 8] = [
    (0, vk::Format::R32G32B32A32_SFLOAT, panel_row_offset(0)),
    (1, vk::Format::R32G32B32A32_SFLOAT, panel_row_offset(1)),
    (2, vk::Format::R32G32B32A32_SFLOAT, panel_row_offset(2)),
    (3, vk::Format::R32G32B32A32_SFLOAT, quad_offset(offset_of!(PanelQuad, middle))),
    (4, vk::Format::R32G32B32A32_SFLOAT, quad_offset(offset_of!(PanelQuad, shape))),
    (5, vk::Format::R8G8B8A8_UNORM, quad_offset(offset_of!(PanelQuad, fill))),
    (6, vk::Format::R8G8B8A8_UNORM, quad_offset(offset_of!(PanelQuad, outline))),
    (7, vk::Format::R32_UINT, quad_offset(offset_of!(PanelQuad, kind))),
];

// `middle` and `half` are read as one attribute.
const _: () = assert!(offset_of!(PanelQuad, half) == offset_of!(PanelQuad, middle) + 8);

/// Returns the offset of a row of a panel's transform, in bytes.
const fn panel_row_offset(i: usize) -> u32 {
    (offset_of!(PanelInstance, rows) + i * size_of::<[f32; 4]>()) as u32
}

/// Returns the offset of a quad's field, in bytes.
const fn quad_offset(field: usize) -> u32 {
    (offset_of!(PanelInstance, quad) + field) as u32
}

/// Returns the offset of a row of an instance's transform, in bytes.
const fn transform_row_offset(i: u32) -> u32 {
    offset_of!(MeshInstance, transform) as u32 + i * size_of::<[f32; 4]>() as u32
}

impl VertexInput {
    pub(crate) fn bindings(self) -> Vec<vk::VertexInputBindingDescription> {
        let binding = |binding, stride: usize, input_rate| vk::VertexInputBindingDescription {
            binding,
            stride: stride as u32,
            input_rate,
        };
        match self {
            VertexInput::VertexIndex => Vec::new(),
            VertexInput::Panel => {
                vec![binding(0, size_of::<panel::PanelVertex>(), vk::VertexInputRate::VERTEX)]
            }
            VertexInput::PanelQuads => {
                vec![binding(1, size_of::<PanelInstance>(), vk::VertexInputRate::INSTANCE)]
            }
            VertexInput::Mesh | VertexInput::MeshPositions => vec![
                binding(0, size_of::<MeshVertex>(), vk::VertexInputRate::VERTEX),
                binding(1, size_of::<MeshInstance>(), vk::VertexInputRate::INSTANCE),
            ],
        }
    }

    pub(crate) fn attributes(self) -> Vec<vk::VertexInputAttributeDescription> {
        let (vertex, instance) = match self {
            VertexInput::VertexIndex => (&VERTEX[..0], &INSTANCE[..0]),
            VertexInput::Panel => (&PANEL[..], &INSTANCE[..0]),
            VertexInput::PanelQuads => (&PANEL[..0], &PANEL_QUADS[..]),
            VertexInput::Mesh => (&VERTEX[..], &INSTANCE[..]),
            VertexInput::MeshPositions => (&VERTEX[..1], &INSTANCE[..3]),
        };
        let of = |binding| {
            move |&(location, format, offset): &(u32, vk::Format, u32)| {
                vk::VertexInputAttributeDescription { location, binding, format, offset }
            }
        };
        vertex.iter().map(of(0)).chain(instance.iter().map(of(1))).collect()
    }
}
