//! What both eyes see: a swapchain of two layers, its depth where that is wanted, and the projection
//! layer that hands them to the compositor.

use std::sync::Arc;

use ash::vk;
use openxr as xr;
use paros_shaders::gpu::{self, Format, Gpu, Layer, Renderer, Surface, read_layer};

use super::Runtime;
use super::chain::{Chain, Kind};
use crate::error::{Doing, Error};
use crate::foveation::Foveation;

/// Both eyes' images, and what draws into them.
pub(crate) struct Eyes {
    gpu: Arc<Gpu>,
    // Before the images it is made of.
    pub(crate) surface: Surface,
    color: Chain,
    depth: Option<Chain>,
    extent: [u32; 2],
    format: vk::Format,
    layout: vk::ImageLayout,
    /// As it was asked for last.
    foveation: Foveation,
}

/// Images that nothing draws into yet.
pub(crate) struct Images {
    color: Chain,
    depth: Option<Chain>,
    extent: [u32; 2],
}

/// Pixels of both eyes: left and right, red, green, blue of each.
pub(crate) struct Shot {
    /// Pixels across and down.
    pub(crate) extent: [u32; 2],
    /// Three bytes a pixel, for each eye.
    pub(crate) eyes: [Vec<u8>; 2],
}

/// The formats that hold linear light as a screen wants it.
const COLORS: [vk::Format; 2] = [vk::Format::R8G8B8A8_SRGB, vk::Format::B8G8R8A8_SRGB];

impl Images {
    /// Images of the recommended size and a format. `shots` are to be taken of them.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn new(
        runtime: &Runtime,
        session: &xr::Session<xr::Vulkan>,
        gpu: &Arc<Gpu>,
        format: &Format,
        shots: bool,
    ) -> Result<Self, Error> {
        let sampled = xr::SwapchainUsageFlags::SAMPLED;
        let mut color = Kind {
            extent: runtime.extent,
            format: format.color,
            aspect: vk::ImageAspectFlags::COLOR,
            usage: xr::SwapchainUsageFlags::COLOR_ATTACHMENT | sampled,
            mapped: format.density_map,
        };
        if shots {
            color.usage |= xr::SwapchainUsageFlags::TRANSFER_SRC;
        }
        let depth = Kind {
            format: Format::depth(gpu),
            aspect: vk::ImageAspectFlags::DEPTH,
            usage: xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT | sampled,
            mapped: false,
            ..color
        };
        let color = Chain::new(session, gpu, &color)?;
        let depth = format.keep_depth.then(|| Chain::new(session, gpu, &depth)).transpose()?;
        Ok(Images { color, depth, extent: runtime.extent })
    }

    /// Whether the runtime gave density maps with them.
    pub(crate) const fn are_mapped(&self) -> bool {
        self.color.is_mapped()
    }
}

impl Eyes {
    /// The renderer's format for a session: the first that the runtime would rather have. Depth is
    /// handed over with one sample a pixel, as that of several can't be resolved.
    ///
    /// # Errors
    /// [`Error::Unavailable`] where there is no such format, or a call that failed.
    pub(crate) fn format(
        session: &xr::Session<xr::Vulkan>,
        gpu: &Gpu,
        with_depth: bool,
    ) -> Result<Format, Error> {
        let formats = session.enumerate_swapchain_formats().doing("list image formats")?;
        let has = |format: vk::Format| formats.contains(&format.as_raw().cast_unsigned());
        let color = formats
            .iter()
            .map(|format| vk::Format::from_raw(format.cast_signed()))
            .find(|format| COLORS.contains(format));
        let color = color.ok_or_else(|| {
            Error::Unavailable("the OpenXR runtime takes no sRGB pictures".into())
        })?;
        let keep_depth = with_depth && has(Format::depth(gpu));
        Ok(Format {
            color,
            samples: if keep_depth { 1 } else { 4 },
            views: 2,
            final_layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
            keep_depth,
            density_map: gpu.needs.density_map,
        })
    }

