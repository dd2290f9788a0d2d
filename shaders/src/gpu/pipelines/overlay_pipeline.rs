//! The overlay's pipeline and its descriptor set.

use std::sync::Arc;

use ash::vk;

use super::panel::ClippedRun;
use super::programs;
use super::spec::{Blend, PipelineSpec};
use super::vertex_input::VertexInput;
use crate::constants::{BINDING_ATLAS, BINDING_ATLAS_SAMPLER};
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::format::TargetFormat;
use crate::gpu::memory::image::GpuImage;

/// The buffers of a frame's panels.
pub(crate) struct PanelBuffers {
    pub(crate) vertices: vk::Buffer,
    pub(crate) indices: vk::Buffer,
}

/// Texels in a buffer for a rectangle of the atlas.
pub(crate) struct AtlasPatch {
    pub(crate) rect: vk::Rect2D,
    /// Offset in the buffer, in bytes.
    pub(crate) buffer_offset: u64,
}

/// The overlay's pipeline, sampler and descriptor set.
pub(crate) struct OverlayPipeline {
    gpu: Arc<Gpu>,
    sampler: vk::Sampler,
    set_layout: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    pool: vk::DescriptorPool,
    set: vk::DescriptorSet,
    pipeline: vk::Pipeline,
}

impl OverlayPipeline {
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        format: &TargetFormat,
        pass: vk::RenderPass,
        atlas: vk::ImageView,
        cache: vk::PipelineCache,
    ) -> Result<Self, Error> {
        let mut drawing = OverlayPipeline {
            gpu: gpu.clone(),
            sampler: vk::Sampler::null(),
            set_layout: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            pool: vk::DescriptorPool::null(),
            set: vk::DescriptorSet::null(),
            pipeline: vk::Pipeline::null(),
        };
        drawing.create_layout()?;
        drawing.create_set(atlas)?;
        let spec = PipelineSpec {
            vertex: programs::OVERLAY_VERTEX,
            input: VertexInput::Panel,
            fragment: Some(programs::OVERLAY),
            samples: format.sample_count(),
            blend: Some(Blend::Multiplied),
            ..PipelineSpec::for_pass(pass)
        };
        drawing.pipeline = spec.create_pipeline(gpu, cache, drawing.layout)?;
        Ok(drawing)
    }

    fn create_layout(&mut self) -> Result<(), Error> {
        let device = &self.gpu.device;
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(vk::Filter::LINEAR)
            .min_filter(vk::Filter::LINEAR)
            .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE);
        // SAFETY: the info is complete.
        self.sampler = unsafe { device.create_sampler(&info, None) }.could_not("make a sampler")?;
        let binding = |binding, kind| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding)
                .descriptor_type(kind)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::FRAGMENT)
        };
        let bindings = [
            binding(BINDING_ATLAS, vk::DescriptorType::SAMPLED_IMAGE),
            binding(BINDING_ATLAS_SAMPLER, vk::DescriptorType::SAMPLER),
        ];
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the info is complete.
        self.set_layout = unsafe { device.create_descriptor_set_layout(&info, None) }
            .could_not("lay a set out")?;
        let sets = [self.set_layout];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
        // SAFETY: the set layout is this device's.
        self.layout = unsafe { device.create_pipeline_layout(&info, None) }
            .could_not("lay a pipeline out")?;
        Ok(())
    }

    fn create_set(&mut self, atlas: vk::ImageView) -> Result<(), Error> {
        let device = &self.gpu.device;
        let size = |ty| vk::DescriptorPoolSize { ty, descriptor_count: 1 };
        let sizes = [size(vk::DescriptorType::SAMPLED_IMAGE), size(vk::DescriptorType::SAMPLER)];
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        // SAFETY: the info is complete.
        self.pool =
            unsafe { device.create_descriptor_pool(&info, None) }.could_not("make a pool")?;
        let layouts = [self.set_layout];
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool has room for the set.
        self.set = unsafe { device.allocate_descriptor_sets(&info) }.could_not("make a set")?[0];
        let image = [vk::DescriptorImageInfo::default()
            .image_view(atlas)
            .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)];
        let sampler = [vk::DescriptorImageInfo::default().sampler(self.sampler)];
        let write = |binding, kind| {
            vk::WriteDescriptorSet::default()
                .dst_set(self.set)
                .dst_binding(binding)
                .descriptor_type(kind)
        };
        let writes = [
            write(BINDING_ATLAS, vk::DescriptorType::SAMPLED_IMAGE).image_info(&image),
            write(BINDING_ATLAS_SAMPLER, vk::DescriptorType::SAMPLER).image_info(&sampler),
        ];
        // SAFETY: the set is new, and all that it names outlives it.
        unsafe { device.update_descriptor_sets(&writes, &[]) };
        Ok(())
    }

    /// Records draw calls of clipped runs, in the frame's pass; `[width, height]` is the target's size.
    pub(crate) fn record_draws(
        &self,
        commands: vk::CommandBuffer,
        PanelBuffers { vertices, indices }: PanelBuffers,
        runs: &[ClippedRun],
        [width, height]: [u32; 2],
    ) {
        let device = &self.gpu.device;
        let graphics = vk::PipelineBindPoint::GRAPHICS;
        // SAFETY: the pass is the pipeline's; the set and the buffers outlive the frame.
        unsafe {
            device.cmd_bind_pipeline(commands, graphics, self.pipeline);
            let sets = [self.set];
            device.cmd_bind_descriptor_sets(commands, graphics, self.layout, 0, &sets, &[]);
            device.cmd_bind_vertex_buffers(commands, 0, &[vertices], &[0]);
            device.cmd_bind_index_buffer(commands, indices, 0, vk::IndexType::UINT32);
        }
        for ClippedRun { clip: [left, top, right, bottom], indices } in runs {
            let (left, top) = ((*left).min(width), (*top).min(height));
            let (right, bottom) = ((*right).clamp(left, width), (*bottom).clamp(top, height));
            let scissor = vk::Rect2D {
                offset: vk::Offset2D { x: left as i32, y: top as i32 },
                extent: vk::Extent2D { width: right - left, height: bottom - top },
            };
            let count = indices.end.saturating_sub(indices.start);
            // SAFETY: the indices lie within the buffer, and theirs within the vertices'.
            unsafe {
                device.cmd_set_scissor(commands, 0, &[scissor]);
                device.cmd_draw_indexed(commands, count, 1, indices.start, 0, 0);
            }
        }
    }

    /// Records copies of a buffer's texels into the atlas.
    pub(crate) fn record_copies(
        &self,
        commands: vk::CommandBuffer,
        atlas: &GpuImage,
        texel_buffer: vk::Buffer,
        patches: impl Iterator<Item = AtlasPatch>,
    ) {
        let (read, write) =
            (vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL);
        atlas.record_transition(commands, read, write);
        for AtlasPatch { rect, buffer_offset } in patches {
            let vk::Rect2D { offset, extent: vk::Extent2D { width, height } } = rect;
            let copy = vk::BufferImageCopy {
                buffer_offset,
                image_subresource: vk::ImageSubresourceLayers {
                    aspect_mask: vk::ImageAspectFlags::COLOR,
                    layer_count: 1,
                    ..vk::ImageSubresourceLayers::default()
                },
                image_offset: vk::Offset3D { x: offset.x, y: offset.y, z: 0 },
                image_extent: vk::Extent3D { width, height, depth: 1 },
                ..vk::BufferImageCopy::default()
            };
            let device = &self.gpu.device;
            // SAFETY: the atlas is in this layout, and the rectangle within it and the buffer.
            unsafe {
                device.cmd_copy_buffer_to_image(commands, texel_buffer, atlas.raw, write, &[copy]);
            };
        }
        atlas.record_transition(commands, write, read);
    }

    /// Records a clear of the atlas before its first use.
    pub(crate) fn record_clear(&self, commands: vk::CommandBuffer, atlas: &GpuImage) {
        let write = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        atlas.record_transition(commands, vk::ImageLayout::UNDEFINED, write);
        let (image, zero) = (atlas.raw, vk::ClearColorValue::default());
        // SAFETY: the atlas is in this layout, and the range is all of it.
        unsafe {
            let range = [atlas.full_range()];
            self.gpu.device.cmd_clear_color_image(commands, image, write, &zero, &range);
        }
        atlas.record_transition(commands, write, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL);
    }
}

impl Drop for OverlayPipeline {
    fn drop(&mut self) {
        let device = &self.gpu.device;
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe {
            device.destroy_pipeline(self.pipeline, None);
            device.destroy_pipeline_layout(self.layout, None);
            device.destroy_descriptor_pool(self.pool, None);
            device.destroy_descriptor_set_layout(self.set_layout, None);
            device.destroy_sampler(self.sampler, None);
        }
    }
}
