//! The pipelines, one for each way of drawing something, and the one set of what they read.

use std::sync::Arc;

use ash::vk;

use super::context::Gpu;
use super::error::{Doing, Error};
use super::frame::{Parts, Path};
use super::pass::{Format, Pass};
use super::programs::{self, Program};
use super::recipe::{Blend, Input, Recipe};

/// What kinds of thing the set's bindings are; `wgsl` says which is which.
const BINDINGS: [vk::DescriptorType; 13] = [
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
    vk::DescriptorType::SAMPLED_IMAGE,
    vk::DescriptorType::SAMPLER,
];

/// The pipelines of a renderer.
pub(super) struct Pipelines {
    gpu: Arc<Gpu>,
    pub(super) cache: vk::PipelineCache,
    pub(super) set_layout: vk::DescriptorSetLayout,
    pub(super) layout: vk::PipelineLayout,
    /// Where the tiles' rays start, and those of the beams.
    pub(super) starts: [vk::Pipeline; 2],
    fast: vk::Pipeline,
    paper: [vk::Pipeline; 4],
    /// The room's things, and particles.
    pub(super) meshes: vk::Pipeline,
    pub(super) particles: vk::Pipeline,
    /// The shadows of those, and of the sculpture.
    pub(super) cast: [vk::Pipeline; 2],
}

/// The passes that pipelines are made for.
pub(super) struct Passes<'a> {
    pub(super) starts: &'a Pass,
    pub(super) shadow: &'a Pass,
    pub(super) frame: &'a Pass,
}

/// The depth test of the frame's pass: depth is 1 on the near plane.
const NEARER: vk::CompareOp = vk::CompareOp::GREATER_OR_EQUAL;

impl Pipelines {
    pub(super) fn new(
        gpu: &Arc<Gpu>,
        format: &Format,
        passes: &Passes<'_>,
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
            meshes: null,
            particles: null,
            cast: [null; 2],
        };
        all.make_layouts()?;
        all.make_starts(passes.starts)?;
        all.make_sculpture(format, passes.frame)?;
        all.make_scene(format, passes.frame)?;
        all.make_cast(passes.shadow)?;
        Ok(all)
    }

    fn make_starts(&mut self, pass: &Pass) -> Result<(), Error> {
        let tiles = Recipe {
            vertex: programs::TILES_VERTEX,
            fragment: Some(programs::TILES),
            ..Recipe::plain(pass)
        };
        let beams = Recipe {
            vertex: programs::BEAMS_VERTEX,
            fragment: Some(programs::BEAMS),
            strip: true,
            ..tiles
        };
        self.starts[0] = self.make(&tiles)?;
        self.starts[1] = self.make(&beams)?;
        Ok(())
    }

    fn make_sculpture(&mut self, format: &Format, pass: &Pass) -> Result<(), Error> {
        let coverage = format.samples > 1;
        let fast = Recipe {
            vertex: programs::TILE_VERTEX,
            fragment: Some(fast_program(self.gpu.needs.half, coverage)),
            samples: format.count(),
            strip: true,
            depth: Some(NEARER),
            coverage,
            ..Recipe::plain(pass)
        };
        self.fast = self.make(&fast)?;
        let paper = [
            programs::PAPER,
            programs::PAPER_FULL_MARCH,
            programs::PAPER_NO_SDF,
            programs::PAPER_NO_SHADING,
        ];
        for (i, fragment) in paper.into_iter().enumerate() {
            self.paper[i] = self.make(&Recipe {
                vertex: programs::BOX_VERTEX,
                fragment: Some(fragment),
                cull: vk::CullModeFlags::BACK,
                coverage: false,
                ..fast
            })?;
        }
        Ok(())
    }

    fn make_scene(&mut self, format: &Format, pass: &Pass) -> Result<(), Error> {
        let meshes = Recipe {
            vertex: programs::SCENE_VERTEX,
            input: Input::Mesh,
            fragment: Some(programs::SCENE),
            samples: format.count(),
            cull: vk::CullModeFlags::BACK,
            depth: Some(NEARER),
            ..Recipe::plain(pass)
        };
        let particles =
            Recipe { fragment: Some(programs::PARTICLES), blend: Some(Blend::Alpha), ..meshes };
        self.meshes = self.make(&meshes)?;
        self.particles = self.make(&particles)?;
        Ok(())
    }

    fn make_cast(&mut self, pass: &Pass) -> Result<(), Error> {
        let meshes = Recipe {
            vertex: programs::CAST_VERTEX,
            input: Input::Places,
            depth: Some(vk::CompareOp::LESS),
            color: false,
            bias: true,
            ..Recipe::plain(pass)
        };
        let sculpture = Recipe {
            vertex: programs::CAST_SCULPTURE_VERTEX,
            input: Input::Number,
            fragment: Some(programs::CAST_SCULPTURE),
            strip: true,
            cull: vk::CullModeFlags::BACK,
            bias: false,
            ..meshes
        };
        self.cast[0] = self.make(&meshes)?;
        self.cast[1] = self.make(&sculpture)?;
        Ok(())
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
        recipe.make(&self.gpu, self.cache, self.layout)
    }
}

impl Drop for Pipelines {
    fn drop(&mut self) {
        let device = &self.gpu.device;
        // SAFETY: the owner waits for the device before it drops what was submitted.
        unsafe {
            let scene = [self.fast, self.meshes, self.particles];
            let all = self.starts.into_iter().chain(self.paper).chain(scene).chain(self.cast);
            for pipeline in all {
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
