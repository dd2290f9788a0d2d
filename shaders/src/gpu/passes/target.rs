//! Render targets: framebuffers and descriptor sets for the shell's images, transient attachments, and
//! the images of march starts.

use std::sync::Arc;

use ash::vk;

use super::render_pass::{MARCH_START_FORMAT, RenderPass, create_framebuffer};
use super::scale_up::ScaledPicture;
use super::shadow_map::ShadowMap;
use crate::constants::{
    BEAM_PIXELS, BINDING_BEAM_STARTS, BINDING_CELLS, BINDING_CLAMPED, BINDING_DENSITY,
    BINDING_DEPTH_COMPARE, BINDING_FRAME, BINDING_GRADIENT, BINDING_MAPS, BINDING_MARBLE,
    BINDING_NEAREST, BINDING_NOISE, BINDING_PANEL_ATLAS, BINDING_PANEL_PICTURES, BINDING_REPEAT,
    BINDING_SUN_MAP, BINDING_TILE_STARTS, TILE_PIXELS,
};
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::format::TargetFormat;
use crate::gpu::device::owned::OwnedHandle;
use crate::gpu::memory::buffer::Buffer;
use crate::gpu::memory::image::{GpuImage, ImageSpec};
use crate::gpu::memory::textures::SculptureTextures;
use crate::gpu::pipelines::graphics::{BINDING_TYPES, Pipelines};

/// Framebuffers for the images of a swapchain, or for a single image; all have one size.
pub struct RenderTarget {
    gpu: Arc<Gpu>,
    /// Pixels across and down.
    pub extent: [u32; 2],
    /// The pixels that are drawn, from the upper left corner.
    drawn: [u32; 2],
    pub(crate) framebuffers: Vec<OwnedHandle<vk::Framebuffer>>,
    /// The picture that is scaled up; `None` without scaling. With scaling, `framebuffers` has only that
    /// picture's.
    pub(crate) scaled: Option<ScaledPicture>,
    /// March starts of the tiles, then of the beams within them.
    pub(crate) march_starts: [MarchStarts; 2],
    /// Descriptor sets, one for each frame of the ring.
    pub(crate) sets: Vec<vk::DescriptorSet>,
    pool: vk::DescriptorPool,
    /// Multisampled colour and depth; transient attachments.
    transient: Vec<GpuImage>,
}

/// An image of the depths at which marches start, with its framebuffer.
pub(crate) struct MarchStarts {
    pub(crate) framebuffer: OwnedHandle<vk::Framebuffer>,
    /// The drawn part of the image, in texels across and down.
    pub(crate) extent: [u32; 2],
    /// Pixels along a side of a texel's square.
    texel_pixels: u32,
    image: GpuImage,
}

/// Image views of the shell's images.
pub(crate) struct TargetViews<'a> {
    /// Colour views, each with as many layers as the format has views.
    pub(crate) colors: &'a [vk::ImageView],
    /// Depth views, one for each colour view; empty unless depth is kept.
    pub(crate) depths: &'a [vk::ImageView],
    /// Density maps, one for each colour view; empty without density maps.
    pub(crate) density_maps: &'a [vk::ImageView],
    /// The images of `colors`; empty unless pictures are scaled up.
    pub(crate) images: &'a [vk::Image],
}

/// The renderer's objects that a render target refers to.
pub(crate) struct TargetResources<'a> {
    pub(crate) gpu: &'a Arc<Gpu>,
    pub(crate) format: &'a TargetFormat,
    pub(crate) march_starts: &'a [RenderPass; 2],
    pub(crate) frame: &'a RenderPass,
    /// The pass that draws the overlay after the frame's pass; `None` unless the picture is scaled up.
    pub(crate) overlay_pass: Option<&'a RenderPass>,
    pub(crate) pipelines: &'a Pipelines,
    pub(crate) textures: &'a SculptureTextures,
    pub(crate) panel_atlas: &'a GpuImage,
    pub(crate) panel_pictures: &'a GpuImage,
    pub(crate) shadow: &'a ShadowMap,
}

impl core::fmt::Debug for RenderTarget {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Surface").field("extent", &self.extent).finish_non_exhaustive()
    }
}

