//! The overlay's pipeline, and the one set that it reads.

use std::sync::Arc;

use ash::vk;

use super::super::context::Gpu;
use super::super::error::{Doing, Error};
use super::super::image::Image;
use super::super::pass::{Format, Pass};
use super::super::programs;
use super::super::recipe::Module;
use super::{Run, Vertex};

/// How triangles over a frame are drawn.
pub(super) struct Drawing {
    gpu: Arc<Gpu>,
    sampler: vk::Sampler,
    set_layout: vk::DescriptorSetLayout,
    layout: vk::PipelineLayout,
    pool: vk::DescriptorPool,
    set: vk::DescriptorSet,
    pipeline: vk::Pipeline,
}

impl Drawing {
    pub(super) fn new(
        gpu: &Arc<Gpu>,
        format: &Format,
        pass: &Pass,
        atlas: vk::ImageView,
    ) -> Result<Self, Error> {
        let mut drawing = Drawing {
            gpu: gpu.clone(),
            sampler: vk::Sampler::null(),
            set_layout: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            pool: vk::DescriptorPool::null(),
            set: vk::DescriptorSet::null(),
            pipeline: vk::Pipeline::null(),
        };
        drawing.make_layout()?;
        drawing.make_set(atlas)?;
        drawing.pipeline = drawing.make_pipeline(format, pass)?;
        Ok(drawing)
    }

