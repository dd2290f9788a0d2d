//! The render targets of both eyes: a colour swapchain of two array layers, a depth swapchain if requested,
//! and the projection layer that submits them to the compositor.

use std::sync::Arc;

use ash::vk;
use openxr as xr;
use paros_shaders::gpu::{self, Gpu, ImageLayer, RenderTarget, Renderer, TargetFormat, read_layer};
use paros_shell::headset::resolution::ResolutionPolicy;

use super::swapchain::{EyeSwapchain, SwapchainSpec};
use super::{HeadsetSession, Runtime};
use crate::error::{CallContext, Error};
use crate::foveation::Foveation;

/// Both eyes' images, and the surface that the renderer draws into.
pub(crate) struct EyeTargets {
    gpu: Arc<Gpu>,
    // Declared first, as it must be dropped before its images.
    pub(crate) surface: RenderTarget,
    color: EyeSwapchain,
    depth: Option<EyeSwapchain>,
    extent: [u32; 2],
    format: vk::Format,
    layout: vk::ImageLayout,
    /// The foveation that was set last.
    foveation: Option<Foveation>,
    /// The extent in pixels that the runtime recommends for the next frame, if it does.
    recommended: Option<[u32; 2]>,
}

/// The swapchains of both eyes, before there is a renderer.
pub(crate) struct EyeImages {
    color: EyeSwapchain,
    depth: Option<EyeSwapchain>,
    extent: [u32; 2],
}

/// The pixels of both eyes, left and right.
pub(crate) struct FrameCapture {
    /// Pixels across and down.
    pub(crate) extent: [u32; 2],
    /// Red, green and blue of each pixel, for each eye.
    pub(crate) eyes: [Vec<u8>; 2],
}

/// The sRGB formats that the renderer draws in.
const SRGB_FORMATS: [vk::Format; 2] = [vk::Format::R8G8B8A8_SRGB, vk::Format::B8G8R8A8_SRGB];

/// Chooses the colour format of the notice's pictures, in the same way as [`EyeTargets::choose_format`].
///
/// # Errors
/// [`Error::Unavailable`] if the runtime offers no sRGB format, or a call that failed.
pub(super) fn choose_color_format(session: &xr::Session<xr::Vulkan>) -> Result<vk::Format, Error> {
    find_srgb_format(&session.enumerate_swapchain_formats().could_not("list image formats")?)
}

fn find_srgb_format(formats: &[u32]) -> Result<vk::Format, Error> {
    let formats = formats.iter().map(|format| vk::Format::from_raw(format.cast_signed()));
    formats
        .into_iter()
        .find(|format| SRGB_FORMATS.contains(format))
        .ok_or_else(|| Error::Unavailable("the OpenXR runtime takes no sRGB pictures".into()))
}

impl EyeImages {
    /// Creates swapchains of the recommended extent and this format. `capturable` images can be read back,
    /// unless they are subsampled.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn create(
        runtime: &Runtime,
        session: &xr::Session<xr::Vulkan>,
        gpu: &Arc<Gpu>,
        format: &TargetFormat,
        capturable: bool,
    ) -> Result<Self, Error> {
        let sampled = xr::SwapchainUsageFlags::SAMPLED;
        let mut color = SwapchainSpec {
            extent: runtime.extent,
            format: format.color,
            aspect: vk::ImageAspectFlags::COLOR,
            usage: xr::SwapchainUsageFlags::COLOR_ATTACHMENT | sampled,
            with_density_maps: format.density_map,
            prefers_subsampled: format.density_map && runtime.can_subsample(),
        };
        if capturable && !color.prefers_subsampled {
            color.usage |= xr::SwapchainUsageFlags::TRANSFER_SRC;
        }
        let depth = SwapchainSpec {
            format: TargetFormat::choose_depth(gpu),
            aspect: vk::ImageAspectFlags::DEPTH,
            usage: xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT | sampled,
            with_density_maps: false,
            prefers_subsampled: false,
            ..color
        };
        let color = EyeSwapchain::create(session, gpu, &color)?;
        let depth =
            format.keep_depth.then(|| EyeSwapchain::create(session, gpu, &depth)).transpose()?;
        Ok(EyeImages { color, depth, extent: runtime.extent })
    }

    /// Returns `true` if the runtime provided density maps for the images.
    pub(crate) const fn have_density_maps(&self) -> bool {
        self.color.has_density_maps()
    }

    /// Returns `true` if the images are subsampled by their density maps.
    pub(crate) const fn are_subsampled(&self) -> bool {
        self.color.is_subsampled
    }
}

