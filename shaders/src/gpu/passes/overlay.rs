//! 2D overlay for panels and text: coloured triangles and a glyph atlas, drawn last in the frame's pass.
//! The shell lays out the text.

use std::sync::Arc;

use ash::vk;

use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::Error;
use crate::gpu::device::format::TargetFormat;
use crate::gpu::memory::buffer::Buffer;
use crate::gpu::memory::image::{GpuImage, ImageSpec};
use crate::gpu::pipelines::overlay_pipeline::{AtlasPatch, OverlayPipeline, PanelBuffers};
pub use crate::gpu::pipelines::panel::{ClippedRun, PanelVertex};

/// Side of the atlas in texels: enough for a few hundred glyphs at twice the usual scale.
pub const ATLAS_SIDE: u32 = 1024;
/// Most vertices of a frame: a screen full of text.
pub const MAX_VERTICES: usize = 32_768;
/// Most indices of a frame, three for a triangle.
pub const MAX_INDICES: usize = 3 * MAX_VERTICES;
/// Most clipped runs of a frame.
pub const MAX_RUNS: usize = 512;
/// Most atlas texels written in a frame: a quarter of the atlas.
pub const MAX_FRAME_TEXELS: usize = (ATLAS_SIDE * ATLAS_SIDE / 4) as usize;

/// Most rectangles of the atlas written in a frame.
const PATCHES: usize = 64;
const TEXEL: usize = 4;

/// The overlay's pipeline, atlas, and buffers for each frame of the ring. Allocates only when created.
pub struct Overlay {
    pipeline: OverlayPipeline,
    atlas: GpuImage,
    slots: Vec<OverlaySlot>,
    slot_index: usize,
    cleared: bool,
}

/// The buffers of one frame of the ring.
struct OverlaySlot {
    vertices: Buffer,
    indices: Buffer,
    texels: Buffer,
    runs: Vec<ClippedRun>,
    /// Rectangles of the atlas, and the index in `texels` at which each begins.
    patches: Vec<(vk::Rect2D, usize)>,
    used: usize,
}

