//! The panels' atlas on the device: written once.

use std::sync::Arc;

use ash::vk;

use super::buffer::Buffer;
use super::image::{GpuImage, ImageSpec, stage_and_access};
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::Error;
use crate::gpu::device::submit::submit_and_wait;
use crate::panel::{ATLAS_SIZE, atlas_texels};

/// Creates the atlas and uploads its distances. Waits for the queue.
pub(crate) fn create_panel_atlas(gpu: &Arc<Gpu>) -> Result<GpuImage, Error> {
    let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
    let spec = ImageSpec::new_2d(vk::Format::R8_UNORM, ATLAS_SIZE, 1).with_usage(usage);
    let atlas = GpuImage::new(gpu, spec)?;
    let texels = atlas_texels();
    let mut staged = Buffer::new(gpu, texels.len(), vk::BufferUsageFlags::TRANSFER_SRC)?;
    staged.write(0, texels);
    let [width, height] = ATLAS_SIZE;
    let copy = vk::BufferImageCopy {
        image_subresource: vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            layer_count: 1,
            ..vk::ImageSubresourceLayers::default()
        },
        image_extent: vk::Extent3D { width, height, depth: 1 },
        ..vk::BufferImageCopy::default()
    };
    let (new, write, read) = (
        vk::ImageLayout::UNDEFINED,
        vk::ImageLayout::TRANSFER_DST_OPTIMAL,
        vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
    );
    submit_and_wait(gpu, |device, commands| {
        let transition = |from, to| {
            let stages = [from, to].map(|layout| stage_and_access(layout).0);
            let (barrier, none) = ([atlas.layout_barrier(from, to)], vk::DependencyFlags::empty());
            // SAFETY: the atlas is in the layout `from` at this point.
            unsafe {
                device.cmd_pipeline_barrier(
                    commands,
                    stages[0],
                    stages[1],
                    none,
                    &[],
                    &[],
                    &barrier,
                );
            }
        };
        transition(new, write);
        // SAFETY: the atlas is in this layout, and as large as the buffer; both live until the wait is over.
        unsafe { device.cmd_copy_buffer_to_image(commands, staged.raw, atlas.raw, write, &[copy]) };
        transition(write, read);
    })?;
    Ok(atlas)
}
