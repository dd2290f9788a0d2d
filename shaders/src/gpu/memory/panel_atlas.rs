//! The panels' atlas on the device: written once.

use std::sync::Arc;

use ash::vk;

use super::buffer::Buffer;
use super::image::{GpuImage, ImageSpec};
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::Error;
use crate::gpu::device::submit::submit_and_wait;
use crate::panel::{ATLAS_SIZE, atlas_texels};

/// Creates the atlas and uploads its distances. Waits for the queue.
pub(crate) fn create_panel_atlas(gpu: &Arc<Gpu>) -> Result<GpuImage, Error> {
    let spec = ImageSpec::new_2d(vk::Format::R8_UNORM, ATLAS_SIZE, 1);
    create_filled_image(gpu, spec, atlas_texels())
}

/// Creates an image that programs sample, filled with these texels, layer by layer. Waits for the queue.
pub(super) fn create_filled_image(
    gpu: &Arc<Gpu>,
    spec: ImageSpec,
    texels: &[u8],
) -> Result<GpuImage, Error> {
    let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
    let image = GpuImage::new(gpu, spec.with_usage(usage))?;
    let mut staged = Buffer::new(gpu, texels.len(), vk::BufferUsageFlags::TRANSFER_SRC)?;
    staged.write(0, texels);
    let [width, height, depth] = spec.extent;
    let copy = vk::BufferImageCopy {
        image_subresource: vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            layer_count: spec.layers,
            ..vk::ImageSubresourceLayers::default()
        },
        image_extent: vk::Extent3D { width, height, depth },
        ..vk::BufferImageCopy::default()
    };
    let (new, write, read) = (
        vk::ImageLayout::UNDEFINED,
        vk::ImageLayout::TRANSFER_DST_OPTIMAL,
        vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
    );
    submit_and_wait(gpu, |device, commands| {
        image.record_transition(commands, new, write);
        // SAFETY: the image is in this layout, and as large as the buffer; both live until the wait is over.
        unsafe { device.cmd_copy_buffer_to_image(commands, staged.raw, image.raw, write, &[copy]) };
        image.record_transition(commands, write, read);
    })?;
    Ok(image)
}