impl Overlay {
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        format: &TargetFormat,
        pass: vk::RenderPass,
        frames_in_flight: usize,
        cache: vk::PipelineCache,
    ) -> Result<Self, Error> {
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
        let shape =
            ImageSpec::new_2d(vk::Format::R8G8B8A8_UNORM, [ATLAS_SIDE; 2], 1).with_usage(usage);
        let atlas = GpuImage::new(gpu, shape)?;
        let pipeline = OverlayPipeline::new(gpu, format, pass, atlas.view, cache)?;
        let slots =
            (0..frames_in_flight).map(|_| OverlaySlot::new(gpu)).collect::<Result<_, _>>()?;
        Ok(Overlay { pipeline, atlas, slots, slot_index: 0, cleared: false })
    }

    /// Stages texels for a rectangle of the atlas, row by row, premultiplied RGBA. Returns `false`, without
    /// effect, if the rectangle lies outside of the atlas or the current frame has no room.
    #[must_use]
    pub fn try_stage_atlas_patch(
        &mut self,
        first_texel: [u32; 2],
        extent: [u32; 2],
        texels: &[[u8; 4]],
    ) -> bool {
        debug_assert_eq!(texels.len() as u32, extent[0] * extent[1], "a rectangle's texels");
        let slot = &mut self.slots[self.slot_index];
        let inside = (0..2).all(|k| first_texel[k] + extent[k] <= ATLAS_SIDE);
        let fits = slot.used + texels.len() <= MAX_FRAME_TEXELS && slot.patches.len() < PATCHES;
        if inside && fits && !texels.is_empty() {
            slot.texels.write(slot.used * TEXEL, bytemuck::cast_slice(texels));
            let rect = vk::Rect2D {
                offset: vk::Offset2D { x: first_texel[0] as i32, y: first_texel[1] as i32 },
                extent: vk::Extent2D { width: extent[0], height: extent[1] },
            };
            slot.patches.push((rect, slot.used));
            slot.used += texels.len();
        }
        inside && fits
    }

    /// Sets the triangles of the current frame, replacing earlier ones: `runs` of `indices` into
    /// `vertices`, on a target of `target_extent` pixels. Returns `false`, without effect, if there are too
    /// many or an index is out of range.
    #[must_use]
    pub fn try_set_triangles(
        &mut self,
        vertices: &[PanelVertex],
        indices: &[u32],
        runs: &[ClippedRun],
        target_extent: [u32; 2],
    ) -> bool {
        let slot = &mut self.slots[self.slot_index];
        let fits = vertices.len() <= MAX_VERTICES
            && indices.len() <= MAX_INDICES
            && runs.len() <= MAX_RUNS;
        let good = indices.iter().all(|i| (*i as usize) < vertices.len())
            && runs.iter().all(|run| run.indices.end as usize <= indices.len());
        if !fits || !good {
            return false;
        }
        for (i, vertex) in vertices.iter().enumerate() {
            let clip = |k: usize| vertex.position[k] * 2.0 / target_extent[k].max(1) as f32 - 1.0;
            let place = vertex.texel.map(|texel| texel / ATLAS_SIDE as f32);
            let vertex = PanelVertex { position: [clip(0), clip(1)], texel: place, ..*vertex };
            slot.vertices.write(i * size_of::<PanelVertex>(), bytemuck::bytes_of(&vertex));
        }
        slot.indices.write(0, bytemuck::cast_slice(indices));
        slot.runs.clear();
        slot.runs.extend_from_slice(runs);
        true
    }

    /// Starts frame `slot_index` of the ring, whose last use is over, and empties it.
    pub(crate) fn begin_frame(&mut self, slot_index: usize) {
        self.slot_index = slot_index;
        let slot = &mut self.slots[slot_index];
        slot.runs.clear();
        slot.patches.clear();
        slot.used = 0;
    }

    /// Records the copies to the atlas, outside of a render pass.
    pub(crate) fn record_atlas_copies(&mut self, commands: vk::CommandBuffer) {
        let slot = &self.slots[self.slot_index];
        if !self.cleared {
            self.pipeline.record_clear(commands, &self.atlas);
            self.cleared = true;
        }
        if !slot.patches.is_empty() {
            let patches = slot.patches.iter().map(|(rect, first_texel)| AtlasPatch {
                rect: *rect,
                buffer_offset: (first_texel * TEXEL) as u64,
            });
            self.pipeline.record_copies(commands, &self.atlas, slot.texels.raw, patches);
        }
    }

    /// Records the draw calls, in the frame's pass.
    pub(crate) fn record_draws(&self, commands: vk::CommandBuffer, target_extent: [u32; 2]) {
        let slot = &self.slots[self.slot_index];
        if !slot.runs.is_empty() {
            let buffers = PanelBuffers { vertices: slot.vertices.raw, indices: slot.indices.raw };
            self.pipeline.record_draws(commands, buffers, &slot.runs, target_extent);
        }
    }
}

impl OverlaySlot {
    fn new(gpu: &Arc<Gpu>) -> Result<Self, Error> {
        let buffer = |size, usage| Buffer::new(gpu, size, usage);
        Ok(OverlaySlot {
            vertices: buffer(
                MAX_VERTICES * size_of::<PanelVertex>(),
                vk::BufferUsageFlags::VERTEX_BUFFER,
            )?,
            indices: buffer(MAX_INDICES * size_of::<u32>(), vk::BufferUsageFlags::INDEX_BUFFER)?,
            texels: buffer(MAX_FRAME_TEXELS * TEXEL, vk::BufferUsageFlags::TRANSFER_SRC)?,
            runs: Vec::with_capacity(MAX_RUNS),
            patches: Vec::with_capacity(PATCHES),
            used: 0,
        })
    }
}
