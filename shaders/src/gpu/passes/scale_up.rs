//! A picture that is drawn into an image of its own, in fewer pixels, and scaled up into the shell's image.

use std::sync::Arc;

use ash::vk;

use super::render_pass::{RenderPass, create_framebuffer};
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::Error;
use crate::gpu::device::format::TargetFormat;
use crate::gpu::device::owned::OwnedHandle;
use crate::gpu::memory::image::{GpuImage, ImageSpec};

/// The image that a picture is drawn into, and the shell's images that it is scaled up to. Each has one layer.
pub(crate) struct ScaledPicture {
    gpu: Arc<Gpu>,
    pub(crate) drawn: GpuImage,
    images: Vec<vk::Image>,
    /// The pass that draws the overlay, and its framebuffers, one for each image.
    pub(crate) overlay_pass: vk::RenderPass,
    pub(crate) overlay_framebuffers: Vec<OwnedHandle<vk::Framebuffer>>,
}

impl ScaledPicture {
    /// Creates the picture's image, with `extent` pixels like the shell's images.
    pub(crate) fn new(
        gpu: &Arc<Gpu>,
        format: &TargetFormat,
        overlay_pass: &RenderPass,
        extent: [u32; 2],
        (images, views): (&[vk::Image], &[vk::ImageView]),
    ) -> Result<Self, Error> {
        let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_SRC;
        let drawn =
            GpuImage::new(gpu, ImageSpec::new_2d(format.color, extent, 1).with_usage(usage))?;
        let framebuffers = views
            .iter()
            .map(|view| create_framebuffer(gpu, overlay_pass, extent, &[*view]))
            .collect::<Result<_, _>>()?;
        Ok(ScaledPicture {
            gpu: gpu.clone(),
            drawn,
            images: images.to_vec(),
            overlay_pass: overlay_pass.raw,
            overlay_framebuffers: framebuffers,
        })
    }

    /// Records the scaling of the upper left `drawn` pixels to one of the shell's images. The frame's pass
    /// must come before it, the overlay's after it.
    pub(crate) fn record_scaling(
        &self,
        commands: vk::CommandBuffer,
        image_index: usize,
        drawn: [u32; 2],
    ) {
        let [width, height, _] = self.drawn.spec.extent;
        let corner = |[x, y]: [u32; 2]| vk::Offset3D { x: x as i32, y: y as i32, z: 1 };
        let layer = vk::ImageSubresourceLayers {
            aspect_mask: vk::ImageAspectFlags::COLOR,
            layer_count: 1,
            ..vk::ImageSubresourceLayers::default()
        };
        let first = vk::Offset3D::default();
        let region = vk::ImageBlit::default()
            .src_subresource(layer)
            .src_offsets([first, corner(drawn)])
            .dst_subresource(layer)
            .dst_offsets([first, corner([width, height])]);
        let image = self.images[image_index];
        let written = vk::ImageLayout::TRANSFER_DST_OPTIMAL;
        let (output, transfer) =
            (vk::PipelineStageFlags::COLOR_ATTACHMENT_OUTPUT, vk::PipelineStageFlags::TRANSFER);
        let none = vk::DependencyFlags::empty();
        let barrier = vk::ImageMemoryBarrier::default()
            .image(image)
            .subresource_range(self.drawn.full_range())
            .src_queue_family_index(vk::QUEUE_FAMILY_IGNORED)
            .dst_queue_family_index(vk::QUEUE_FAMILY_IGNORED);
        // A frame waits for its image in the stage of colour output.
        let before = barrier.new_layout(written).dst_access_mask(vk::AccessFlags::TRANSFER_WRITE);
        let after = barrier
            .old_layout(written)
            .new_layout(vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL)
            .src_access_mask(vk::AccessFlags::TRANSFER_WRITE)
            .dst_access_mask(
                vk::AccessFlags::COLOR_ATTACHMENT_READ | vk::AccessFlags::COLOR_ATTACHMENT_WRITE,
            );
        let device = &self.gpu.device;
        // SAFETY: the commands are being recorded outside of a pass, both images are alive, and the regions lie within
        // them.
        unsafe {
            device.cmd_pipeline_barrier(commands, output, transfer, none, &[], &[], &[before]);
            device.cmd_blit_image(
                commands,
                self.drawn.raw,
                vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
                image,
                written,
                &[region],
                vk::Filter::LINEAR,
            );
            device.cmd_pipeline_barrier(commands, transfer, output, none, &[], &[], &[after]);
        }
    }
}
