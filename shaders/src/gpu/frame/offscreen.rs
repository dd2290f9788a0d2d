//! Offscreen render targets, and readback to the host.

use std::sync::Arc;

use ash::vk;

use super::renderer::Renderer;
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::Error;
use crate::gpu::device::format::TargetFormat;
use crate::gpu::device::submit::submit_and_wait;
use crate::gpu::memory::buffer::Buffer;
use crate::gpu::memory::image::{GpuImage, ImageSpec, aspect_of};
use crate::gpu::memory::textures::TEXTURE_COUNT;
use crate::gpu::passes::target::RenderTarget;
use crate::upload::Region;

/// A colour image with a layer for each view, and a depth image if depth is kept.
pub struct OffscreenTarget {
    /// The render target, of one image.
    pub target: RenderTarget,
    gpu: Arc<Gpu>,
    color: GpuImage,
    depth: Option<GpuImage>,
}

impl core::fmt::Debug for OffscreenTarget {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("OffscreenTarget").field("target", &self.target).finish_non_exhaustive()
    }
}

impl OffscreenTarget {
    /// Returns the format of targets that are read back.
    #[must_use]
    pub const fn readback_format(samples: u32, views: u32, keep_depth: bool) -> TargetFormat {
        TargetFormat {
            color: vk::Format::R8G8B8A8_SRGB,
            samples,
            views,
            final_layout: vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
            keep_depth,
            density_map: false,
            is_subsampled: false,
            scales_up: false,
        }
    }

    /// Creates images of `extent` pixels for a renderer of the format
    /// [`OffscreenTarget::readback_format`].
    ///
    /// # Errors
    /// A call that failed.
    pub fn new(
        gpu: &Arc<Gpu>,
        readback_renderer: &Renderer,
        extent: [u32; 2],
    ) -> Result<Self, Error> {
        let format = readback_renderer.format();
        let back = vk::ImageUsageFlags::TRANSFER_SRC;
        let mut usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | back;
        if format.scales_up {
            usage |= vk::ImageUsageFlags::TRANSFER_DST;
        }
        let shape = ImageSpec::new_2d(format.color, extent, format.views);
        let color = GpuImage::new(gpu, shape.with_usage(usage))?;
        let depth = match format.keep_depth {
            true => {
                let shape = ImageSpec {
                    samples: format.sample_count(),
                    ..ImageSpec::new_2d(TargetFormat::choose_depth(gpu), extent, format.views)
                };
                let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | back;
                Some(GpuImage::new(gpu, shape.with_usage(usage))?)
            }
            false => None,
        };
        let depths: Vec<_> = depth.iter().map(|depth| depth.view).collect();
        let views = [color.view];
        let target = match format.scales_up {
            true => readback_renderer.create_target_that_scales_up(extent, &[color.raw], &views)?,
            false => {
                readback_renderer.create_target_without_density_maps(extent, &views, &depths)?
            }
        };
        Ok(OffscreenTarget { target, gpu: gpu.clone(), color, depth })
    }

    /// Reads the sRGB pixels of a view back, as red, green, blue, alpha. Waits for the queue.
    ///
    /// # Errors
    /// A lost device.
    pub fn read_pixels(&self, view: u32) -> Result<Vec<[u8; 4]>, Error> {
        let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        let bytes = self.read_image(&self.color, layout, view)?;
        Ok(bytemuck::cast_slice(&bytes).to_vec())
    }

    /// Reads the depths of a view back, 1 on the near plane. Returns `None` if depth isn't kept, is
    /// multisampled or isn't in floats.
    ///
    /// # Errors
    /// A lost device.
    pub fn read_depths(&self, view: u32) -> Result<Option<Vec<f32>>, Error> {
        let one = vk::SampleCountFlags::TYPE_1;
        let readable = |depth: &&GpuImage| {
            depth.spec.samples == one && depth.spec.format == vk::Format::D32_SFLOAT
        };
        let Some(depth) = self.depth.as_ref().filter(readable) else { return Ok(None) };
        let layout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
        let bytes = self.read_image(depth, layout, view)?;
        let float = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        Ok(Some(bytes.chunks_exact(4).map(float).collect()))
    }

    /// Reads a region of the sculpture's textures back, once the device is idle. For tests alone.
    ///
    /// # Errors
    /// A lost device, or no memory for the bytes.
    pub fn read_texels(&self, renderer: &Renderer, region: Region) -> Result<Vec<u8>, Error> {
        self.gpu.wait_idle()?;
        let buffer =
            Buffer::new(&self.gpu, region.byte_count(), vk::BufferUsageFlags::TRANSFER_DST)?;
        let textures = &renderer.textures;
        let (image, copy) = textures.buffer_image_copy(&region, 0);
        let (drawn, from) =
            (vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL, vk::ImageLayout::TRANSFER_SRC_OPTIMAL);
        submit_and_wait(&self.gpu, |device, commands| {
            textures.record_transition(commands, [true; TEXTURE_COUNT], drawn, from);
            // SAFETY: the image is in this layout, the region lies within it, and the buffer takes
            // the whole of it.
            unsafe { device.cmd_copy_image_to_buffer(commands, image, from, buffer.raw, &[copy]) };
            textures.record_transition(commands, [true; TEXTURE_COUNT], from, drawn);
        })?;
        Ok(buffer.read().to_vec())
    }