impl EyeTargets {
    /// Chooses the renderer's format for a session: the first sRGB format in the runtime's order of
    /// preference. If depth is submitted, pixels have one sample, as multisampled depth can't be resolved.
    ///
    /// # Errors
    /// [`Error::Unavailable`] if the runtime offers no sRGB format, or a call that failed.
    pub(crate) fn choose_format(
        session: &xr::Session<xr::Vulkan>,
        gpu: &Gpu,
        with_depth: bool,
        samples: u32,
    ) -> Result<TargetFormat, Error> {
        let formats = session.enumerate_swapchain_formats().could_not("list image formats")?;
        let has = |format: vk::Format| formats.contains(&format.as_raw().cast_unsigned());
        let color = find_srgb_format(&formats)?;
        let keep_depth = with_depth && has(TargetFormat::choose_depth(gpu));
        Ok(TargetFormat {
            color,
            samples: match keep_depth {
                true => 1,
                false if TargetFormat::has_samples(gpu, samples) => samples,
                false => 4,
            },
            views: 2,
            final_layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
            keep_depth,
            density_map: gpu.features.density_map,
            is_subsampled: false,
            scales_up: false,
        })
    }

    /// Creates the render target from images, for a renderer of the same format.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn from_images(images: EyeImages, renderer: &Renderer) -> Result<Self, Error> {
        let EyeImages { color, depth, extent } = images;
        let format = renderer.format();
        let surface = match &depth {
            // A framebuffer for each pair of a colour and a depth image.
            Some(depth) => {
                let of = |views: &[vk::ImageView]| views.repeat(depth.views.len());
                let each = depth.views.iter().flat_map(|depth| color.views.iter().map(|_| *depth));
                let depths: Vec<_> = each.collect();
                let (colors, maps) = (of(&color.views), of(&color.density_views));
                renderer.create_target_with_density_maps(extent, &colors, &depths, &maps)?
            }
            None => renderer.create_target_with_density_maps(
                extent,
                &color.views,
                &[],
                &color.density_views,
            )?,
        };
        let (gpu, format, layout) = (color.gpu.clone(), format.color, format.final_layout);
        let (foveation, recommended) = (None, None);
        Ok(EyeTargets {
            gpu,
            surface,
            color,
            depth,
            extent,
            format,
            layout,
            foveation,
            recommended,
        })
    }

    /// Returns `true` if foveation must be set: the images have density maps, and `wanted` differs from the
    /// last setting. Before the first setting the level is the runtime's own, which needn't be NONE.
    pub(crate) fn needs_foveation(&self, wanted: Foveation) -> bool {
        self.color.has_density_maps() && self.foveation != Some(wanted)
    }

    /// Sets the foveation of the following frames. A level that failed isn't tried again.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn set_foveation(
        &mut self,
        session: &xr::Session<xr::Vulkan>,
        wanted: Foveation,
    ) -> Result<(), Error> {
        self.foveation = Some(wanted);
        self.color.set_foveation(session, wanted)
    }

    /// Sets the extent that is drawn from the next frame on, by the policy or the runtime's recommendation.
    pub(crate) fn choose_drawn_extent(&mut self, policy: &ResolutionPolicy) {
        self.surface.set_drawn_extent(policy.drawn_extent(self.extent, self.recommended));
    }

    /// Acquires the next images, and waits for them. Returns the index of the surface's framebuffer to draw into.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn acquire_framebuffer(&mut self) -> Result<usize, Error> {
        let color = self.color.acquire_and_wait_image()?;
        match &mut self.depth {
            Some(depth) => Ok(depth.acquire_and_wait_image()? * self.color.images.len() + color),
            None => Ok(color),
        }
    }

    /// Releases the drawn images to the compositor.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn release_images(&mut self) -> Result<(), Error> {
        self.color.handle.release_image().could_not("hand over a picture")?;
        match &mut self.depth {
            Some(depth) => depth.handle.release_image().could_not("hand over a picture's depth"),
            None => Ok(()),
        }
    }

    /// Reads back the drawn part of the last image, before it is released.
    ///
    /// # Errors
    /// Subsampled images, which can't be read back, or a lost device.
    pub(crate) fn capture_frame(&self, framebuffer: usize) -> Result<FrameCapture, Error> {
        if self.color.is_subsampled {
            return Err(Error::Input("subsampled pictures can't be read back".into()));
        }
        let raw = self.color.images[framebuffer % self.color.images.len()];
        let (format, extent, layout) = (self.format, self.extent, self.layout);
        let blue_first = format == vk::Format::B8G8R8A8_SRGB;
        let drawn = self.surface.drawn_extent();
        let [row, width, height] = [extent[0], drawn[0], drawn[1]].map(|pixels| pixels as usize);
        let eye = |number| -> Result<Vec<u8>, gpu::Error> {
            let bytes =
                read_layer(&self.gpu, &ImageLayer { raw, format, extent, layout, index: number })?;
            let rgb = |p: &[u8]| if blue_first { [p[2], p[1], p[0]] } else { [p[0], p[1], p[2]] };
            let rows = bytes.chunks_exact(4 * row).take(height);
            let pixels = rows.flat_map(|row| row[..4 * width].chunks_exact(4));
            Ok(pixels.flat_map(rgb).collect())
        };
        Ok(FrameCapture { extent: drawn, eyes: [eye(0)?, eye(1)?] })
    }

    /// Ends a frame with a projection layer of these views, and queries the recommended extent of the next
    /// frame.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn end_frame(
        &mut self,
        session: &mut HeadsetSession,
        display_time: xr::Time,
        blend_mode: xr::EnvironmentBlendMode,
        views: &[xr::sys::View; 2],
    ) -> Result<(), Error> {
        let depths = self.depth.as_ref().map(|depth| [0, 1].map(|eye| self.depth_info(depth, eye)));
        let next = |eye: usize| {
            depths.as_ref().map_or(core::ptr::null(), |infos| (&raw const infos[eye]).cast())
        };
        let views = [0, 1].map(|eye| {
            let raw = xr::sys::CompositionLayerProjectionView {
                ty: xr::sys::CompositionLayerProjectionView::TYPE,
                next: next(eye),
                pose: views[eye].pose,
                fov: views[eye].fov,
                sub_image: self.sub_image(&self.color, eye),
            };
            // SAFETY: the swapchains and what `next` points to live until the frame's end.
            unsafe { xr::CompositionLayerProjectionView::from_raw(raw) }
        });
        let HeadsetSession { stream, room, raw, .. } = session;
        let layer = xr::CompositionLayerProjection::new().space(room).views(&views);
        stream.end(display_time, blend_mode, &[&layer]).could_not("end a frame")?;
        let recommended = recommended_extent(raw, &layer, display_time);
        self.recommended = recommended;
        Ok(())
    }

    fn sub_image(&self, swapchain: &EyeSwapchain, eye: usize) -> xr::sys::SwapchainSubImage {
        let [width, height] = self.surface.drawn_extent().map(u32::cast_signed);
        xr::sys::SwapchainSubImage {
            swapchain: swapchain.handle.as_raw(),
            image_rect: xr::Rect2Di {
                offset: xr::Offset2Di { x: 0, y: 0 },
                extent: xr::Extent2Di { width, height },
            },
            image_array_index: eye as u32,
        }
    }

    /// Returns the depth info of an eye. Depth is reversed, 1 on the near plane, so near and far are swapped.
    fn depth_info(
        &self,
        depth: &EyeSwapchain,
        eye: usize,
    ) -> xr::sys::CompositionLayerDepthInfoKHR {
        let [near, far] = gpu::Eye::PLANES;
        xr::sys::CompositionLayerDepthInfoKHR {
            ty: xr::sys::CompositionLayerDepthInfoKHR::TYPE,
            next: core::ptr::null(),
            sub_image: self.sub_image(depth, eye),
            min_depth: 0.0,
            max_depth: 1.0,
            near_z: far,
            far_z: near,
        }
    }
}

