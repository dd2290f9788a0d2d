//! The quad layer that shows a notice while there is no studio to draw yet.

use std::path::Path;
use std::sync::Arc;

use ash::vk::{self, Handle as _};
use openxr as xr;
use paros_headset::notice_placement::NoticePlacement;
use paros_headset::start_up::StartNotice;
use paros_shaders::gpu::{Gpu, ImageLayer, read_layer, write_layer};

use super::eyes::choose_color_format;
use super::{convert_location, pose_of};
use crate::error::{CallContext, Error};
use crate::test_commands::write_picture;
use paros_headset::notice_picture::{EXTENT, PIXELS_PER_METRE, draw_notice};

/// A swapchain that shows a notice, and the notice's placement.
pub(crate) struct NoticeLayer {
    swapchain: xr::Swapchain<xr::Vulkan>,
    images: Vec<vk::Image>,
    format: vk::Format,
    /// The space in which the notice hangs: LOCAL, which every runtime supports.
    local: xr::Space,
    head: xr::Space,
    placement: NoticePlacement,
    /// The notice that the last released image shows.
    shown: Option<StartNotice>,
    /// `true` if images are read back, for tests.
    is_captured: bool,
    captured: Vec<u8>,
    gpu: Arc<Gpu>,
}

/// The handles and the blend mode that a frame needs.
pub(crate) struct FrameCalls<'a> {
    pub(crate) waiter: &'a mut xr::FrameWaiter,
    pub(crate) stream: &'a mut xr::FrameStream<xr::Vulkan>,
    pub(crate) blend_mode: xr::EnvironmentBlendMode,
}

impl FrameCalls<'_> {
    /// Waits for the next frame, and submits nothing in it.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn wait_and_run_empty_frame(self) -> Result<(), Error> {
        let frame = self.waiter.wait().could_not("wait for a frame")?;
        self.stream.begin().could_not("begin a frame")?;
        let time = frame.predicted_display_time;
        self.stream.end(time, self.blend_mode, &[]).could_not("end an empty frame")
    }
}

impl NoticeLayer {
    /// Creates the swapchain. Its images are read back if `is_captured`.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn create(
        session: &xr::Session<xr::Vulkan>,
        gpu: &Arc<Gpu>,
        is_captured: bool,
    ) -> Result<Self, Error> {
        let format = choose_color_format(session)?;
        // Released images are in the layout of an attachment.
        let mut usage = xr::SwapchainUsageFlags::COLOR_ATTACHMENT
            | xr::SwapchainUsageFlags::SAMPLED
            | xr::SwapchainUsageFlags::TRANSFER_DST;
        if is_captured {
            usage |= xr::SwapchainUsageFlags::TRANSFER_SRC;
        }
        let [width, height] = EXTENT;
        let info = xr::SwapchainCreateInfo {
            create_flags: xr::SwapchainCreateFlags::EMPTY,
            usage_flags: usage,
            format: format.as_raw().cast_unsigned(),
            sample_count: 1,
            width,
            height,
            face_count: 1,
            array_size: 1,
            mip_count: 1,
        };
        let swapchain = session.create_swapchain(&info).could_not("make a notice's swapchain")?;
        let images = swapchain.enumerate_images().could_not("list a swapchain's images")?;
        let images = images.into_iter().map(vk::Image::from_raw).collect();
        let space = |kind| session.create_reference_space(kind, xr::Posef::IDENTITY);
        let local = space(xr::ReferenceSpaceType::LOCAL).could_not("make a space")?;
        let head = space(xr::ReferenceSpaceType::VIEW).could_not("make a space")?;
        let (placement, gpu) = (NoticePlacement::default(), gpu.clone());
        Ok(NoticeLayer {
            swapchain,
            images,
            format,
            local,
            head,
            placement,
            shown: None,
            is_captured,
            captured: Vec::new(),
            gpu,
        })
    }

    /// Waits for the next frame and submits the notice in it.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn wait_and_run_frame(
        &mut self,
        calls: FrameCalls<'_>,
        notice: &StartNotice,
    ) -> Result<(), Error> {
        let FrameCalls { waiter, stream, blend_mode } = calls;
        let frame = waiter.wait().could_not("wait for a frame")?;
        stream.begin().could_not("begin a frame")?;
        let time = frame.predicted_display_time;
        if !frame.should_render {
            return stream.end(time, blend_mode, &[]).could_not("end an empty frame");
        }
        if self.shown.as_ref() != Some(notice) {
            self.show(notice)?;
        }
        let located = self.head.locate(&self.local, time).could_not("find the head")?;
        let head = convert_location(located.location_flags, located.pose).if_tracked();
        let (position, rotation) = self.placement.observe_head(head);
        let [width, height] = EXTENT;
        let image_rect = xr::Rect2Di {
            offset: xr::Offset2Di { x: 0, y: 0 },
            extent: xr::Extent2Di { width: width.cast_signed(), height: height.cast_signed() },
        };
        let image = xr::SwapchainSubImage::new().swapchain(&self.swapchain).image_rect(image_rect);
        let [width, height] = EXTENT.map(|pixels| pixels as f32 / PIXELS_PER_METRE);
        let layer = xr::CompositionLayerQuad::new()
            .space(&self.local)
            .eye_visibility(xr::EyeVisibility::BOTH)
            .sub_image(image)
            .pose(pose_of((position, rotation)))
            .size(xr::Extent2Df { width, height });
        stream.end(time, blend_mode, &[&layer]).could_not("end a frame")
    }

    /// Draws a notice into the next image, waits until the copy has finished, and releases the image.
    fn show(&mut self, notice: &StartNotice) -> Result<(), Error> {
        let index = self.swapchain.acquire_image().could_not("take an image")? as usize;
        self.swapchain.wait_image(xr::Duration::INFINITE).could_not("wait for an image")?;
        let mut pixels = draw_notice(notice);
        self.exchange_red_and_blue_where_wanted(&mut pixels);
        write_layer(&self.gpu, &self.image_layer(index), &pixels)?;
        if self.is_captured {
            let mut pixels = read_layer(&self.gpu, &self.image_layer(index))?;
            self.exchange_red_and_blue_where_wanted(&mut pixels);
            self.captured =
                pixels.chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect();
        }
        self.swapchain.release_image().could_not("hand over a picture")?;
        self.shown = Some(notice.clone());
        Ok(())
    }

    /// Writes the last released image, as it was read back, to `PREFIX-notice.png`. Does nothing if there is
    /// none.
    ///
    /// # Errors
    /// A file that can't be written.
    pub(crate) fn write_capture(&self, prefix: &Path) -> Result<(), Error> {
        if self.captured.is_empty() {
            return Ok(());
        }
        write_picture(prefix, "notice", EXTENT, &self.captured)
    }

    fn exchange_red_and_blue_where_wanted(&self, pixels: &mut [u8]) {
        if self.format == vk::Format::B8G8R8A8_SRGB {
            pixels.chunks_exact_mut(4).for_each(|pixel| pixel.swap(0, 2));
        }
    }

    fn image_layer(&self, image: usize) -> ImageLayer {
        ImageLayer {
            raw: self.images[image],
            format: self.format,
            extent: EXTENT,
            layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
            index: 0,
        }
    }
}
