//! The sculpture's textures on the device, and the copies that keep them up to date.

use std::sync::Arc;

use ash::vk;

use super::context::Gpu;
use super::error::{Doing, Error};
use super::image::{Image, Shape, use_of};
use super::owned::Owned;
use super::scatter::Scatter;
use super::staging::Staging;
use crate::constants::NOISE_SIZE;
use crate::field::cell;
use crate::upload::{Region, Texture};

/// Texels of density around the grid, on each side.
const PAD: u32 = 4;
/// Levels of detail of the density.
pub(super) const LEVELS: u32 = 4;
const STORAGE: vk::ImageUsageFlags = vk::ImageUsageFlags::STORAGE;
/// Empty columns around each range map.
const BORDER: u32 = 1;

/// The textures that a sculpture of N voxels a side is drawn from.
pub(super) struct Textures {
    gpu: Arc<Gpu>,
    pub(super) maps: Image,
    pub(super) density: Image,
    pub(super) cells: Image,
    pub(super) noise: Image,
    pub(super) marble: Image,
    pub(super) clamped: Owned<vk::Sampler>,
    pub(super) repeated: Owned<vk::Sampler>,
    pub(super) nearest: Owned<vk::Sampler>,
    cleared: bool,
}

impl Textures {
    pub(super) fn new(gpu: &Arc<Gpu>, n: u32, marble_side: u32) -> Result<Self, Error> {
        let usage = vk::ImageUsageFlags::SAMPLED
            | vk::ImageUsageFlags::TRANSFER_DST
            | vk::ImageUsageFlags::TRANSFER_SRC;
        let written = match gpu.needs.scatter {
            true => usage | STORAGE,
            false => usage,
        };
        let solid = |format, side: u32, levels, usage| {
            let shape = Shape { extent: [side; 3], levels, ..Shape::flat(format, [side; 2], 1) };
            Image::new(gpu, shape.usage(usage))
        };
        let byte = vk::Format::R8_UNORM;
        let flat = Shape::flat(vk::Format::R8G8_UINT, [n + 2 * BORDER; 2], 3);
        let sampler = |filter, mode| sampler(gpu, filter, mode);
        let (edge, repeat) =
            (vk::SamplerAddressMode::CLAMP_TO_EDGE, vk::SamplerAddressMode::REPEAT);
        Ok(Textures {
            gpu: gpu.clone(),
            maps: Image::new(gpu, flat.usage(usage))?,
            density: solid(byte, n + 2 * PAD, LEVELS, written)?,
            cells: solid(byte, (n + 2 * PAD) / cell(n as usize) as u32, 1, written)?,
            noise: solid(vk::Format::R8_SNORM, NOISE_SIZE as u32, 1, usage)?,
            marble: solid(byte, marble_side, 1, usage)?,
            clamped: sampler(vk::Filter::LINEAR, edge)?,
            repeated: sampler(vk::Filter::LINEAR, repeat)?,
            nearest: sampler(vk::Filter::NEAREST, edge)?,
            cleared: false,
        })
    }

    /// Records what brings over all that is staged in a frame of the ring; the first time, everything
    /// is emptied before. A program writes the boxes that it can, unless some overlap.
    pub(super) fn record(
        &mut self,
        commands: vk::CommandBuffer,
        staging: &Staging,
        scatter: Option<&mut Scatter>,
        frame: usize,
    ) {
        if !self.cleared {
            self.clear(commands);
            self.cleared = true;
        }
        let scatter = scatter.filter(|_| !staging.overlaps());
        let is_written = |region: &Region| scatter.is_some() && Scatter::takes(region);
        let read = vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL;
        let copied = self.touched(staging, |region| !is_written(region));
        if copied.contains(&true) {
            let write = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
            self.transition(commands, copied, read, write);
            self.copy_all(commands, staging, |region| !is_written(region));
            self.transition(commands, copied, write, read);
        }
        let writes = staging.regions.iter().any(|(region, _)| is_written(region));
        if let Some(scatter) = scatter.filter(|_| writes) {
            // Those that the program has bound, whether a box lies in them or not.
            let bound = self.images().map(|image| image.shape.usage.contains(STORAGE));
            self.transition(commands, bound, read, vk::ImageLayout::GENERAL);
            scatter.record(commands, frame, staging);
            self.transition(commands, bound, vk::ImageLayout::GENERAL, read);
        }
    }

