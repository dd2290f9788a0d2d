//! What a frame is drawn into: the shell's images, and those that no one keeps.

use std::sync::Arc;

use ash::vk;

use super::buffer::Buffer;
use super::context::Gpu;
use super::error::{Doing, Error};
use super::frame::{BEAM, TILE};
use super::image::{Image, Shape};
use super::owned::Owned;
use super::pass::{Format, Pass, STARTS};
use super::pipelines::Pipelines;
use super::shadow::ShadowMap;
use super::textures::Textures;

/// The images of a swapchain, or of a picture; all have one size.
pub struct Surface {
    gpu: Arc<Gpu>,
    /// Pixels across and down.
    pub extent: [u32; 2],
    pub(super) framebuffers: Vec<Owned<vk::Framebuffer>>,
    /// Where the tiles' rays start, then those of the beams within them.
    pub(super) starts: [Starts; 2],
    /// One for each frame of the ring.
    pub(super) sets: Vec<vk::DescriptorSet>,
    pool: vk::DescriptorPool,
    /// Colour of several samples and depth; transient.
    transient: Vec<Image>,
}

/// An image of where rays start.
pub(super) struct Starts {
    pub(super) framebuffer: Owned<vk::Framebuffer>,
    pub(super) extent: [u32; 2],
    image: Image,
}

/// Views of the shell's images.
pub(super) struct Views<'a> {
    /// Each with as many layers as the format has views.
    pub(super) colors: &'a [vk::ImageView],
    /// As many, where depth is kept; else none.
    pub(super) depths: &'a [vk::ImageView],
    /// As many, where there are density maps.
    pub(super) densities: &'a [vk::ImageView],
}

/// What surfaces are made for.
pub(super) struct Parts<'a> {
    pub(super) gpu: &'a Arc<Gpu>,
    pub(super) format: &'a Format,
    pub(super) starts: &'a Pass,
    pub(super) frame: &'a Pass,
    pub(super) pipelines: &'a Pipelines,
    pub(super) textures: &'a Textures,
    pub(super) shadow: &'a ShadowMap,
}

impl core::fmt::Debug for Surface {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Surface").field("extent", &self.extent).finish_non_exhaustive()
    }
}

