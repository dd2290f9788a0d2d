//! Images of our own to draw into, for pictures without a window, and their way back to the host.

use std::sync::Arc;

use ash::vk;

use super::buffer::Buffer;
use super::context::Gpu;
use super::error::{Doing, Error};
use super::image::{Image, Shape, aspect};
use super::pass::Format;
use super::renderer::Renderer;
use super::surface::Surface;

/// A colour image with as many layers as there are views, and depth beside it if that is kept.
pub struct Offscreen {
    /// What a renderer draws into: the image of number 0.
    pub surface: Surface,
    gpu: Arc<Gpu>,
    color: Image,
    depth: Option<Image>,
}

impl core::fmt::Debug for Offscreen {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Offscreen").field("surface", &self.surface).finish_non_exhaustive()
    }
}

impl Offscreen {
    /// The format for pictures that are read back.
    #[must_use]
    pub const fn format(samples: u32, views: u32, keep_depth: bool) -> Format {
        Format {
            color: vk::Format::R8G8B8A8_SRGB,
            samples,
            views,
            final_layout: vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
            keep_depth,
        }
    }

    /// Images of a size for a renderer whose format is [`Offscreen::format`]'s.
    ///
    /// # Errors
    /// A call that failed.
    pub fn new(gpu: &Arc<Gpu>, renderer: &Renderer, extent: [u32; 2]) -> Result<Self, Error> {
        let format = renderer.format();
        let back = vk::ImageUsageFlags::TRANSFER_SRC;
        let shape = Shape::flat(format.color, extent, format.views);
        let color = Image::new(gpu, shape.usage(vk::ImageUsageFlags::COLOR_ATTACHMENT | back))?;
        let depth = match format.keep_depth {
            true => {
                let shape = Shape {
                    samples: format.count(),
                    ..Shape::flat(Format::depth(gpu), extent, format.views)
                };
                let usage = vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | back;
                Some(Image::new(gpu, shape.usage(usage))?)
            }
            false => None,
        };
        let depths: Vec<_> = depth.iter().map(|depth| depth.view).collect();
        let surface = renderer.surface(extent, &[color.view], &depths)?;
        Ok(Offscreen { surface, gpu: gpu.clone(), color, depth })
    }

    /// The pixels of a view once the device is done: red, green, blue, alpha.
    ///
    /// # Errors
    /// A lost device.
    pub fn pixels(&self, view: u32) -> Result<Vec<[u8; 4]>, Error> {
        let layout = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
        let bytes = self.read(&self.color, layout, view)?;
        Ok(bytemuck::cast_slice(&bytes).to_vec())
    }

    /// The depth of each pixel of a view, 1 on the near plane; none if it isn't kept, has several
    /// samples or isn't made of floats.
    ///
    /// # Errors
    /// A lost device.
    pub fn depths(&self, view: u32) -> Result<Option<Vec<f32>>, Error> {
        let one = vk::SampleCountFlags::TYPE_1;
        let readable = |depth: &&Image| {
            depth.shape.samples == one && depth.shape.format == vk::Format::D32_SFLOAT
        };
        let Some(depth) = self.depth.as_ref().filter(readable) else { return Ok(None) };
        let layout = vk::ImageLayout::DEPTH_STENCIL_ATTACHMENT_OPTIMAL;
        let bytes = self.read(depth, layout, view)?;
        let float = |bytes: &[u8]| f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
        Ok(Some(bytes.chunks_exact(4).map(float).collect()))
    }

    fn read(&self, image: &Image, layout: vk::ImageLayout, view: u32) -> Result<Vec<u8>, Error> {
        let [width, height, _] = image.shape.extent;
        let (raw, format) = (image.raw, image.shape.format);
        read_layer(&self.gpu, &Layer { raw, format, extent: [width, height], layout, number: view })
    }
}

/// A layer of an image of one level, of four bytes a pixel, that may be copied from.
#[derive(Clone, Copy, Debug)]
pub struct Layer {
    /// The image.
    pub raw: vk::Image,
    /// Its format.
    pub format: vk::Format,
    /// Pixels across and down.
    pub extent: [u32; 2],
    /// The layout it is in, and will be in again.
    pub layout: vk::ImageLayout,
    /// The number of the layer.
    pub number: u32,
}

