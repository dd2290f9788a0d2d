//! The sculpture's textures on the device, their layout transitions and copies.

use std::sync::Arc;

use ash::vk;

use super::image::{GpuImage, ImageSpec, stage_and_access};
use super::staging::Staging;
use crate::constants::{MAP_BORDER_COLUMNS, NOISE_TEXELS};
use crate::field::{LEVELS, PAD, cell_side_texels};
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::{Error, ErrorContext};
use crate::gpu::device::owned::OwnedHandle;
use crate::upload::{Region, Texture, VolumeFormat};

/// Number of textures.
pub(crate) const TEXTURE_COUNT: usize = 6;
/// A subset of the textures: a flag for each, in the order of [`SculptureTextures::images`].
pub(crate) type TextureSet = [bool; TEXTURE_COUNT];
const STORAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::STORAGE;

/// The textures of a sculpture, and the samplers that read them.
pub(crate) struct SculptureTextures {
    gpu: Arc<Gpu>,
    pub(crate) maps: GpuImage,
    pub(crate) density: GpuImage,
    pub(crate) gradient: GpuImage,
    pub(crate) cells: GpuImage,
    pub(crate) noise: GpuImage,
    pub(crate) marble: GpuImage,
    pub(crate) linear_clamp: OwnedHandle<vk::Sampler>,
    pub(crate) linear_repeat: OwnedHandle<vk::Sampler>,
    pub(crate) nearest_clamp: OwnedHandle<vk::Sampler>,
    cleared: bool,
}