/// Returns the extent that the runtime recommends for the next frame's layer, in pixels
/// (`XR_META_recommended_layer_resolution`); `None` without the extension or without a recommendation.
fn recommended_extent(
    session: &xr::Session<xr::Vulkan>,
    layer: &xr::CompositionLayerProjection<'_, xr::Vulkan>,
    display_time: xr::Time,
) -> Option<[u32; 2]> {
    let functions = session.instance().exts().meta_recommended_layer_resolution.as_ref()?;
    let info = xr::sys::RecommendedLayerResolutionGetInfoMETA {
        ty: xr::sys::RecommendedLayerResolutionGetInfoMETA::TYPE,
        next: core::ptr::null(),
        layer: core::ptr::from_ref(layer.as_raw()).cast(),
        predicted_display_time: display_time,
    };
    let mut told = xr::sys::RecommendedLayerResolutionMETA {
        ty: xr::sys::RecommendedLayerResolutionMETA::TYPE,
        next: core::ptr::null_mut(),
        recommended_image_dimensions: xr::Extent2Di::default(),
        is_valid: xr::sys::FALSE,
    };
    // SAFETY: the session is alive, the layer and what it points to live until the call returns, and there is room
    // for the answer.
    let result =
        unsafe { (functions.get_recommended_layer_resolution)(session.as_raw(), &info, &mut told) };
    let is_told = result == xr::sys::Result::SUCCESS && told.is_valid == xr::sys::TRUE;
    let xr::Extent2Di { width, height } = told.recommended_image_dimensions;
    let pixels = [width, height].map(|pixels| u32::try_from(pixels).unwrap_or(0));
    (is_told && pixels.iter().all(|pixels| *pixels > 0)).then_some(pixels)
}
