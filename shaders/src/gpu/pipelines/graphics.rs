//! The graphics pipelines, and the layout of the one descriptor set that they share.

use std::collections::BTreeMap;
use std::sync::Arc;

use ash::vk;

use super::paths::{Drawn, PaperVariant, RenderPath};
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
    /// The sculpture's pipelines, each created when it is first drawn: a headset never compiles the
    /// paper's.
    sculpture: BTreeMap<(RenderPath, Drawn), vk::Pipeline>,
    format: TargetFormat,
    volume: VolumeFormat,
    frame_pass: vk::RenderPass,
    /// Pipelines of scene meshes, of particles, and of guides drawn where something hides them.
    pub(crate) meshes: vk::Pipeline,
    pub(crate) particles: vk::Pipeline,
    pub(crate) hidden: vk::Pipeline,
    /// Panels in the room.
    pub(crate) panels: vk::Pipeline,
    /// Shadow casters: scene meshes, and the sculpture.
    pub(crate) shadow_casters: [vk::Pipeline; 2],
}

/// The render passes that the pipelines are for.
pub(crate) struct PassHandles {
    /// The passes of the march starts: of tiles, and of beams.
    pub(crate) march_starts: [vk::RenderPass; 2],
    pub(crate) shadow: vk::RenderPass,
    pub(crate) frame: vk::RenderPass,
    /// The pass that draws the overlay and the panels in the room: the frame's, unless the picture is
    /// scaled up.
    pub(crate) overlay: vk::RenderPass,
}

/// Depth test of the frame's pass: reversed, 1 on the near plane.
const NEARER: vk::CompareOp = vk::CompareOp::GREATER_OR_EQUAL;

