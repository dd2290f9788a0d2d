//! The pipelines, one for each way of drawing something, and the one set of what they read.

use std::sync::Arc;

use ash::vk;

use super::context::Gpu;
use super::error::{Doing, Error};
use super::frame::{Parts, Path};
use super::pass::{Format, Pass};
use super::programs::{self, Program};

/// What kinds of thing the set's bindings are; `wgsl` says which is which.
const BINDINGS: [vk::DescriptorType; 11] = [
    vk::DescriptorType::UNIFORM_BUFFER,
    vk::DescriptorType::SAMPLED_IMAGE,
    vk::DescriptorType::SAMPLED_IMAGE,
    vk::DescriptorType::SAMPLED_IMAGE,
    vk::DescriptorType::SAMPLED_IMAGE,
    vk::DescriptorType::SAMPLER,
    vk::DescriptorType::SAMPLER,
    vk::DescriptorType::SAMPLED_IMAGE,
    vk::DescriptorType::SAMPLED_IMAGE,
    vk::DescriptorType::SAMPLER,
    vk::DescriptorType::SAMPLED_IMAGE,
];

/// The pipelines of a renderer.
pub(super) struct Pipelines {
    gpu: Arc<Gpu>,
    cache: vk::PipelineCache,
    pub(super) set_layout: vk::DescriptorSetLayout,
    pub(super) layout: vk::PipelineLayout,
    /// Where the tiles' rays start, and those of the beams.
    pub(super) starts: [vk::Pipeline; 2],
    fast: vk::Pipeline,
    paper: [vk::Pipeline; 4],
}

/// How a pipeline is made.
struct Recipe {
    vertex: Program,
    fragment: Program,
    pass: vk::RenderPass,
    samples: vk::SampleCountFlags,
    strip: bool,
    cull: vk::CullModeFlags,
    depth: bool,
    coverage: bool,
}

impl Pipelines {
    pub(super) fn new(
        gpu: &Arc<Gpu>,
        format: &Format,
        starts: &Pass,
        frame: &Pass,
        cache: &[u8],
    ) -> Result<Self, Error> {
        let info = vk::PipelineCacheCreateInfo::default().initial_data(cache);
        // SAFETY: a driver checks the data's header and ignores what isn't its own.
        let cache =
            unsafe { gpu.device.create_pipeline_cache(&info, None) }.doing("make a cache")?;
        let null = vk::Pipeline::null();
        let mut all = Pipelines {
            gpu: gpu.clone(),
            cache,
            set_layout: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            starts: [null; 2],
            fast: null,
            paper: [null; 4],
        };
        all.make_layouts()?;
        let one = vk::SampleCountFlags::TYPE_1;
        let none = vk::CullModeFlags::NONE;
        let tiles = Recipe {
            vertex: programs::TILES_VERTEX,
            fragment: programs::TILES,
            pass: starts.raw,
            samples: one,
            strip: false,
            cull: none,
            depth: false,
            coverage: false,
        };
        let beams = Recipe {
            vertex: programs::BEAMS_VERTEX,
            fragment: programs::BEAMS,
            strip: true,
            ..tiles
        };
        all.starts = [all.make(&tiles)?, all.make(&beams)?];
        let coverage = format.samples > 1;
        let drawn = Recipe {
            vertex: programs::TILE_VERTEX,
            fragment: fast_program(gpu.needs.half, coverage),
            pass: frame.raw,
            samples: format.count(),
            strip: true,
            cull: none,
            depth: true,
            coverage,
        };
        all.fast = all.make(&drawn)?;
        let paper = [
            programs::PAPER,
            programs::PAPER_FULL_MARCH,
            programs::PAPER_NO_SDF,
            programs::PAPER_NO_SHADING,
        ];
        for (i, fragment) in paper.into_iter().enumerate() {
            all.paper[i] = all.make(&Recipe {
                vertex: programs::BOX_VERTEX,
                fragment,
                cull: vk::CullModeFlags::BACK,
                coverage: false,
                ..drawn
            })?;
        }
        Ok(all)
    }

