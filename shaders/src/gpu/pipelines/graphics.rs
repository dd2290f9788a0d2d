//! The graphics pipelines, and the layout of the one descriptor set that they share.

use std::sync::Arc;

use ash::vk;

use super::paths::{PaperVariant, RenderPath};
use super::programs::{self, ShaderProgram};
use super::spec::{Blend, PipelineSpec};
use super::vertex_input::VertexInput;
use crate::constants::{
    BINDING_CLAMPED, BINDING_COUNT, BINDING_DEPTH_COMPARE, BINDING_FRAME, BINDING_NEAREST,
    BINDING_REPEAT,
};
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::format::TargetFormat;
use crate::upload::VolumeFormat;

/// Descriptor types by binding, as the WGSL modules declare them.
pub(crate) const BINDING_TYPES: [vk::DescriptorType; BINDING_COUNT as usize] = {
    let mut types = [vk::DescriptorType::SAMPLED_IMAGE; BINDING_COUNT as usize];
    types[BINDING_FRAME as usize] = vk::DescriptorType::UNIFORM_BUFFER;
    let samplers = [BINDING_CLAMPED, BINDING_NEAREST, BINDING_REPEAT, BINDING_DEPTH_COMPARE];
    let mut i = 0;
    while i < samplers.len() {
        types[samplers[i] as usize] = vk::DescriptorType::SAMPLER;
        i += 1;
    }
    types
};

/// The graphics pipelines of a renderer.
pub(crate) struct Pipelines {
    gpu: Arc<Gpu>,
    pub(crate) cache: vk::PipelineCache,
    pub(crate) set_layout: vk::DescriptorSetLayout,
    pub(crate) layout: vk::PipelineLayout,
    /// March starts of tiles, and of beams.
    pub(crate) march_starts: [vk::Pipeline; 2],
    fast: vk::Pipeline,
    paper: [vk::Pipeline; 4],
    /// Scene meshes, particles, and what is seen where something hides it.
    pub(crate) meshes: vk::Pipeline,
    pub(crate) particles: vk::Pipeline,
    pub(crate) hidden: vk::Pipeline,
    /// Shadow casters: scene meshes, and the sculpture.
    pub(crate) shadow_casters: [vk::Pipeline; 2],
}

/// The render passes that the pipelines are for.
pub(crate) struct PassHandles {
    pub(crate) march_starts: vk::RenderPass,
    pub(crate) shadow: vk::RenderPass,
    pub(crate) frame: vk::RenderPass,
}

/// Depth test of the frame's pass: reversed, 1 on the near plane.
const NEARER: vk::CompareOp = vk::CompareOp::GREATER_OR_EQUAL;

/// Depth test of what something hides. What is drawn as it is hides nothing of itself.
const FARTHER: vk::CompareOp = vk::CompareOp::LESS;