    fn copy_all(
        &self,
        commands: vk::CommandBuffer,
        staging: &Staging,
        is_copied: impl Fn(&Region) -> bool,
    ) {
        let mut unordered = 0;
        for (i, (region, at)) in staging.regions.iter().enumerate() {
            if !is_copied(region) {
                continue;
            }
            // Boxes computed one after the other may share a coarser texel, which the later has
            // right; of copies without a barrier between them either may come last.
            let earlier = &staging.regions[unordered..i];
            if earlier.iter().any(|(other, _)| other.overlaps(region)) {
                self.order_copies(commands);
                unordered = i;
            }
            let (image, copy) = self.copy(region, *at);
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

    /// Has copies wait for those before.
    fn order_copies(&self, commands: vk::CommandBuffer) {
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

    /// Which of the images something is staged for, among some regions.
    fn touched(&self, staging: &Staging, among: impl Fn(&Region) -> bool) -> [bool; 5] {
        let holds = |image: &Image, region| self.image(region).0.raw == image.raw;
        let regions = || staging.regions.iter().map(|(region, _)| region).filter(|one| among(one));
        self.images().map(|image| regions().any(|region| holds(image, region)))
    }

    /// The image and the level of a region.
    const fn image(&self, region: &Region) -> (&Image, u32) {
        match region.texture {
            Texture::Maps => (&self.maps, 0),
            Texture::Density(level) => (&self.density, level as u32),
            Texture::Cells => (&self.cells, 0),
            Texture::Noise => (&self.noise, 0),
            Texture::Marble => (&self.marble, 0),
        }
    }

    /// A copy of a region between its texture and bytes at a place in a buffer.
    pub(super) fn copy(&self, region: &Region, at: u64) -> (vk::Image, vk::BufferImageCopy) {
        let (image, level) = self.image(region);
        let ([x, y, z], [width, height, depth]) = (region.min, region.size);
        let is_maps = region.texture == Texture::Maps;
        let (layer, layers, border) = if is_maps { (z, depth, BORDER) } else { (0, 1, 0) };
        let (z, depth) = if is_maps { (0, 1) } else { (z, depth) };
        let copy = vk::BufferImageCopy {
            buffer_offset: at,
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

    fn images(&self) -> [&Image; 5] {
        [&self.maps, &self.density, &self.cells, &self.noise, &self.marble]
    }

    fn clear(&self, commands: vk::CommandBuffer) {
        let write = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        self.transition(commands, [true; 5], vk::ImageLayout::UNDEFINED, write);
        let zero = vk::ClearColorValue { uint32: [0; 4] };
        for image in self.images() {
            // SAFETY: the image is in this layout, and the range is all of it.
            unsafe {
                self.gpu.device.cmd_clear_color_image(
                    commands,
                    image.raw,
                    write,
                    &zero,
                    &[image.range()],
                );
            }
        }
        self.transition(commands, [true; 5], write, vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL);
    }

    /// Brings images from one layout to another, after what used them in the first.
    pub(super) fn transition(
        &self,
        commands: vk::CommandBuffer,
        which: [bool; 5],
        from: vk::ImageLayout,
        to: vk::ImageLayout,
    ) {
        let (from_stage, to_stage) = (use_of(from).0, use_of(to).0);
        let mut barriers = [vk::ImageMemoryBarrier::default(); 5];
        let images = self.images().into_iter().zip(which).filter(|(_, is)| *is);
        let count = barriers
            .iter_mut()
            .zip(images)
            .map(|(one, (image, _))| *one = image.barrier(from, to))
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

fn sampler(
    gpu: &Arc<Gpu>,
    filter: vk::Filter,
    mode: vk::SamplerAddressMode,
) -> Result<Owned<vk::Sampler>, Error> {
    let info = vk::SamplerCreateInfo::default()
        .mag_filter(filter)
        .min_filter(filter)
        .mipmap_mode(vk::SamplerMipmapMode::NEAREST)
        .address_mode_u(mode)
        .address_mode_v(mode)
        .address_mode_w(mode)
        .max_lod(vk::LOD_CLAMP_NONE);
    // SAFETY: the device is alive and the info complete.
    let raw = unsafe { gpu.device.create_sampler(&info, None) }.doing("make a sampler")?;
    Ok(Owned::new(gpu, raw))
}