/// Depth test of guides drawn where something hides them. Strict, so that a mesh that is also drawn
/// normally doesn't hide itself.
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
            sculpture: BTreeMap::new(),
            format: *format,
            volume,
            frame_pass: passes.frame,
            meshes: null,
            particles: null,
            hidden: null,
            panels: null,
            shadow_casters: [null; 2],
        };
        all.create_layouts()?;
        all.create_march_start_pipelines(passes.march_starts)?;
        all.ensure_sculpture_pipeline(RenderPath::Fast, Drawn::Picture)?;
        all.create_scene_pipelines(format, passes)?;
        all.create_shadow_pipelines(passes.shadow)?;
        Ok(all)
    }

    fn create_march_start_pipelines(
        &mut self,
        [tiles_pass, beams_pass]: [vk::RenderPass; 2],
    ) -> Result<(), Error> {
        let tiles = PipelineSpec {
            vertex: programs::TILES_VERTEX,
            fragment: Some(programs::TILES),
            ..PipelineSpec::for_pass(tiles_pass)
        };
        let beams = PipelineSpec {
            vertex: programs::BEAMS_VERTEX,
            fragment: Some(programs::BEAMS),
            strip: true,
            ..PipelineSpec::for_pass(beams_pass)
        };
        self.march_starts[0] = self.create_pipeline(&tiles)?;
        self.march_starts[1] = self.create_pipeline(&beams)?;
        Ok(())
    }

    /// Creates the sculpture's pipeline for a path and an output, unless it exists.
    pub(crate) fn ensure_sculpture_pipeline(
        &mut self,
        path: RenderPath,
        drawn: Drawn,
    ) -> Result<(), Error> {
        if self.sculpture.contains_key(&(path, drawn)) {
            return Ok(());
        }
        let half = self.gpu.features.half_precision;
        let coverage = self.format.samples > 1;
        let fast = PipelineSpec {
            vertex: programs::TILE_VERTEX,
            samples: self.format.sample_count(),
            strip: true,
            depth: Some(NEARER),
            coverage,
            ..PipelineSpec::for_pass(self.frame_pass)
        };
        let spec = match path {
            RenderPath::Fast => {
                PipelineSpec { fragment: Some(fast_program(half, coverage, drawn)), ..fast }
            }
            RenderPath::Paper(variant) => PipelineSpec {
                vertex: programs::BOX_VERTEX,
                fragment: Some(paper_program(self.volume, variant, drawn)),
                cull: vk::CullModeFlags::BACK,
                coverage: false,
                ..fast
            },
        };
        let pipeline = self.create_pipeline(&spec)?;
        self.sculpture.insert((path, drawn), pipeline);
        Ok(())
    }

    fn create_scene_pipelines(
        &mut self,
        format: &TargetFormat,
        passes: &PassHandles,
    ) -> Result<(), Error> {
        let meshes = PipelineSpec {
            vertex: programs::SCENE_VERTEX,
            input: VertexInput::Mesh,
            fragment: Some(programs::SCENE),
            samples: format.sample_count(),
            cull: vk::CullModeFlags::BACK,
            depth: Some(NEARER),
            ..PipelineSpec::for_pass(passes.frame)
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
        let [_, overlay_format] = format.pass_formats();
        let panels = PipelineSpec {
            vertex: programs::PANEL_VERTEX,
            input: VertexInput::PanelQuads,
            fragment: Some(programs::PANEL),
            strip: true,
            pass: passes.overlay,
            samples: overlay_format.sample_count(),
            // Depth is not scaled up with a picture, so that nothing can hide a panel.
            depth: Some(NEARER).filter(|_| !format.scales_up),
            ..particles
        };
        self.panels = self.create_pipeline(&panels)?;
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

    /// Returns the sculpture's pipeline for a render path and an output, which
    /// [`ensure_sculpture_pipeline`](Pipelines::ensure_sculpture_pipeline) must have created.
    pub(crate) fn sculpture_pipeline(&self, path: RenderPath, drawn: Drawn) -> vk::Pipeline {
        self.sculpture[&(path, drawn)]
    }

    /// Returns the serialised pipeline cache, for the next start.
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
            let scene = [self.meshes, self.particles, self.hidden, self.panels];
            let all = self
                .march_starts
                .into_iter()
                .chain(self.sculpture.values().copied())
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

/// Returns a program of the paper's path. Counts are those of the whole path with one interval a column.
/// There is no floor: the picture is drawn instead.
const fn paper_program(volume: VolumeFormat, variant: PaperVariant, drawn: Drawn) -> ShaderProgram {
    if matches!(drawn, Drawn::Counts | Drawn::CoverageCounts) {
        return programs::PAPER_COUNTED;
    }
    match (volume.intervals(), variant) {
        (1, PaperVariant::Whole) => programs::PAPER,
        (1, PaperVariant::FullMarch) => programs::PAPER_FULL_MARCH,
        (1, PaperVariant::NoSdf) => programs::PAPER_NO_SDF,
        (1, PaperVariant::NoShading) => programs::PAPER_NO_SHADING,
        (_, PaperVariant::Whole) => programs::PAPER_TWO,
        (_, PaperVariant::FullMarch) => programs::PAPER_TWO_FULL_MARCH,
        (_, PaperVariant::NoSdf) => programs::PAPER_TWO_NO_SDF,
        (_, PaperVariant::NoShading) => programs::PAPER_TWO_NO_SHADING,
    }
}

const fn fast_program(half_precision: bool, samples_coverage: bool, drawn: Drawn) -> ShaderProgram {
    let coverage = match drawn {
        Drawn::CoverageCounts => true,
        Drawn::Counts => false,
        Drawn::Picture | Drawn::Floor => samples_coverage,
    };
    match (drawn, half_precision, coverage) {
        (Drawn::Picture, true, true) => programs::FAST_HALF_COVERAGE,
        (Drawn::Picture, true, false) => programs::FAST_HALF,
        (Drawn::Picture, false, true) => programs::FAST_COVERAGE,
        (Drawn::Picture, false, false) => programs::FAST,
        (Drawn::Floor, true, true) => programs::FAST_HALF_COVERAGE_FLOOR,
        (Drawn::Floor, true, false) => programs::FAST_HALF_FLOOR,
        (Drawn::Floor, false, true) => programs::FAST_COVERAGE_FLOOR,
        (Drawn::Floor, false, false) => programs::FAST_FLOOR,
        (_, true, true) => programs::FAST_HALF_COVERAGE_COUNTED,
        (_, true, false) => programs::FAST_HALF_COUNTED,
        (_, false, true) => programs::FAST_COVERAGE_COUNTED,
        (_, false, false) => programs::FAST_COUNTED,
    }
}
