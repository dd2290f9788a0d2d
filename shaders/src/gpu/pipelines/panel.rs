//! Geometry of panels and text: vertices, and clipped runs of triangles.

use std::ops::Range;

use bytemuck::{Pod, Zeroable};

/// A vertex of a panel or glyph.
#[derive(Clone, Copy, PartialEq, Default, Pod, Zeroable, Debug)]
#[repr(C)]
pub struct PanelVertex {
    /// Pixels from the target's left and upper sides.
    pub position: [f32; 2],
    /// Texels from the atlas's left and upper sides.
    pub texel: [f32; 2],
    /// Premultiplied sRGB colour and alpha, multiplied with the atlas's.
    pub color: [u8; 4],
}

/// Triangles with a scissor rectangle.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct ClippedRun {
    /// Pixels: left, upper, right and lower side.
    pub clip: [u32; 4],
    /// Range of indices.
    pub indices: Range<u32>,
}
