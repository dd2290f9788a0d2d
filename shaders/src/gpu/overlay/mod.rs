//! Panels and text over a frame: triangles with colours and an atlas of glyphs, drawn last in the
//! frame's pass. Data in; what lays text out is the shell's.

mod pipeline;

use std::ops::Range;
use std::sync::Arc;

use ash::vk;
use bytemuck::{Pod, Zeroable};

use super::buffer::Buffer;
use super::context::Gpu;
use super::error::Error;
use super::image::{Image, Shape};
use super::pass::{Format, Pass};
use pipeline::Drawing;

/// Texels along a side of the atlas: a font of a few hundred glyphs at twice the usual scale.
pub const ATLAS: u32 = 1024;
/// Vertices of a frame: a screen full of text.
pub const VERTICES: usize = 32_768;
/// Indices of a frame, three for a triangle.
pub const INDICES: usize = 3 * VERTICES;
/// Clipped runs of a frame.
pub const RUNS: usize = 512;
/// Texels of the atlas that a frame takes: a quarter of it.
pub const PATCH: usize = (ATLAS * ATLAS / 4) as usize;

/// Parts of the atlas that a frame takes.
const PATCHES: usize = 64;
const TEXEL: usize = 4;

/// A corner of a triangle.
#[derive(Clone, Copy, PartialEq, Default, Pod, Zeroable, Debug)]
#[repr(C)]
pub struct Vertex {
    /// Pixels from the target's left and upper sides.
    pub position: [f32; 2],
    /// Texels from the atlas's left and upper sides.
    pub texel: [f32; 2],
    /// Red, green, blue and alpha as sRGB, alpha multiplied in; it is multiplied with the atlas's.
    pub color: [u8; 4],
}

/// Triangles that are drawn within a rectangle alone.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Run {
    /// Pixels: left, upper, right and lower side.
    pub clip: [u32; 4],
    /// Which indices.
    pub indices: Range<u32>,
}

/// What is drawn over frames. Nothing is allocated once it is made.
pub struct Overlay {
    drawing: Drawing,
    atlas: Image,
    slots: Vec<Slot>,
    at: usize,
    cleared: bool,
}

/// What a frame of the ring reads.
struct Slot {
    vertices: Buffer,
    indices: Buffer,
    texels: Buffer,
    runs: Vec<Run>,
    /// Rectangles of the atlas, and where in `texels` they begin.
    patches: Vec<(vk::Rect2D, usize)>,
    used: usize,
}

impl Overlay {
    pub(super) fn new(
        gpu: &Arc<Gpu>,
        format: &Format,
        pass: &Pass,
        ring: usize,
        cache: vk::PipelineCache,
    ) -> Result<Self, Error> {
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
        let shape = Shape::flat(vk::Format::R8G8B8A8_UNORM, [ATLAS; 2], 1).usage(usage);
        let atlas = Image::new(gpu, shape)?;
        let drawing = Drawing::new(gpu, format, pass, atlas.view, cache)?;
        let slots = (0..ring).map(|_| Slot::new(gpu)).collect::<Result<_, _>>()?;
        Ok(Overlay { drawing, atlas, slots, at: 0, cleared: false })
    }

    /// Takes texels for a rectangle of the atlas, rows after rows; alpha is multiplied in. Whether
    /// there was room for them in the frame that has begun.
    #[must_use]
    pub fn patch(&mut self, min: [u32; 2], size: [u32; 2], texels: &[[u8; 4]]) -> bool {
        debug_assert_eq!(texels.len() as u32, size[0] * size[1], "a rectangle's texels");
        let slot = &mut self.slots[self.at];
        let inside = (0..2).all(|k| min[k] + size[k] <= ATLAS);
        let fits = slot.used + texels.len() <= PATCH && slot.patches.len() < PATCHES;
        if inside && fits && !texels.is_empty() {
            slot.texels.write(slot.used * TEXEL, bytemuck::cast_slice(texels));
            let rect = vk::Rect2D {
                offset: vk::Offset2D { x: min[0] as i32, y: min[1] as i32 },
                extent: vk::Extent2D { width: size[0], height: size[1] },
            };
            slot.patches.push((rect, slot.used));
            slot.used += texels.len();
        }
        inside && fits
    }

    /// Takes triangles for the frame that has begun, over those it has: `runs` of `indices` into
    /// `vertices`, on a target of `extent` pixels. Whether there was room for them.
    #[must_use]
    pub fn draw(
        &mut self,
        vertices: &[Vertex],
        indices: &[u32],
        runs: &[Run],
        extent: [u32; 2],
    ) -> bool {
        let slot = &mut self.slots[self.at];
        let fits = vertices.len() <= VERTICES && indices.len() <= INDICES && runs.len() <= RUNS;
        let good = indices.iter().all(|i| (*i as usize) < vertices.len())
            && runs.iter().all(|run| run.indices.end as usize <= indices.len());
        if !fits || !good {
            return false;
        }
        for (i, vertex) in vertices.iter().enumerate() {
            let clip = |k: usize| vertex.position[k] * 2.0 / extent[k].max(1) as f32 - 1.0;
            let place = vertex.texel.map(|texel| texel / ATLAS as f32);
            let vertex = Vertex { position: [clip(0), clip(1)], texel: place, ..*vertex };
            slot.vertices.write(i * size_of::<Vertex>(), bytemuck::bytes_of(&vertex));
        }
        slot.indices.write(0, bytemuck::cast_slice(indices));
        slot.runs.clear();
        slot.runs.extend_from_slice(runs);
        true
    }

    /// Another frame of the ring, whose last use is over.
    pub(super) fn begin(&mut self, at: usize) {
        self.at = at;
        let slot = &mut self.slots[at];
        slot.runs.clear();
        slot.patches.clear();
        slot.used = 0;
    }

    /// Records the copies to the atlas, outside of a pass.
    pub(super) fn record_copies(&mut self, commands: vk::CommandBuffer) {
        let slot = &self.slots[self.at];
        if !self.cleared {
            self.drawing.clear(commands, &self.atlas);
            self.cleared = true;
        }
        if !slot.patches.is_empty() {
            let patches = slot.patches.iter().map(|(rect, at)| (*rect, (at * TEXEL) as u64));
            self.drawing.copy(commands, &self.atlas, slot.texels.raw, patches);
        }
    }

    /// Records the triangles, in the frame's pass.
    pub(super) fn record(&self, commands: vk::CommandBuffer, extent: [u32; 2]) {
        let slot = &self.slots[self.at];
        if !slot.runs.is_empty() {
            let buffers = (slot.vertices.raw, slot.indices.raw);
            self.drawing.draw(commands, buffers, &slot.runs, extent);
        }
    }
}

impl Slot {
    fn new(gpu: &Arc<Gpu>) -> Result<Self, Error> {
        let buffer = |size, usage| Buffer::new(gpu, size, usage);
        Ok(Slot {
            vertices: buffer(VERTICES * size_of::<Vertex>(), vk::BufferUsageFlags::VERTEX_BUFFER)?,
            indices: buffer(INDICES * size_of::<u32>(), vk::BufferUsageFlags::INDEX_BUFFER)?,
            texels: buffer(PATCH * TEXEL, vk::BufferUsageFlags::TRANSFER_SRC)?,
            runs: Vec::with_capacity(RUNS),
            patches: Vec::with_capacity(PATCHES),
            used: 0,
        })
    }
}
