//! Graphics pipeline creation from programs and fixed-function state.

use ash::vk;

use super::programs::{self, ShaderProgram};
use super::vertex_input::VertexInput;
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};

/// Alpha blending of colours.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Blend {
    /// Straight alpha.
    Alpha,
    /// Premultiplied alpha.
    Multiplied,
}

/// Programs and fixed-function state of a graphics pipeline.
#[derive(Clone, Copy)]
pub(crate) struct PipelineSpec {
    pub(crate) vertex: ShaderProgram,
    pub(crate) input: VertexInput,
    /// `None` for depth-only rendering without a fragment program.
    pub(crate) fragment: Option<ShaderProgram>,
    pub(crate) pass: vk::RenderPass,
    pub(crate) samples: vk::SampleCountFlags,
    pub(crate) strip: bool,
    pub(crate) cull: vk::CullModeFlags,
    /// Depth test; `None` disables test and writes.
    pub(crate) depth: Option<vk::CompareOp>,
    /// Blending; it disables depth writes.
    pub(crate) blend: Option<Blend>,
    /// `true` to convert alpha to sample coverage.
    pub(crate) coverage: bool,
    /// `true` if there is a colour attachment.
    pub(crate) color: bool,
    /// `true` to enable depth bias, for the shadow map.
    pub(crate) bias: bool,
}

impl PipelineSpec {
    /// Returns the defaults for a pass: triangle list, no vertex buffers, no depth, no blending, no
    /// culling.
    pub(crate) fn for_pass(pass: vk::RenderPass) -> Self {
        PipelineSpec {
            vertex: programs::TILES_VERTEX,
            input: VertexInput::VertexIndex,
            fragment: None,
            pass,
            samples: vk::SampleCountFlags::TYPE_1,
            strip: false,
            cull: vk::CullModeFlags::NONE,
            depth: None,
            blend: None,
            coverage: false,
            color: true,
            bias: false,
        }
    }

    /// Creates the pipeline.
    pub(crate) fn create_pipeline(
        &self,
        gpu: &Gpu,
        cache: vk::PipelineCache,
        layout: vk::PipelineLayout,
    ) -> Result<vk::Pipeline, Error> {
        let vertex = ShaderModule::new(gpu, self.vertex)?;
        let fragment = self.fragment.map(|program| ShaderModule::new(gpu, program)).transpose()?;
        let stage = |module: &ShaderModule<'_>, stage, name| {
            let info = vk::PipelineShaderStageCreateInfo::default();
            info.stage(stage).module(module.raw).name(name)
        };
        let mut stages = vec![stage(&vertex, vk::ShaderStageFlags::VERTEX, c"vertex")];
        if let Some(module) = &fragment {
            stages.push(stage(module, vk::ShaderStageFlags::FRAGMENT, c"fragment"));
        }
        let (bindings, attributes) = (self.input.bindings(), self.input.attributes());
        let vertices = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&bindings)
            .vertex_attribute_descriptions(&attributes);
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(match self.strip {
                true => vk::PrimitiveTopology::TRIANGLE_STRIP,
                false => vk::PrimitiveTopology::TRIANGLE_LIST,
            });
        let viewport =
            vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let (raster, samples, depth) =
            (self.rasterization_state(), self.multisample_state(), self.depth_stencil_state());
        let targets = [self.blend_attachment()];
        let targets = if self.color { &targets[..] } else { &[] };
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(targets);
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
            .layout(layout)
            .render_pass(self.pass);
        // SAFETY: all that `info` points to lives until the call returns.
        let made = unsafe { gpu.device.create_graphics_pipelines(cache, &[info], None) };
        match made {
            Ok(pipelines) => Ok(pipelines[0]),
            Err((_, result)) => Err(Error::Call { action: "make a pipeline", result }),
        }
    }

    fn rasterization_state(&self) -> vk::PipelineRasterizationStateCreateInfo<'static> {
        vk::PipelineRasterizationStateCreateInfo::default()
            .cull_mode(self.cull)
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .depth_bias_enable(self.bias)
            .depth_bias_slope_factor(1.5)
            .depth_bias_constant_factor(2.0)
            .line_width(1.0)
    }

    fn multisample_state(&self) -> vk::PipelineMultisampleStateCreateInfo<'static> {
        vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(self.samples)
            .alpha_to_coverage_enable(self.coverage)
    }

    fn depth_stencil_state(&self) -> vk::PipelineDepthStencilStateCreateInfo<'static> {
        vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(self.depth.is_some())
            .depth_write_enable(self.depth.is_some() && self.blend.is_none())
            .depth_compare_op(self.depth.unwrap_or(vk::CompareOp::ALWAYS))
    }

    fn blend_attachment(&self) -> vk::PipelineColorBlendAttachmentState {
        let source = match self.blend {
            Some(Blend::Multiplied) => vk::BlendFactor::ONE,
            Some(Blend::Alpha) | None => vk::BlendFactor::SRC_ALPHA,
        };
        vk::PipelineColorBlendAttachmentState::default()
            .color_write_mask(vk::ColorComponentFlags::RGBA)
            .blend_enable(self.blend.is_some())
            .src_color_blend_factor(source)
            .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
            .src_alpha_blend_factor(vk::BlendFactor::ONE)
            .dst_alpha_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
    }
}

/// A shader module, destroyed on drop.
pub(crate) struct ShaderModule<'a> {
    gpu: &'a Gpu,
    pub(crate) raw: vk::ShaderModule,
}

impl<'a> ShaderModule<'a> {
    pub(crate) fn new(gpu: &'a Gpu, program: ShaderProgram) -> Result<Self, Error> {
        let words = program.words();
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the words are a program that the build validated.
        let raw =
            unsafe { gpu.device.create_shader_module(&info, None) }.could_not(program.name)?;
        Ok(ShaderModule { gpu, raw })
    }
}

impl Drop for ShaderModule<'_> {
    fn drop(&mut self) {
        // SAFETY: pipelines don't need their modules once they are made.
        unsafe { self.gpu.device.destroy_shader_module(self.raw, None) };
    }
}