impl RenderTarget {
    /// Creates a target for the shell's image views; `uniforms` has a buffer for each frame of the ring.
    pub(crate) fn new<'b>(
        resources: &TargetResources<'_>,
        extent: [u32; 2],
        views: &TargetViews<'_>,
        uniforms: impl Iterator<Item = &'b Buffer>,
    ) -> Result<Self, Error> {
        let (gpu, format) = (resources.gpu, resources.format);
        let (images, maps) = (views.colors.len(), views.density_maps.len());
        if format.density_map && images != maps {
            return Err(Error::NoDensityMap { images, maps });
        }
        let [tiles, beams] = resources.march_starts;
        let march_starts = |pass: &RenderPass, texel_pixels: u32| {
            MarchStarts::new(gpu, pass, extent, texel_pixels, format.views)
        };
        let mut target = RenderTarget {
            gpu: gpu.clone(),
            extent,
            drawn: extent,
            framebuffers: Vec::new(),
            scaled: None,
            march_starts: [march_starts(tiles, TILE_PIXELS)?, march_starts(beams, BEAM_PIXELS)?],
            sets: Vec::new(),
            pool: vk::DescriptorPool::null(),
            transient: Vec::new(),
        };
        target.create_transient_images(format, views.depths.is_empty())?;
        if let Some(pass) = resources.overlay_pass {
            let shells = (views.images, views.colors);
            target.scaled = Some(ScaledPicture::new(gpu, format, pass, extent, shells)?);
        }
        let aside = target.scaled.as_ref().map(|scaled| [scaled.drawn.view]);
        let colors = aside.as_ref().map_or(views.colors, |view| &view[..]);
        for (i, color) in colors.iter().enumerate() {
            let depth = views.depths.get(i).copied();
            let density = format.density_map.then(|| views.density_maps[i]);
            let attachments =
                target.framebuffer_attachments(format, [Some(*color), depth, density]);
            target.framebuffers.push(create_framebuffer(
                gpu,
                resources.frame,
                extent,
                &attachments,
            )?);
        }
        target.allocate_sets(resources, uniforms)?;
        Ok(target)
    }

    /// Sets the pixels across and down that are drawn from the next frame on, from the upper left corner of
    /// the images: a picture of lower resolution. The picture is scaled up if the format says so; else the
    /// rest of the image is left as it is. Clamped to at least one and at most [`Self::extent`].
    pub fn set_drawn_extent(&mut self, pixels: [u32; 2]) {
        self.drawn = core::array::from_fn(|k| pixels[k].clamp(1, self.extent[k]));
        for starts in &mut self.march_starts {
            starts.set_drawn_pixels(self.drawn);
        }
    }

    /// Returns the pixels that are drawn, across and down.
    #[must_use]
    pub const fn drawn_extent(&self) -> [u32; 2] {
        self.drawn
    }

    fn create_transient_images(
        &mut self,
        format: &TargetFormat,
        with_depth: bool,
    ) -> Result<(), Error> {
        let transient = vk::ImageUsageFlags::TRANSIENT_ATTACHMENT;
        let shape = |of, usage| ImageSpec {
            samples: format.sample_count(),
            is_subsampled: format.is_subsampled,
            ..ImageSpec::new_2d(of, self.extent, format.views).with_usage(usage | transient)
        };
        let mut shapes = Vec::new();
        if format.samples > 1 {
            shapes.push(shape(format.color, vk::ImageUsageFlags::COLOR_ATTACHMENT));
        }
        if with_depth {
            let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT;
            shapes.push(shape(TargetFormat::choose_depth(&self.gpu), usage));
        }
        for shape in shapes {
            self.transient.push(GpuImage::new(&self.gpu, shape)?);
        }
        Ok(())
    }

    /// Returns the image views of a framebuffer, in the order of the pass's attachments: colour, depth,
    /// resolved colour, density map. Takes the views that the shell or the scaled picture has: colour,
    /// depth, density map.
    fn framebuffer_attachments(
        &self,
        format: &TargetFormat,
        [color, depth, density]: [Option<vk::ImageView>; 3],
    ) -> Vec<vk::ImageView> {
        let mut transient = self.transient.iter().map(|image| image.view);
        let drawn = if format.samples > 1 { transient.next() } else { color };
        let depth = depth.or_else(|| transient.next());
        let resolved = color.filter(|_| format.samples > 1);
        [drawn, depth, resolved, density].into_iter().flatten().collect()
    }

    fn allocate_sets<'b>(
        &mut self,
        resources: &TargetResources<'_>,
        uniforms: impl Iterator<Item = &'b Buffer>,
    ) -> Result<(), Error> {
        let uniforms: Vec<&Buffer> = uniforms.collect();
        let count = uniforms.len() as u32;
        let size = |ty| {
            let each = BINDING_TYPES.iter().filter(|kind| **kind == ty).count() as u32;
            vk::DescriptorPoolSize { ty, descriptor_count: each * count }
        };
        let sizes = [
            size(vk::DescriptorType::UNIFORM_BUFFER),
            size(vk::DescriptorType::SAMPLED_IMAGE),
            size(vk::DescriptorType::SAMPLER),
        ];
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(2 * count).pool_sizes(&sizes);
        let device = &self.gpu.device;
        // SAFETY: the info is complete.
        self.pool =
            unsafe { device.create_descriptor_pool(&info, None) }.could_not("make a pool")?;
        let layouts = vec![resources.pipelines.set_layout; uniforms.len()];
        let info = vk::DescriptorSetAllocateInfo::default()
            .descriptor_pool(self.pool)
            .set_layouts(&layouts);
        // SAFETY: the pool has room for these sets.
        self.sets = unsafe { device.allocate_descriptor_sets(&info) }.could_not("make sets")?;
        for (set, uniform) in self.sets.iter().zip(uniforms) {
            self.write_set(*set, resources, uniform);
        }
        Ok(())
    }

    fn write_set(&self, set: vk::DescriptorSet, resources: &TargetResources<'_>, uniform: &Buffer) {
        let (textures, shadow) = (resources.textures, resources.shadow);
        let buffer =
            [vk::DescriptorBufferInfo::default().buffer(uniform.raw).range(vk::WHOLE_SIZE)];
        let image = |view| {
            [vk::DescriptorImageInfo::default()
                .image_view(view)
                .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)]
        };
        let sampler = |sampler| [vk::DescriptorImageInfo::default().sampler(sampler)];
        let images = [
            (BINDING_MAPS, image(textures.maps.view)),
            (BINDING_DENSITY, image(textures.density.view)),
            (BINDING_CELLS, image(textures.cells.view)),
            (BINDING_GRADIENT, image(textures.gradient.view)),
            (BINDING_NOISE, image(textures.noise.view)),
            (BINDING_TILE_STARTS, image(self.march_starts[0].image.view)),
            (BINDING_MARBLE, image(textures.marble.view)),
            (BINDING_BEAM_STARTS, image(self.march_starts[1].image.view)),
            (BINDING_SUN_MAP, image(shadow.image.view)),
            (BINDING_PANEL_ATLAS, image(resources.panel_atlas.view)),
            (BINDING_PANEL_PICTURES, image(resources.panel_pictures.view)),
        ];
        let samplers = [
            (BINDING_CLAMPED, sampler(textures.linear_clamp.raw)),
            (BINDING_NEAREST, sampler(textures.nearest_clamp.raw)),
            (BINDING_REPEAT, sampler(textures.linear_repeat.raw)),
            (BINDING_DEPTH_COMPARE, sampler(shadow.sampler.raw)),
        ];
        let write = |binding, kind| {
            vk::WriteDescriptorSet::default()
                .dst_set(set)
                .dst_binding(binding)
                .descriptor_type(kind)
        };
        let mut writes =
            vec![write(BINDING_FRAME, vk::DescriptorType::UNIFORM_BUFFER).buffer_info(&buffer)];
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

impl Drop for RenderTarget {
    fn drop(&mut self) {
        // A frame that draws into the target may be in flight; on a lost device none is.
        let _ = self.gpu.wait_idle();
        // SAFETY: nothing is under way.
        unsafe { self.gpu.device.destroy_descriptor_pool(self.pool, None) };
    }
}

impl MarchStarts {
    /// Creates march starts for pictures of `pixels`, with a texel for each square of `texel_pixels`.
    fn new(
        gpu: &Arc<Gpu>,
        pass: &RenderPass,
        pixels: [u32; 2],
        texel_pixels: u32,
        views: u32,
    ) -> Result<Self, Error> {
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let extent = pixels.map(|pixels| pixels.div_ceil(texel_pixels));
        let image = GpuImage::new(
            gpu,
            ImageSpec::new_2d(MARCH_START_FORMAT, extent, views).with_usage(usage),
        )?;
        let framebuffer = create_framebuffer(gpu, pass, extent, &[image.view])?;
        Ok(MarchStarts { framebuffer, extent, texel_pixels, image })
    }

    fn set_drawn_pixels(&mut self, pixels: [u32; 2]) {
        self.extent = pixels.map(|pixels| pixels.div_ceil(self.texel_pixels));
    }
}