    fn read_image(
        &self,
        image: &GpuImage,
        layout: vk::ImageLayout,
        view: u32,
    ) -> Result<Vec<u8>, Error> {
        let [width, height, _] = image.spec.extent;
        let (raw, format) = (image.raw, image.spec.format);
        read_layer(
            &self.gpu,
            &ImageLayer { raw, format, extent: [width, height], layout, index: view },
        )
    }
}

/// A layer of an image of one level and four bytes a pixel, with transfer source usage.
#[derive(Clone, Copy, Debug)]
pub struct ImageLayer {
    /// The image.
    pub raw: vk::Image,
    /// The image's format.
    pub format: vk::Format,
    /// Pixels across and down.
    pub extent: [u32; 2],
    /// The layer's image layout, restored after the copy.
    pub layout: vk::ImageLayout,
    /// Index of the layer.
    pub index: u32,
}

/// Reads the bytes of a layer back, row by row. Waits for the queue.
///
/// # Errors
/// A lost device.
pub fn read_layer(gpu: &Arc<Gpu>, layer: &ImageLayer) -> Result<Vec<u8>, Error> {
    let [width, height] = layer.extent;
    let size = width as usize * height as usize * 4;
    let buffer = Buffer::new(gpu, size, vk::BufferUsageFlags::TRANSFER_DST)?;
    let copy = copy_of_layer(layer);
    let from = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
    submit_and_wait(gpu, |device, commands| {
        record_layer_transition(device, commands, layer, [layer.layout, from]);
        // SAFETY: the buffer takes the whole layer.
        unsafe { device.cmd_copy_image_to_buffer(commands, layer.raw, from, buffer.raw, &[copy]) };
        record_layer_transition(device, commands, layer, [from, layer.layout]);
    })?;
    Ok(buffer.read().to_vec())
}

/// Overwrites all pixels of an image layer, and leaves the layer in `layer.layout`. Waits for the queue.
///
/// # Errors
/// A lost device.
pub fn write_layer(gpu: &Arc<Gpu>, layer: &ImageLayer, bytes: &[u8]) -> Result<(), Error> {
    let mut buffer = Buffer::new(gpu, bytes.len(), vk::BufferUsageFlags::TRANSFER_SRC)?;
    buffer.write(0, bytes);
    let copy = copy_of_layer(layer);
    let to = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
    submit_and_wait(gpu, |device, commands| {
        record_layer_transition(device, commands, layer, [vk::ImageLayout::UNDEFINED, to]);
        // SAFETY: the buffer holds the whole layer, and lives until the wait is over.
        unsafe { device.cmd_copy_buffer_to_image(commands, buffer.raw, layer.raw, to, &[copy]) };
        record_layer_transition(device, commands, layer, [to, layer.layout]);
    })
}

/// Returns the copy between a whole layer and a buffer that holds it row by row.
fn copy_of_layer(layer: &ImageLayer) -> vk::BufferImageCopy {
    let [width, height] = layer.extent;
    vk::BufferImageCopy {
        image_subresource: vk::ImageSubresourceLayers {
            aspect_mask: aspect_of(layer.format),
            mip_level: 0,
            base_array_layer: layer.index,
            layer_count: 1,
        },
        image_extent: vk::Extent3D { width, height, depth: 1 },
        ..vk::BufferImageCopy::default()
    }
}

/// Records a layout transition of a layer, with a full barrier.
fn record_layer_transition(
    device: &ash::Device,
    commands: vk::CommandBuffer,
    layer: &ImageLayer,
    [old, new]: [vk::ImageLayout; 2],
) {
    if old == new {
        return;
    }
    let range = vk::ImageSubresourceRange {
        aspect_mask: aspect_of(layer.format),
        base_mip_level: 0,
        level_count: 1,
        base_array_layer: layer.index,
        layer_count: 1,
    };
    let barrier = vk::ImageMemoryBarrier::default()
        .image(layer.raw)
        .subresource_range(range)
        .old_layout(old)
        .new_layout(new)
        .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
        .dst_access_mask(vk::AccessFlags::MEMORY_READ | vk::AccessFlags::MEMORY_WRITE)
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED);
    let all = vk::PipelineStageFlags::ALL_COMMANDS;
    let none = vk::DependencyFlags::empty();
    // SAFETY: the layer is in the old layout at this point.
    unsafe { device.cmd_pipeline_barrier(commands, all, all, none, &[], &[], &[barrier]) };
}