    fn make_layout(&mut self) -> Result<(), Error> {
        let device = &self.gpu.device;
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(vk::Filter::LINEAR)
            .min_filter(vk::Filter::LINEAR)
            .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE);
        // SAFETY: the info is complete.
        self.sampler = unsafe { device.create_sampler(&info, None) }.doing("make a sampler")?;
        let binding = |binding, kind| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(binding)
                .descriptor_type(kind)
                .descriptor_count(1)
                .stage_flags(vk::ShaderStageFlags::FRAGMENT)
        };
        let bindings = [
            binding(0, vk::DescriptorType::SAMPLED_IMAGE),
            binding(1, vk::DescriptorType::SAMPLER),
        ];
        let info = vk::DescriptorSetLayoutCreateInfo::default().bindings(&bindings);
        // SAFETY: the info is complete.
        self.set_layout =
            unsafe { device.create_descriptor_set_layout(&info, None) }.doing("lay a set out")?;
        let sets = [self.set_layout];
        let info = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
        // SAFETY: the set layout is this device's.
        self.layout =
            unsafe { device.create_pipeline_layout(&info, None) }.doing("lay a pipeline out")?;
        Ok(())
    }

    fn make_set(&mut self, atlas: vk::ImageView) -> Result<(), Error> {
        let device = &self.gpu.device;
        let size = |ty| vk::DescriptorPoolSize { ty, descriptor_count: 1 };
        let sizes = [size(vk::DescriptorType::SAMPLED_IMAGE), size(vk::DescriptorType::SAMPLER)];
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(1).pool_sizes(&sizes);
        // SAFETY: the info is complete.
        self.pool = unsafe { device.create_descriptor_pool(&info, None) }.doing("make a pool")?;
        let layouts = [self.set_layout];
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool has room for the set.
        self.set = unsafe { device.allocate_descriptor_sets(&info) }.doing("make a set")?[0];
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
            write(0, vk::DescriptorType::SAMPLED_IMAGE).image_info(&image),
            write(1, vk::DescriptorType::SAMPLER).image_info(&sampler),
        ];
        // SAFETY: the set is new, and all that it names outlives it.
        unsafe { device.update_descriptor_sets(&writes, &[]) };
        Ok(())
    }

    fn make_pipeline(&self, format: &Format, pass: &Pass) -> Result<vk::Pipeline, Error> {
        let vertex = Module::new(&self.gpu, programs::OVERLAY_VERTEX)?;
        let fragment = Module::new(&self.gpu, programs::OVERLAY)?;
        let stage = |stage, module: &Module<'_>, name| {
            vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module.raw).name(name)
        };
        let stages = [
            stage(vk::ShaderStageFlags::VERTEX, &vertex, c"vertex"),
            stage(vk::ShaderStageFlags::FRAGMENT, &fragment, c"fragment"),
        ];
        let attributes = attributes();
        let bindings = [vk::VertexInputBindingDescription {
            binding: 0,
            stride: size_of::<Vertex>() as u32,
            input_rate: vk::VertexInputRate::VERTEX,
        }];
        let vertices = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&bindings)
            .vertex_attribute_descriptions(&attributes);
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default()
            .topology(vk::PrimitiveTopology::TRIANGLE_LIST);
        let viewport =
            vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default().line_width(1.0);
        let samples =
            vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(format.count());
        let depth = vk::PipelineDepthStencilStateCreateInfo::default();
        let targets = [over()];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(&targets);
        let dynamic = [vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR];
        let dynamic = vk::PipelineDynamicStateCreateInfo::default().dynamic_states(&dynamic);
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&vertices)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&samples)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(self.layout)
            .render_pass(pass.raw);
        let cache = vk::PipelineCache::null();
        // SAFETY: all that `info` points to lives until the call returns.
        match unsafe { self.gpu.device.create_graphics_pipelines(cache, &[info], None) } {
            Ok(pipelines) => Ok(pipelines[0]),
            Err((_, result)) => Err(Error::Call { doing: "make a pipeline", result }),
        }
    }

    /// Draws runs of triangles, in the frame's pass.
    pub(super) fn draw(
        &self,
        commands: vk::CommandBuffer,
        (vertices, indices): (vk::Buffer, vk::Buffer),
        runs: &[Run],
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
        for Run { clip: [left, top, right, bottom], indices } in runs {
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

    /// Copies rectangles of texels, each from a place in a buffer, into the atlas.
    pub(super) fn copy(
        &self,
        commands: vk::CommandBuffer,
        atlas: &Image,
        from: vk::Buffer,
        patches: impl Iterator<Item = (vk::Rect2D, u64)>,
    ) {
        let (read, write) =
            (vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL, vk::ImageLayout::TRANSFER_DST_OPTIMAL);
        self.turn(commands, atlas, read, write);
        for (rect, at) in patches {
            let vk::Rect2D { offset, extent: vk::Extent2D { width, height } } = rect;
            let copy = vk::BufferImageCopy {
                buffer_offset: at,
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
            unsafe { device.cmd_copy_buffer_to_image(commands, from, atlas.raw, write, &[copy]) };
        }
        self.turn(commands, atlas, write, read);
    }

    /// Empties the atlas, which nothing has used yet.
    pub(super) fn clear(&self, commands: vk::CommandBuffer, atlas: &Image) {
        let write = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        self.turn(commands, atlas, vk::ImageLayout::UNDEFINED, write);
        let (image, zero) = (atlas.raw, vk::ClearColorValue::default());
        // SAFETY: the atlas is in this layout, and the range is all of it.
        unsafe {
            let range = [atlas.range()];
            self.gpu.device.cmd_clear_color_image(commands, image, write, &zero, &range);
        }
        self.turn(commands, atlas, write, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL);
    }

    fn turn(
        &self,
        commands: vk::CommandBuffer,
        atlas: &Image,
        from: vk::ImageLayout,
        to: vk::ImageLayout,
    ) {
        let use_of = |layout| match layout {
            vk::ImageLayout::TRANSFER_DST_OPTIMAL => {
                (vk::PipelineStageFlags::TRANSFER, vk::AccessFlags::TRANSFER_WRITE)
            }
            vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL => {
                (vk::PipelineStageFlags::FRAGMENT_SHADER, vk::AccessFlags::SHADER_READ)
            }
            _ => (vk::PipelineStageFlags::TOP_OF_PIPE, vk::AccessFlags::empty()),
        };
        let ((from_stage, from_access), (to_stage, to_access)) = (use_of(from), use_of(to));
        let barrier = [vk::ImageMemoryBarrier::default()
            .image(atlas.raw)
            .subresource_range(atlas.range())
            .old_layout(from)
            .new_layout(to)
            .src_access_mask(from_access)
            .dst_access_mask(to_access)
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED)];
        let none = vk::DependencyFlags::empty();
        let device = &self.gpu.device;
        // SAFETY: the atlas is in the layout `from` at this point.
        unsafe {
            device.cmd_pipeline_barrier(commands, from_stage, to_stage, none, &[], &[], &barrier);
        }
    }
}

impl Drop for Drawing {
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

/// Where the vertices' parts are.
fn attributes() -> [vk::VertexInputAttributeDescription; 3] {
    let attribute = |location, format, offset: usize| vk::VertexInputAttributeDescription {
        location,
        binding: 0,
        format,
        offset: offset as u32,
    };
    [
        attribute(0, vk::Format::R32G32_SFLOAT, core::mem::offset_of!(Vertex, position)),
        attribute(1, vk::Format::R32G32_SFLOAT, core::mem::offset_of!(Vertex, texel)),
        attribute(2, vk::Format::R8G8B8A8_UNORM, core::mem::offset_of!(Vertex, color)),
    ]
}

/// Over what is there, with alpha multiplied in.
fn over() -> vk::PipelineColorBlendAttachmentState {
    let (source, target) = (vk::BlendFactor::ONE, vk::BlendFactor::ONE_MINUS_SRC_ALPHA);
    vk::PipelineColorBlendAttachmentState::default()
        .blend_enable(true)
        .src_color_blend_factor(source)
        .dst_color_blend_factor(target)
        .src_alpha_blend_factor(source)
        .dst_alpha_blend_factor(target)
        .color_write_mask(vk::ColorComponentFlags::RGBA)
}