impl SculptureTextures {
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        volume: VolumeFormat,
        marble_side: u32,
    ) -> Result<Self, Error> {
        let grid_side = volume.grid_side() as u32;
        let usage = vk::ImageUsageFlags::SAMPLED
            | vk::ImageUsageFlags::TRANSFER_DST
            | vk::ImageUsageFlags::TRANSFER_SRC;
        let written = match gpu.features.storage_writes {
            true => usage | STORAGE,
            false => usage,
        };
        let solid = |format, side: u32, levels, usage| {
            let shape =
                ImageSpec { extent: [side; 3], levels, ..ImageSpec::new_2d(format, [side; 2], 1) };
            GpuImage::new(gpu, shape.with_usage(usage))
        };
        let byte = vk::Format::R8_UNORM;
        let flat =
            ImageSpec::new_2d(maps_format(volume), [grid_side + 2 * MAP_BORDER_COLUMNS; 2], 3);
        let sampler = |filter, mode| create_sampler(gpu, filter, mode);
        let (edge, repeat) =
            (vk::SamplerAddressMode::CLAMP_TO_EDGE, vk::SamplerAddressMode::REPEAT);
        Ok(SculptureTextures {
            gpu: gpu.clone(),
            maps: GpuImage::new(gpu, flat.with_usage(usage))?,
            density: solid(byte, grid_side + 2 * PAD as u32, LEVELS as u32, written)?,
            gradient: solid(vk::Format::R8G8B8A8_SNORM, grid_side / 2 + PAD as u32, 1, written)?,
            cells: solid(
                byte,
                (grid_side + 2 * PAD as u32) / cell_side_texels(volume.grid_side()) as u32,
                1,
                written,
            )?,
            noise: solid(vk::Format::R8_SNORM, NOISE_TEXELS as u32, 1, usage)?,
            marble: solid(vk::Format::R8G8_UNORM, marble_side, 1, usage)?,
            linear_clamp: sampler(vk::Filter::LINEAR, edge)?,
            linear_repeat: sampler(vk::Filter::LINEAR, repeat)?,
            nearest_clamp: sampler(vk::Filter::NEAREST, edge)?,
            cleared: false,
        })
    }

    /// Records a clear of all textures on the first call; later calls do nothing.
    pub(crate) fn record_clear_once(&mut self, commands: vk::CommandBuffer) {
        if !self.cleared {
            self.record_clear(commands);
            self.cleared = true;
        }
    }

    /// Returns the textures that have storage usage.
    pub(crate) fn with_storage_usage(&self) -> TextureSet {
        self.images().map(|image| image.spec.usage.contains(STORAGE))
    }

    /// Records copies of the staged regions for which `include` holds.
    pub(crate) fn record_copies(
        &self,
        commands: vk::CommandBuffer,
        staging: &Staging,
        include: impl Fn(&Region) -> bool,
    ) {
        let mut unordered = 0;
        for (i, (region, at)) in staging.regions.iter().enumerate() {
            if !include(region) {
                continue;
            }
            // Boxes computed one after the other may share a coarser texel, which only the later box has
            // right. Copies without a barrier between them may run in either order.
            let earlier = &staging.regions[unordered..i];
            if earlier.iter().any(|(other, _)| other.overlaps(region)) {
                self.record_copy_barrier(commands);
                unordered = i;
            }
            let (image, copy) = self.buffer_image_copy(region, *at);
            // SAFETY: the image is in this layout, and the region lies within it and the buffer.
            unsafe {
                self.gpu.device.cmd_copy_buffer_to_image(
                    commands,
                    staging.buffer.raw,
                    image,
                    vk::ImageLayout::TRANSFER_DST_OPTIMAL,
                    &[copy],
                );
            }
        }
    }

    /// Records a barrier between copies: later ones write after earlier ones.
    fn record_copy_barrier(&self, commands: vk::CommandBuffer) {
        let copy = vk::PipelineStageFlags::TRANSFER;
        let written = vk::MemoryBarrier::default()
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(vk::AccessFlags::TRANSFER_WRITE);
        let none = vk::DependencyFlags::empty();
        let device = &self.gpu.device;
        // SAFETY: the commands are being recorded outside of a pass.
        unsafe {
            device.cmd_pipeline_barrier(commands, copy, copy, none, &[written], &[], &[]);
        }
    }

    /// Returns the textures with a staged region for which `include` holds.
    pub(crate) fn with_staged_regions(
        &self,
        staging: &Staging,
        include: impl Fn(&Region) -> bool,
    ) -> TextureSet {
        let holds = |image: &GpuImage, region| self.image_and_mip_level(region).0.raw == image.raw;
        let regions =
            || staging.regions.iter().map(|(region, _)| region).filter(|one| include(one));
        self.images().map(|image| regions().any(|region| holds(image, region)))
    }

    /// Returns the image and mip level of a region.
    const fn image_and_mip_level(&self, region: &Region) -> (&GpuImage, u32) {
        match region.texture {
            Texture::Maps(_) => (&self.maps, 0),
            Texture::Density(level) => (&self.density, level as u32),
            Texture::Gradient => (&self.gradient, 0),
            Texture::Cells => (&self.cells, 0),
            Texture::Noise => (&self.noise, 0),
            Texture::Marble => (&self.marble, 0),
        }
    }

    /// Returns the image of a region, and the copy of its bytes from an offset in a buffer.
    pub(crate) fn buffer_image_copy(
        &self,
        region: &Region,
        buffer_offset: u64,
    ) -> (vk::Image, vk::BufferImageCopy) {
        let (image, level) = self.image_and_mip_level(region);
        let ([x, y, z], [width, height, depth]) = (region.min, region.size);
        let is_maps = matches!(region.texture, Texture::Maps(_));
        let (layer, layers, border) =
            if is_maps { (z, depth, MAP_BORDER_COLUMNS) } else { (0, 1, 0) };
        let (z, depth) = if is_maps { (0, 1) } else { (z, depth) };
        let copy = vk::BufferImageCopy {
            buffer_offset,
            image_subresource: vk::ImageSubresourceLayers {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                mip_level: level,
                base_array_layer: layer,
                layer_count: layers,
            },
            image_offset: vk::Offset3D {
                x: (x + border) as i32,
                y: (y + border) as i32,
                z: z as i32,
            },
            image_extent: vk::Extent3D { width, height, depth },
            ..vk::BufferImageCopy::default()
        };
        (image.raw, copy)
    }

    fn images(&self) -> [&GpuImage; TEXTURE_COUNT] {
        [&self.maps, &self.density, &self.gradient, &self.cells, &self.noise, &self.marble]
    }

    fn record_clear(&self, commands: vk::CommandBuffer) {
        let write = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        self.record_transition(commands, [true; TEXTURE_COUNT], vk::ImageLayout::UNDEFINED, write);
        let zero = vk::ClearColorValue { uint32: [0; 4] };
        for image in self.images() {
            // SAFETY: the image is in this layout, and the range is all of it.
            unsafe {
                self.gpu.device.cmd_clear_color_image(
                    commands,
                    image.raw,
                    write,
                    &zero,
                    &[image.full_range()],
                );
            }
        }
        self.record_transition(
            commands,
            [true; TEXTURE_COUNT],
            write,
            vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
        );
    }

    /// Records layout transitions of some images, after their uses in the first layout.
    pub(crate) fn record_transition(
        &self,
        commands: vk::CommandBuffer,
        textures: TextureSet,
        from: vk::ImageLayout,
        to: vk::ImageLayout,
    ) {
        let (from_stage, to_stage) = (stage_and_access(from).0, stage_and_access(to).0);
        let mut barriers = [vk::ImageMemoryBarrier::default(); TEXTURE_COUNT];
        let images = self.images().into_iter().zip(textures).filter(|(_, is)| *is);
        let count = barriers
            .iter_mut()
            .zip(images)
            .map(|(one, (image, _))| *one = image.layout_barrier(from, to))
            .count();
        let none = vk::DependencyFlags::empty();
        // SAFETY: the images are the device's, and in the layout `from` at this point.
        unsafe {
            self.gpu.device.cmd_pipeline_barrier(
                commands,
                from_stage,
                to_stage,
                none,
                &[],
                &[],
                &barriers[..count],
            );
        }
    }
}

/// Returns the format of a column's texel: two bytes for each interval. The four bytes of two intervals are
/// one component, so that a fetch returns one register, not four.
const fn maps_format(volume: VolumeFormat) -> vk::Format {
    match volume.intervals() {
        1 => vk::Format::R8G8_UINT,
        _ => vk::Format::R32_UINT,
    }
}

/// Creates a sampler without mip filtering, with one address mode for all axes.
fn create_sampler(
    gpu: &Arc<Gpu>,
    filter: vk::Filter,
    address_mode: vk::SamplerAddressMode,
) -> Result<OwnedHandle<vk::Sampler>, Error> {
    let info = vk::SamplerCreateInfo::default()
        .mag_filter(filter)
        .min_filter(filter)
        .mipmap_mode(vk::SamplerMipmapMode::NEAREST)
        .address_mode_u(address_mode)
        .address_mode_v(address_mode)
        .address_mode_w(address_mode)
        .max_lod(vk::LOD_CLAMP_NONE);
    // SAFETY: the device is alive and the info complete.
    let raw = unsafe { gpu.device.create_sampler(&info, None) }.could_not("make a sampler")?;
    Ok(OwnedHandle::new(gpu, raw))
}