impl Surface {
    /// For views of the shell's images.
    pub(super) fn new<'b>(
        parts: &Parts<'_>,
        extent: [u32; 2],
        views: &Views<'_>,
        uniforms: impl Iterator<Item = &'b Buffer>,
    ) -> Result<Self, Error> {
        let (gpu, format) = (parts.gpu, parts.format);
        let (images, maps) = (views.colors.len(), views.densities.len());
        if format.density_map && images != maps {
            return Err(Error::NoDensityMap { images, maps });
        }
        let starts = |width: u32| {
            let across = extent.map(|pixels| pixels.div_ceil(width));
            Starts::new(gpu, parts.starts, across, format.views)
        };
        let mut surface = Surface {
            gpu: gpu.clone(),
            extent,
            framebuffers: Vec::new(),
            starts: [starts(TILE)?, starts(BEAM)?],
            sets: Vec::new(),
            pool: vk::DescriptorPool::null(),
            transient: Vec::new(),
        };
        surface.make_transient(format, views.depths.is_empty())?;
        for i in 0..images {
            let attachments = surface.attachments(format, views, i);
            surface.framebuffers.push(framebuffer(gpu, parts.frame, extent, &attachments)?);
        }
        surface.make_sets(parts, uniforms)?;
        Ok(surface)
    }

    fn make_transient(&mut self, format: &Format, with_depth: bool) -> Result<(), Error> {
        let transient = vk::ImageUsageFlags::TRANSIENT_ATTACHMENT;
        let shape = |of, usage| Shape {
            samples: format.count(),
            ..Shape::flat(of, self.extent, format.views).usage(usage | transient)
        };
        let mut shapes = Vec::new();
        if format.samples > 1 {
            shapes.push(shape(format.color, vk::ImageUsageFlags::COLOR_ATTACHMENT));
        }
        if with_depth {
            let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
            shapes.push(shape(Format::depth(&self.gpu), usage));
        }
        for shape in shapes {
            self.transient.push(Image::new(&self.gpu, shape)?);
        }
        Ok(())
    }

    /// The views of an image's framebuffer in the pass's order: drawn colour, depth, resolved
    /// colour, density map.
    fn attachments(&self, format: &Format, views: &Views<'_>, i: usize) -> Vec<vk::ImageView> {
        let (color, depth) = (views.colors[i], views.depths.get(i).copied());
        let mut transient = self.transient.iter().map(|image| image.view);
        let drawn = if format.samples > 1 { transient.next() } else { Some(color) };
        let depth = depth.or_else(|| transient.next());
        let resolved = (format.samples > 1).then_some(color);
        let density = format.density_map.then(|| views.densities[i]);
        [drawn, depth, resolved, density].into_iter().flatten().collect()
    }

    fn make_sets<'b>(
        &mut self,
        parts: &Parts<'_>,
        uniforms: impl Iterator<Item = &'b Buffer>,
    ) -> Result<(), Error> {
        let uniforms: Vec<&Buffer> = uniforms.collect();
        let count = uniforms.len() as u32;
        let size = |ty, each: u32| vk::DescriptorPoolSize { ty, descriptor_count: each * count };
        let sizes = [
            size(vk::DescriptorType::UNIFORM_BUFFER, 1),
            size(vk::DescriptorType::SAMPLED_IMAGE, 8),
            size(vk::DescriptorType::SAMPLER, 4),
        ];
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(2 * count).pool_sizes(&sizes);
        let device = &self.gpu.device;
        // SAFETY: the info is complete.
        self.pool = unsafe { device.create_descriptor_pool(&info, None) }.doing("make a pool")?;
        let layouts = vec![parts.pipelines.set_layout; uniforms.len()];
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool has room for these sets.
        self.sets = unsafe { device.allocate_descriptor_sets(&info) }.doing("make sets")?;
        for (set, uniform) in self.sets.iter().zip(uniforms) {
            self.fill_set(*set, parts, uniform);
        }
        Ok(())
    }

    fn fill_set(&self, set: vk::DescriptorSet, parts: &Parts<'_>, uniform: &Buffer) {
        let (textures, shadow) = (parts.textures, parts.shadow);
        let buffer =
            [vk::DescriptorBufferInfo::default().buffer(uniform.raw).range(vk::WHOLE_SIZE)];
        let image = |view| {
            [vk::DescriptorImageInfo::default()
                .image_view(view)
                .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)]
        };
        let sampler = |sampler| [vk::DescriptorImageInfo::default().sampler(sampler)];
        let images = [
            (1, image(textures.maps.view)),
            (2, image(textures.density.view)),
            (3, image(textures.cells.view)),
            (4, image(textures.noise.view)),
            (7, image(self.starts[0].image.view)),
            (8, image(textures.marble.view)),
            (10, image(self.starts[1].image.view)),
            (11, image(shadow.image.view)),
        ];
        let samplers = [
            (5, sampler(textures.clamped.raw)),
            (6, sampler(textures.nearest.raw)),
            (9, sampler(textures.repeated.raw)),
            (12, sampler(shadow.sampler.raw)),
        ];
        let write = |binding, kind| {
            vk::WriteDescriptorSet::default()
                .dst_set(set)
                .dst_binding(binding)
                .descriptor_type(kind)
        };
        let mut writes = vec![write(0, vk::DescriptorType::UNIFORM_BUFFER).buffer_info(&buffer)];
        for (binding, info) in &images {
            writes.push(write(*binding, vk::DescriptorType::SAMPLED_IMAGE).image_info(info));
        }
        for (binding, info) in &samplers {
            writes.push(write(*binding, vk::DescriptorType::SAMPLER).image_info(info));
        }
        // SAFETY: the set is new, and all that it names outlives it.
        unsafe { self.gpu.device.update_descriptor_sets(&writes, &[]) };
    }
}

impl Drop for Surface {
    fn drop(&mut self) {
        // A frame may still be drawn into it; a lost device has none under way.
        let _ = self.gpu.wait();
        // SAFETY: nothing is under way.
        unsafe { self.gpu.device.destroy_descriptor_pool(self.pool, None) };
    }
}

impl Starts {
    fn new(gpu: &Arc<Gpu>, pass: &Pass, extent: [u32; 2], views: u32) -> Result<Self, Error> {
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let image = Image::new(gpu, Shape::flat(STARTS, extent, views).usage(usage))?;
        let framebuffer = framebuffer(gpu, pass, extent, &[image.view])?;
        Ok(Starts { framebuffer, extent, image })
    }
}

pub(super) fn framebuffer(
    gpu: &Arc<Gpu>,
    pass: &Pass,
    [width, height]: [u32; 2],
    views: &[vk::ImageView],
) -> Result<Owned<vk::Framebuffer>, Error> {
    let info = vk::FramebufferCreateInfo::default()
        .render_pass(pass.raw)
        .attachments(views)
        .width(width)
        .height(height)
        .layers(1);
    // SAFETY: the views and the pass are this device's, and fit each other.
    let raw = unsafe { gpu.device.create_framebuffer(&info, None) }.doing("make a framebuffer")?;
    Ok(Owned::new(gpu, raw))
}
