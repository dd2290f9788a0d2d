//! How a pipeline is made of programs and of what is fixed around them.

use ash::vk;

use super::context::Gpu;
use super::error::{Doing, Error};
use super::overlay;
use super::pass::Pass;
use super::programs::{self, Program};
use crate::scene::{Instance, Vertex};

/// What a vertex program takes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Input {
    /// The vertex's number.
    Number,
    /// A mesh's vertices and instances.
    Mesh,
    /// Of those, where they are.
    Places,
    /// A panel's corners.
    Panel,
}

/// How colours are mixed by alpha.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Blend {
    /// Colours as they are.
    Alpha,
    /// Alpha is multiplied in already.
    Multiplied,
}

/// How a pipeline is made.
#[derive(Clone, Copy)]
pub(super) struct Recipe {
    pub(super) vertex: Program,
    pub(super) input: Input,
    /// None where depth is as the vertices have it.
    pub(super) fragment: Option<Program>,
    pub(super) pass: vk::RenderPass,
    pub(super) samples: vk::SampleCountFlags,
    pub(super) strip: bool,
    pub(super) cull: vk::CullModeFlags,
    /// Whether there is a depth test, and how; else depth is left alone.
    pub(super) depth: Option<vk::CompareOp>,
    /// How what is drawn is mixed with what is there, whose depth it then keeps.
    pub(super) blend: Option<Blend>,
    /// Whether alpha is coverage.
    pub(super) coverage: bool,
    /// Whether there is a picture; else depth alone is drawn.
    pub(super) color: bool,
    /// Whether depths are moved away by their slope, for a map of shadows.
    pub(super) bias: bool,
}

/// Location, format and offset of what a mesh's vertex has, a panel's corner, and an instance.
const VERTEX: [(u32, vk::Format, u32); 3] = [
    (0, vk::Format::R32G32B32_SFLOAT, 0),
    (1, vk::Format::R8G8B8A8_SNORM, 12),
    (2, vk::Format::R8G8B8A8_UNORM, 16),
];
const PANEL: [(u32, vk::Format, u32); 3] = [
    (0, vk::Format::R32G32_SFLOAT, 0),
    (1, vk::Format::R32G32_SFLOAT, 8),
    (2, vk::Format::R8G8B8A8_UNORM, 16),
];
const INSTANCE: [(u32, vk::Format, u32); 4] = [
    (3, vk::Format::R32G32B32A32_SFLOAT, 0),
    (4, vk::Format::R32G32B32A32_SFLOAT, 16),
    (5, vk::Format::R32G32B32A32_SFLOAT, 32),
    (6, vk::Format::R32G32B32A32_SFLOAT, 48),
];

impl Input {
    fn bindings(self) -> Vec<vk::VertexInputBindingDescription> {
        let binding = |binding, stride: usize, input_rate| vk::VertexInputBindingDescription {
            binding,
            stride: stride as u32,
            input_rate,
        };
        match self {
            Input::Number => Vec::new(),
            Input::Panel => {
                vec![binding(0, size_of::<overlay::Vertex>(), vk::VertexInputRate::VERTEX)]
            }
            Input::Mesh | Input::Places => vec![
                binding(0, size_of::<Vertex>(), vk::VertexInputRate::VERTEX),
                binding(1, size_of::<Instance>(), vk::VertexInputRate::INSTANCE),
            ],
        }
    }

    fn attributes(self) -> Vec<vk::VertexInputAttributeDescription> {
        let (vertex, instance) = match self {
            Input::Number => (&VERTEX[..0], &INSTANCE[..0]),
            Input::Panel => (&PANEL[..], &INSTANCE[..0]),
            Input::Mesh => (&VERTEX[..], &INSTANCE[..]),
            Input::Places => (&VERTEX[..1], &INSTANCE[..3]),
        };
        let of = |binding| {
            move |&(location, format, offset): &(u32, vk::Format, u32)| {
                vk::VertexInputAttributeDescription { location, binding, format, offset }
            }
        };
        vertex.iter().map(of(0)).chain(instance.iter().map(of(1))).collect()
    }
}

impl Recipe {
    /// For a pass without depth, vertices made from their numbers; programs yet to come.
    pub(super) fn plain(pass: &Pass) -> Self {
        Recipe {
            vertex: programs::TILES_VERTEX,
            input: Input::Number,
            fragment: None,
            pass: pass.raw,
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

    /// The pipeline.
    pub(super) fn make(
        &self,
        gpu: &Gpu,
        cache: vk::PipelineCache,
        layout: vk::PipelineLayout,
    ) -> Result<vk::Pipeline, Error> {
        let vertex = Module::new(gpu, self.vertex)?;
        let fragment = self.fragment.map(|program| Module::new(gpu, program)).transpose()?;
        let stage = |module: &Module<'_>, stage, name| {
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
        let (raster, samples, depth) = (self.raster(), self.multisample(), self.depth());
        let targets = [self.target()];
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
            Err((_, result)) => Err(Error::Call { doing: "make a pipeline", result }),
        }
    }

    fn raster(&self) -> vk::PipelineRasterizationStateCreateInfo<'static> {
        vk::PipelineRasterizationStateCreateInfo::default()
            .cull_mode(self.cull)
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .depth_bias_enable(self.bias)
            .depth_bias_slope_factor(1.5)
            .depth_bias_constant_factor(2.0)
            .line_width(1.0)
    }

    fn multisample(&self) -> vk::PipelineMultisampleStateCreateInfo<'static> {
        vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(self.samples)
            .alpha_to_coverage_enable(self.coverage)
    }

    fn depth(&self) -> vk::PipelineDepthStencilStateCreateInfo<'static> {
        vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(self.depth.is_some())
            .depth_write_enable(self.depth.is_some() && self.blend.is_none())
            .depth_compare_op(self.depth.unwrap_or(vk::CompareOp::ALWAYS))
    }

    fn target(&self) -> vk::PipelineColorBlendAttachmentState {
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

/// A program while pipelines are made of it.
pub(super) struct Module<'a> {
    gpu: &'a Gpu,
    pub(super) raw: vk::ShaderModule,
}

impl<'a> Module<'a> {
    pub(super) fn new(gpu: &'a Gpu, program: Program) -> Result<Self, Error> {
        let words = program.words();
        let info = vk::ShaderModuleCreateInfo::default().code(&words);
        // SAFETY: the words are a program that the build validated.
        let raw = unsafe { gpu.device.create_shader_module(&info, None) }.doing(program.name)?;
        Ok(Module { gpu, raw })
    }
}

impl Drop for Module<'_> {
    fn drop(&mut self) {
        // SAFETY: pipelines don't need their modules once they are made.
        unsafe { self.gpu.device.destroy_shader_module(self.raw, None) };
    }
}