/// The bytes of a layer, row by row, once the device is done with all it was given. For looking at
/// single pictures, as it waits.
///
/// # Errors
/// A lost device.
pub fn read_layer(gpu: &Arc<Gpu>, layer: &Layer) -> Result<Vec<u8>, Error> {
    let [width, height] = layer.extent;
    let size = width as usize * height as usize * 4;
    let buffer = Buffer::new(gpu, size, vk::BufferUsageFlags::TRANSFER_DST)?;
    let subresource = vk::ImageSubresourceLayers {
        aspect_mask: aspect(layer.format),
        mip_level: 0,
        base_array_layer: layer.number,
        layer_count: 1,
    };
    let copy = vk::BufferImageCopy {
        image_subresource: subresource,
        image_extent: vk::Extent3D { width, height, depth: 1 },
        ..vk::BufferImageCopy::default()
    };
    let from = vk::ImageLayout::TRANSFER_SRC_OPTIMAL;
    once(gpu, |device, commands| {
        turn(device, commands, layer, [layer.layout, from]);
        // SAFETY: the buffer takes the whole layer.
        unsafe { device.cmd_copy_image_to_buffer(commands, layer.raw, from, buffer.raw, &[copy]) };
        turn(device, commands, layer, [from, layer.layout]);
    })?;
    Ok(buffer.read().to_vec())
}

/// Brings a layer from one layout to another, after all that was done and before all that follows.
fn turn(
    device: &ash::Device,
    commands: vk::CommandBuffer,
    layer: &Layer,
    [old, new]: [vk::ImageLayout; 2],
) {
    if old == new {
        return;
    }
    let range = vk::ImageSubresourceRange {
        aspect_mask: aspect(layer.format),
        base_mip_level: 0,
        level_count: 1,
        base_array_layer: layer.number,
        layer_count: 1,
    };
    let barrier = vk::ImageMemoryBarrier::default()
        .image(layer.raw)
        .subresource_range(range)
        .old_layout(old)
        .new_layout(new)
        .src_access_mask(vk::AccessFlags::MEMORY_WRITE)
        .dst_access_mask(vk::AccessFlags::MEMORY_READ)
        .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
        .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED);
    let all = vk::PipelineStageFlags::ALL_COMMANDS;
    let none = vk::DependencyFlags::empty();
    // SAFETY: the layer is in the old layout at this point.
    unsafe { device.cmd_pipeline_barrier(commands, all, all, none, &[], &[], &[barrier]) };
}

/// Records commands, submits them and waits until they are done.
pub(super) fn once(
    gpu: &Gpu,
    record: impl FnOnce(&ash::Device, vk::CommandBuffer),
) -> Result<(), Error> {
    let device = &gpu.device;
    let info = vk::CommandPoolCreateInfo::default().queue_family_index(gpu.family);
    // SAFETY: the family is the device's; the pool is destroyed below, its buffer with it.
    let pool = unsafe { device.create_command_pool(&info, None) }.doing("make a pool")?;
    let recorded = (|| {
        let info =
            vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
        // SAFETY: the pool is this device's.
        let commands =
            unsafe { device.allocate_command_buffers(&info) }.doing("make a command buffer")?[0];
        let begin = vk::CommandBufferBeginInfo::default();
        // SAFETY: the buffer is new.
        unsafe { device.begin_command_buffer(commands, &begin) }.doing("record")?;
        record(device, commands);
        // SAFETY: the commands are being recorded; the queue is used by one thread.
        unsafe {
            device.end_command_buffer(commands).doing("record")?;
            let buffers = [commands];
            let info = vk::SubmitInfo::default().command_buffers(&buffers);
            device.queue_submit(gpu.queue, &[info], vk::Fence::null()).doing("submit")?;
            device.queue_wait_idle(gpu.queue).doing("wait")
        }
    })();
    // SAFETY: nothing of the pool is under way: the wait passed, or nothing was submitted, or the
    // device is lost.
    unsafe { device.destroy_command_pool(pool, None) };
    recorded
}
