//! A picture that is drawn aside, in fewer pixels, and scaled up into the shell's image.

use std::sync::Arc;

use ash::vk;

use super::render_pass::{RenderPass, create_framebuffer};
use crate::gpu::device::context::Gpu;
use crate::gpu::device::error::Error;
use crate::gpu::device::format::TargetFormat;
use crate::gpu::device::owned::OwnedHandle;
use crate::gpu::memory::image::{GpuImage, ImageSpec};

/// The shell's images, of one layer each, and the image in which pictures for them are drawn.
pub(crate) struct ScaledPicture {
    gpu: Arc<Gpu>,
    pub(crate) drawn: GpuImage,
    images: Vec<vk::Image>,
    /// For the overlay's pass, as many as there are images.
    pub(crate) overlay_framebuffers: Vec<OwnedHandle<vk::Framebuffer>>,
}

impl ScaledPicture {
    /// Makes the image aside, of `extent` pixels as the shell's.
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
        let (gpu, images) = (gpu.clone(), images.to_vec());
        Ok(ScaledPicture { gpu, drawn, images, overlay_framebuffers: framebuffers })
    }

    /// Records the scaling of the picture's first `drawn` pixels to an image of the shell's, which the overlay's pass
    /// draws on then. The frame's pass has left the picture to be copied.
    pub(crate) fn record(&self, commands: vk::CommandBuffer, image_index: usize, drawn: [u32; 2]) {
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
        // The image is waited for where colour is put out.
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