impl Pipelines {
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        format: &TargetFormat,
        volume: VolumeFormat,
        passes: &PassHandles,
        cache_data: &[u8],
    ) -> Result<Self, Error> {
        let info = vk::PipelineCacheCreateInfo::default().initial_data(cache_data);
        // SAFETY: a driver checks the data's header and ignores what isn't its own.
        let cache =
            unsafe { gpu.device.create_pipeline_cache(&info, None) }.could_not("make a cache")?;
        let null = vk::Pipeline::null();
        let mut all = Pipelines {
            gpu: gpu.clone(),
            cache,
            set_layout: vk::DescriptorSetLayout::null(),
            layout: vk::PipelineLayout::null(),
            march_starts: [null; 2],
            fast: null,
            paper: [null; 4],
            meshes: null,
            particles: null,
            hidden: null,
            shadow_casters: [null; 2],
        };
        all.create_layouts()?;
        all.create_march_start_pipelines(passes.march_starts)?;
        all.create_sculpture_pipelines(format, volume, passes.frame)?;
        all.create_scene_pipelines(format, passes.frame)?;
        all.create_shadow_pipelines(passes.shadow)?;
        Ok(all)
    }

    fn create_march_start_pipelines(&mut self, pass: vk::RenderPass) -> Result<(), Error> {
        let tiles = PipelineSpec {
            vertex: programs::TILES_VERTEX,
            fragment: Some(programs::TILES),
            ..PipelineSpec::for_pass(pass)
        };
        let beams = PipelineSpec {
            vertex: programs::BEAMS_VERTEX,
            fragment: Some(programs::BEAMS),
            strip: true,
            ..tiles
        };
        self.march_starts[0] = self.create_pipeline(&tiles)?;
        self.march_starts[1] = self.create_pipeline(&beams)?;
        Ok(())
    }

    fn create_sculpture_pipelines(
        &mut self,
        format: &TargetFormat,
        volume: VolumeFormat,
        pass: vk::RenderPass,
    ) -> Result<(), Error> {
        let coverage = format.samples > 1;
        let fast = PipelineSpec {
            vertex: programs::TILE_VERTEX,
            fragment: Some(fast_program(self.gpu.features.half_precision, coverage)),
            samples: format.sample_count(),
            strip: true,
            depth: Some(NEARER),
            coverage,
            ..PipelineSpec::for_pass(pass)
        };
        self.fast = self.create_pipeline(&fast)?;
        for (i, fragment) in paper_programs(volume).into_iter().enumerate() {
            self.paper[i] = self.create_pipeline(&PipelineSpec {
                vertex: programs::BOX_VERTEX,
                fragment: Some(fragment),
                cull: vk::CullModeFlags::BACK,
                coverage: false,
                ..fast
            })?;
        }
        Ok(())
    }

    fn create_scene_pipelines(
        &mut self,
        format: &TargetFormat,
        pass: vk::RenderPass,
    ) -> Result<(), Error> {
        let meshes = PipelineSpec {
            vertex: programs::SCENE_VERTEX,
            input: VertexInput::Mesh,
            fragment: Some(programs::SCENE),
            samples: format.sample_count(),
            cull: vk::CullModeFlags::BACK,
            depth: Some(NEARER),
            ..PipelineSpec::for_pass(pass)
        };
        let particles = PipelineSpec {
            fragment: Some(programs::PARTICLES),
            blend: Some(Blend::Alpha),
            ..meshes
        };
        self.meshes = self.create_pipeline(&meshes)?;
        self.particles = self.create_pipeline(&particles)?;
        let hidden = PipelineSpec { depth: Some(FARTHER), ..particles };
        self.hidden = self.create_pipeline(&hidden)?;
        Ok(())
    }

    fn create_shadow_pipelines(&mut self, pass: vk::RenderPass) -> Result<(), Error> {
        let meshes = PipelineSpec {
            vertex: programs::CAST_VERTEX,
            input: VertexInput::MeshPositions,
            depth: Some(vk::CompareOp::LESS),
            color: false,
            bias: true,
            ..PipelineSpec::for_pass(pass)
        };
        let sculpture = PipelineSpec {
            vertex: programs::CAST_SCULPTURE_VERTEX,
            input: VertexInput::VertexIndex,
            fragment: Some(programs::CAST_SCULPTURE),
            strip: true,
            cull: vk::CullModeFlags::BACK,
            bias: false,
            ..meshes
        };
        self.shadow_casters[0] = self.create_pipeline(&meshes)?;
        self.shadow_casters[1] = self.create_pipeline(&sculpture)?;
        Ok(())
    }

    /// The sculpture's pipeline for a render path.
    pub(crate) const fn sculpture_pipeline(&self, path: RenderPath) -> vk::Pipeline {
        match path {
            RenderPath::Fast => self.fast,
            RenderPath::Paper(PaperVariant::Whole) => self.paper[0],
            RenderPath::Paper(PaperVariant::FullMarch) => self.paper[1],
            RenderPath::Paper(PaperVariant::NoSdf) => self.paper[2],
            RenderPath::Paper(PaperVariant::NoShading) => self.paper[3],
        }
    }

    /// Serialised pipeline cache, for the next start.
    pub(crate) fn cache_data(&self) -> Result<Vec<u8>, Error> {
        // SAFETY: the cache is this device's.
        unsafe { self.gpu.device.get_pipeline_cache_data(self.cache) }.could_not("read the cache")
    }

    fn create_layouts(&mut self) -> Result<(), Error> {
        let device = &self.gpu.device;
        let both = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
        let mut bindings = [vk::DescriptorSetLayoutBinding::default(); BINDING_TYPES.len()];
        for (i, (binding, kind)) in bindings.iter_mut().zip(BINDING_TYPES).enumerate() {
            *binding = binding
                .binding(i as u32)
                .descriptor_type(kind)
                .descriptor_count(1)
                .stage_flags(both);
        }
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

    fn create_pipeline(&self, spec: &PipelineSpec) -> Result<vk::Pipeline, Error> {
        spec.create_pipeline(&self.gpu, self.cache, self.layout)
    }
}

impl Drop for Pipelines {
    fn drop(&mut self) {
        let device = &self.gpu.device;
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe {
            let scene = [self.fast, self.meshes, self.particles, self.hidden];
            let all = self
                .march_starts
                .into_iter()
                .chain(self.paper)
                .chain(scene)
                .chain(self.shadow_casters);
            for pipeline in all {
                device.destroy_pipeline(pipeline, None);
            }
            device.destroy_pipeline_layout(self.layout, None);
            device.destroy_descriptor_set_layout(self.set_layout, None);
            device.destroy_pipeline_cache(self.cache, None);
        }
    }
}

/// The programs of the paper's path: whole, full march, no blobs, no shading.
const fn paper_programs(volume: VolumeFormat) -> [ShaderProgram; 4] {
    match volume.intervals() {
        1 => [
            programs::PAPER,
            programs::PAPER_FULL_MARCH,
            programs::PAPER_NO_SDF,
            programs::PAPER_NO_SHADING,
        ],
        _ => [
            programs::PAPER_TWO,
            programs::PAPER_TWO_FULL_MARCH,
            programs::PAPER_TWO_NO_SDF,
            programs::PAPER_TWO_NO_SHADING,
        ],
    }
}

const fn fast_program(half_precision: bool, alpha_to_coverage: bool) -> ShaderProgram {
    match (half_precision, alpha_to_coverage) {
        (true, true) => programs::FAST_HALF_COVERAGE,
        (true, false) => programs::FAST_HALF,
        (false, true) => programs::FAST_COVERAGE,
        (false, false) => programs::FAST,
    }
}