    /// The pipeline of a path.
    pub(super) const fn sculpture(&self, path: Path) -> vk::Pipeline {
        match path {
            Path::Fast => self.fast,
            Path::Paper(Parts::Whole) => self.paper[0],
            Path::Paper(Parts::FullMarch) => self.paper[1],
            Path::Paper(Parts::NoSdf) => self.paper[2],
            Path::Paper(Parts::NoShading) => self.paper[3],
        }
    }

    /// What a driver wants to find again at the next start.
    pub(super) fn cache(&self) -> Result<Vec<u8>, Error> {
        // SAFETY: the cache is this device's.
        unsafe { self.gpu.device.get_pipeline_cache_data(self.cache) }.doing("read the cache")
    }

    fn make_layouts(&mut self) -> Result<(), Error> {
        let device = &self.gpu.device;
        let both = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
        let mut bindings = [vk::DescriptorSetLayoutBinding::default(); BINDINGS.len()];
        for (i, (binding, kind)) in bindings.iter_mut().zip(BINDINGS).enumerate() {
            *binding = binding
                .binding(i as u32)
                .descriptor_type(kind)
                .descriptor_count(1)
                .stage_flags(both);
        }
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

    fn make(&self, recipe: &Recipe) -> Result<vk::Pipeline, Error> {
        let modules =
            [Module::new(&self.gpu, recipe.vertex)?, Module::new(&self.gpu, recipe.fragment)?];
        let stage = |i: usize, stage, name| {
            vk::PipelineShaderStageCreateInfo::default()
                .stage(stage)
                .module(modules[i].raw)
                .name(name)
        };
        let stages = [
            stage(0, vk::ShaderStageFlags::VERTEX, c"vertex"),
            stage(1, vk::ShaderStageFlags::FRAGMENT, c"fragment"),
        ];
        let vertices = vk::PipelineVertexInputStateCreateInfo::default();
        let assembly =
            vk::PipelineInputAssemblyStateCreateInfo::default().topology(if recipe.strip {
                vk::PrimitiveTopology::TRIANGLE_STRIP
            } else {
                vk::PrimitiveTopology::TRIANGLE_LIST
            });
        let viewport =
            vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        let raster = vk::PipelineRasterizationStateCreateInfo::default()
            .cull_mode(recipe.cull)
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .line_width(1.0);
        let samples = vk::PipelineMultisampleStateCreateInfo::default()
            .rasterization_samples(recipe.samples)
            .alpha_to_coverage_enable(recipe.coverage);
        // Depth is 1 on the near plane.
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(recipe.depth)
            .depth_write_enable(recipe.depth)
            .depth_compare_op(vk::CompareOp::GREATER_OR_EQUAL);
        let targets = [vk::PipelineColorBlendAttachmentState::default()
            .color_write_mask(vk::ColorComponentFlags::RGBA)];
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
            .render_pass(recipe.pass);
        // SAFETY: all that `info` points to lives until the call returns.
        let made = unsafe { self.gpu.device.create_graphics_pipelines(self.cache, &[info], None) };
        match made {
            Ok(pipelines) => Ok(pipelines[0]),
            Err((_, result)) => Err(Error::Call { doing: "make a pipeline", result }),
        }
    }
}

impl Drop for Pipelines {
    fn drop(&mut self) {
        let device = &self.gpu.device;
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe {
            for pipeline in self.paper.into_iter().chain([self.fast]).chain(self.starts) {
                device.destroy_pipeline(pipeline, None);
            }
            device.destroy_pipeline_layout(self.layout, None);
            device.destroy_descriptor_set_layout(self.set_layout, None);
            device.destroy_pipeline_cache(self.cache, None);
        }
    }
}

const fn fast_program(half: bool, coverage: bool) -> Program {
    match (half, coverage) {
        (true, true) => programs::FAST_HALF_COVERAGE,
        (true, false) => programs::FAST_HALF,
        (false, true) => programs::FAST_COVERAGE,
        (false, false) => programs::FAST,
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