    /// What draws into images, by a renderer of their format.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn new(images: Images, renderer: &Renderer) -> Result<Self, Error> {
        let Images { color, depth, extent } = images;
        let format = renderer.format();
        let surface = match &depth {
            // A framebuffer for each pair of images.
            Some(depth) => {
                let of = |views: &[vk::ImageView]| views.repeat(depth.views.len());
                let each = depth.views.iter().flat_map(|depth| color.views.iter().map(|_| *depth));
                let depths: Vec<_> = each.collect();
                let (colors, maps) = (of(&color.views), of(&color.densities));
                renderer.mapped_surface(extent, &colors, &depths, &maps)?
            }
            None => renderer.mapped_surface(extent, &color.views, &[], &color.densities)?,
        };
        let (gpu, format, layout) = (color.gpu.clone(), format.color, format.final_layout);
        let foveation = Foveation::Off;
        Ok(Eyes { gpu, surface, color, depth, extent, format, layout, foveation })
    }

    /// How coarsely they are shaded away from the middle, as it was asked for last; `None` where
    /// that can't be said.
    pub(crate) fn foveation(&self) -> Option<Foveation> {
        self.color.is_mapped().then_some(self.foveation)
    }

    /// Has the frames to come shaded by another level. One that failed is not asked for again.
    ///
    /// # Errors
    /// A call that failed.
    pub(crate) fn foveate(
        &mut self,
        session: &xr::Session<xr::Vulkan>,
        level: Foveation,
    ) -> Result<(), Error> {
        self.foveation = level;
        self.color.foveate(session, level)
    }

    /// Takes the next images: the number of the surface's to draw into.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn acquire(&mut self) -> Result<usize, Error> {
        let color = self.color.acquire()?;
        match &mut self.depth {
            Some(depth) => Ok(depth.acquire()? * self.color.images.len() + color),
            None => Ok(color),
        }
    }

    /// Gives the images back, drawn.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn release(&mut self) -> Result<(), Error> {
        self.color.handle.release_image().doing("hand over a picture")?;
        match &mut self.depth {
            Some(depth) => depth.handle.release_image().doing("hand over a picture's depth"),
            None => Ok(()),
        }
    }

    /// The pixels of the image that was drawn last, before it is released.
    ///
    /// # Errors
    /// A lost device.
    pub(crate) fn shoot(&self, image: usize) -> Result<Shot, gpu::Error> {
        let raw = self.color.images[image % self.color.images.len()];
        let (format, extent, layout) = (self.format, self.extent, self.layout);
        let blue_first = format == vk::Format::B8G8R8A8_SRGB;
        let eye = |number| -> Result<Vec<u8>, gpu::Error> {
            let bytes = read_layer(&self.gpu, &Layer { raw, format, extent, layout, number })?;
            let rgb = |p: &[u8]| if blue_first { [p[2], p[1], p[0]] } else { [p[0], p[1], p[2]] };
            Ok(bytes.chunks_exact(4).flat_map(rgb).collect())
        };
        Ok(Shot { extent, eyes: [eye(0)?, eye(1)?] })
    }

    /// Ends a frame with the pictures of these views.
    ///
    /// # Errors
    /// A lost session.
    pub(crate) fn end(
        &self,
        stream: &mut xr::FrameStream<xr::Vulkan>,
        (at, blend): (xr::Time, xr::EnvironmentBlendMode),
        room: &xr::Space,
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
        let layer = xr::CompositionLayerProjection::new().space(room).views(&views);
        stream.end(at, blend, &[&layer]).doing("end a frame")
    }

    fn sub_image(&self, chain: &Chain, eye: usize) -> xr::sys::SwapchainSubImage {
        let [width, height] = self.extent.map(u32::cast_signed);
        xr::sys::SwapchainSubImage {
            swapchain: chain.handle.as_raw(),
            image_rect: xr::Rect2Di {
                offset: xr::Offset2Di { x: 0, y: 0 },
                extent: xr::Extent2Di { width, height },
            },
            image_array_index: eye as u32,
        }
    }

    /// Depth is 1 on the near plane: the compositor is told by giving the far one as the near.
    fn depth_info(&self, depth: &Chain, eye: usize) -> xr::sys::CompositionLayerDepthInfoKHR {
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
