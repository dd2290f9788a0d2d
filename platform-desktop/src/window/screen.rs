//! The window's surface and its swapchain, which is rebuilt when the window's size changes.

use std::ffi::CStr;
use std::sync::Arc;

use ash::{khr, vk};
use paros_shaders::gpu::{
    Error, FrameSemaphores, Gpu, Instance, Options, RenderTarget, Renderer, TargetFormat,
};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};
use winit::window::Window;

/// Frames in flight, each with a semaphore.
pub(super) const FRAMES_IN_FLIGHT: usize = 2;

/// Timeout of acquiring an image, in nanoseconds. The frame is skipped after it.
const ACQUIRE_TIMEOUT_NS: u64 = 1_000_000_000;

/// A window's surface, its swapchain and the device that presents.
pub(super) struct WindowSwapchain {
    gpu: Arc<Gpu>,
    surfaces: khr::surface::Instance,
    surface: vk::SurfaceKHR,
    swapchains: khr::swapchain::Device,
    format: vk::SurfaceFormatKHR,
    swapchain: Option<Swapchain>,
    acquired: Vec<vk::Semaphore>,
    at: usize,
}

/// A swapchain of one size.
struct Swapchain {
    raw: vk::SwapchainKHR,
    /// The target that the renderer draws into.
    render_target: RenderTarget,
    views: Vec<vk::ImageView>,
    render_finished: Vec<vk::Semaphore>,
    /// `true` if the window has changed since, so that the swapchain must be rebuilt.
    stale: bool,
}

/// An acquired image of the swapchain.
#[derive(Clone, Copy, Debug)]
pub(super) struct AcquiredImage {
    /// Index of the image.
    pub(super) image: usize,
    /// The semaphores to wait for and to signal.
    pub(super) sync: FrameSemaphores,
}

impl WindowSwapchain {
    /// Creates the window's surface, and opens the best device that can present to it.
    ///
    /// # Errors
    /// No Vulkan, no suitable device, or a failed call.
    pub(super) fn new(window: &Window, options: &Options) -> Result<Self, Error> {
        let lost = |_| Error::NoLoader("the window has no handle".into());
        let display = window.display_handle().map_err(lost)?.as_raw();
        let handle = window.window_handle().map_err(lost)?.as_raw();
        let needed =
            ash_window::enumerate_required_extensions(display).map_err(could_not("name"))?;
        // SAFETY: ash-window's names are C strings that live for good.
        let names = needed.iter().map(|name| unsafe { CStr::from_ptr(*name) });
        let options = Options {
            instance_extensions: names.collect(),
            device_extensions: vec![khr::swapchain::NAME],
            ..options.clone()
        };
        let instance = Instance::create(&options)?;
        let (entry, raw) = (&instance.entry, &instance.raw);
        let surfaces = khr::surface::Instance::new(entry, raw);
        // SAFETY: the handles are the window's, which outlives the surface.
        let surface = unsafe { ash_window::create_surface(entry, raw, display, handle, None) }
            .map_err(could_not("make a surface"))?;
        let made = Self::for_surface(&instance, &options, &surfaces, surface);
        made.inspect_err(|_| {
            // SAFETY: nothing was made on the surface.
            unsafe { surfaces.destroy_surface(surface, None) };
        })
    }

    fn for_surface(
        instance: &Arc<Instance>,
        options: &Options,
        surfaces: &khr::surface::Instance,
        surface: vk::SurfaceKHR,
    ) -> Result<Self, Error> {
        let gpu = Gpu::choose(instance.clone(), options, |physical, family| {
            // SAFETY: the device and the surface are this instance's.
            unsafe { surfaces.get_physical_device_surface_support(physical, family, surface) }
                .unwrap_or(false)
        })?;
        // SAFETY: as above.
        let formats =
            unsafe { surfaces.get_physical_device_surface_formats(gpu.physical_device, surface) }
                .map_err(could_not("list a window's formats"))?;
        let wanted = [vk::Format::B8G8R8A8_SRGB, vk::Format::R8G8B8A8_SRGB];
        let format = formats.into_iter().find(|format| wanted.contains(&format.format));
        let format = format.ok_or_else(|| {
            Error::NoDevice(vec![format!("{} draws no sRGB into windows", gpu.name)])
        })?;
        let swapchains = khr::swapchain::Device::new(&instance.raw, &gpu.device);
        let acquired = create_semaphores(&gpu, FRAMES_IN_FLIGHT + 1)?;
        let (surfaces, swapchain) = (surfaces.clone(), None);
        Ok(WindowSwapchain {
            gpu,
            surfaces,
            surface,
            swapchains,
            format,
            swapchain,
            acquired,
            at: 0,
        })
    }

    /// Returns the device.
    #[must_use]
    pub(super) const fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// Returns the format of the renderer's target, with `samples` samples a pixel.
    #[must_use]
    pub(super) fn format(&self, samples: u32) -> TargetFormat {
        TargetFormat {
            color: self.format.format,
            samples,
            views: 1,
            final_layout: vk::ImageLayout::PRESENT_SRC_KHR,
            keep_depth: false,
            density_map: false,
            is_subsampled: false,
            scales_up: true,
        }
    }

    /// Marks the swapchain to be rebuilt before the next frame.
    pub(super) fn mark_stale(&mut self) {
        if let Some(swapchain) = &mut self.swapchain {
            swapchain.stale = true;
        }
    }

    /// Returns the render target, once [`WindowSwapchain::acquire_image`] has acquired an image.
    #[must_use]
    pub(super) fn render_target(&self) -> Option<&RenderTarget> {
        self.swapchain.as_ref().map(|swapchain| &swapchain.render_target)
    }

    /// Sets the resolution scale of the picture's sides, in percent, from the next frame on.
    pub(super) fn set_drawn_percent(&mut self, percent: u32) {
        if let Some(swapchain) = &mut self.swapchain {
            let target = &mut swapchain.render_target;
            target.set_drawn_extent(target.extent.map(|pixels| (pixels * percent).div_ceil(100)));
        }
    }

    /// Acquires the next image, in a frame that has begun. Returns `None` while the window has no area, or if
    /// the swapchain has just become out of date.
    ///
    /// # Errors
    /// A lost device or window.
    pub(super) fn acquire_image(
        &mut self,
        renderer: &Renderer,
        window_size: [u32; 2],
    ) -> Result<Option<AcquiredImage>, Error> {
        let fresh = |swapchain: &Swapchain| !swapchain.stale;
        if !self.swapchain.as_ref().is_some_and(fresh)
            && !self.try_rebuild_swapchain(renderer, window_size)?
        {
            return Ok(None);
        }
        let Some(swapchain) = &mut self.swapchain else { return Ok(None) };
        let wait = self.acquired[self.at];
        let none = vk::Fence::null();
        // SAFETY: the frame that waited for this semaphore last is done, as the ring is shorter
        // than the semaphores are many.
        let next = unsafe {
            self.swapchains.acquire_next_image(swapchain.raw, ACQUIRE_TIMEOUT_NS, wait, none)
        };
        match next {
            Ok((image, suboptimal)) => {
                swapchain.stale = suboptimal;
                self.at = (self.at + 1) % self.acquired.len();
                let image = image as usize;
                let sync = FrameSemaphores {
                    wait: Some(wait),
                    signal: Some(swapchain.render_finished[image]),
                };
                Ok(Some(AcquiredImage { image, sync }))
            }
            Err(vk::Result::TIMEOUT | vk::Result::NOT_READY) => Ok(None),
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                swapchain.stale = true;
                Ok(None)
            }
            Err(result) => Err(Error::Call { action: "take a window's image", result }),
        }
    }

    /// Presents a drawn image.
    ///
    /// # Errors
    /// A lost device or window.
    pub(super) fn present(&mut self, target: AcquiredImage) -> Result<(), Error> {
        let Some(swapchain) = &mut self.swapchain else { return Ok(()) };
        let (swapchains, images) = ([swapchain.raw], [target.image as u32]);
        let waits: Vec<_> = target.sync.signal.into_iter().collect();
        let info = vk::PresentInfoKHR::default()
            .wait_semaphores(&waits)
            .swapchains(&swapchains)
            .image_indices(&images);
        // SAFETY: the image was acquired, and its drawing signals the semaphore.
        match unsafe { self.swapchains.queue_present(self.gpu.queue, &info) } {
            Ok(suboptimal) => {
                swapchain.stale |= suboptimal;
                Ok(())
            }
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                swapchain.stale = true;
                Ok(())
            }
            Err(result) => Err(Error::Call { action: "show an image", result }),
        }
    }

    /// Rebuilds the swapchain in the window's size. Returns `false` if the window has no area.
    fn try_rebuild_swapchain(
        &mut self,
        renderer: &Renderer,
        window_size: [u32; 2],
    ) -> Result<bool, Error> {
        self.gpu.wait_idle()?;
        // SAFETY: the device and the surface are this instance's.
        let can = unsafe {
            self.surfaces
                .get_physical_device_surface_capabilities(self.gpu.physical_device, self.surface)
        }
        .map_err(could_not("look at a window"))?;
        let vk::Extent2D { width, height } = match can.current_extent {
            // The swapchain's extent sets the window's (vkGetPhysicalDeviceSurfaceCapabilitiesKHR).
            vk::Extent2D { width: u32::MAX, .. } => vk::Extent2D {
                width: window_size[0].clamp(can.min_image_extent.width, can.max_image_extent.width),
                height: window_size[1]
                    .clamp(can.min_image_extent.height, can.max_image_extent.height),
            },
            extent => extent,
        };
        if width == 0 || height == 0 || window_size.contains(&0) {
            return Ok(false);
        }
        let old = self.swapchain.take();
        let most = if can.max_image_count == 0 { u32::MAX } else { can.max_image_count };
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(self.surface)
            .min_image_count((can.min_image_count + 1).min(most))
            .image_format(self.format.format)
            .image_color_space(self.format.color_space)
            .image_extent(vk::Extent2D { width, height })
            .image_array_layers(1)
            .image_usage(vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST)
            .pre_transform(can.current_transform)
            .composite_alpha(opaque_composite_alpha(can.supported_composite_alpha))
            .present_mode(vk::PresentModeKHR::FIFO)
            .clipped(true)
            .old_swapchain(old.as_ref().map_or(vk::SwapchainKHR::null(), |old| old.raw));
        // SAFETY: the surface is not in use by another swapchain than the old one.
        let raw = unsafe { self.swapchains.create_swapchain(&info, None) };
        if let Some(old) = old {
            self.destroy_swapchain(old);
        }
        let raw = raw.map_err(could_not("make a swapchain"))?;
        self.swapchain = Some(self.create_swapchain_parts(raw, renderer, [width, height])?);
        Ok(true)
    }

    /// Creates the image views, semaphores and render target of a raw swapchain. On an error all of them are
    /// destroyed, and the swapchain too.
    fn create_swapchain_parts(
        &self,
        raw: vk::SwapchainKHR,
        renderer: &Renderer,
        extent: [u32; 2],
    ) -> Result<Swapchain, Error> {
        let (mut views, mut render_finished) = (Vec::new(), Vec::new());
        let made = self
            .create_views_and_semaphores(raw, &mut views, &mut render_finished)
            .and_then(|images| renderer.create_target_that_scales_up(extent, &images, &views));
        match made {
            Ok(render_target) => {
                Ok(Swapchain { raw, render_target, views, render_finished, stale: false })
            }
            Err(error) => {
                self.destroy_swapchain_parts(raw, views, render_finished);
                Err(error)
            }
        }
    }

    fn create_views_and_semaphores(
        &self,
        raw: vk::SwapchainKHR,
        views: &mut Vec<vk::ImageView>,
        render_finished: &mut Vec<vk::Semaphore>,
    ) -> Result<Vec<vk::Image>, Error> {
        // SAFETY: the swapchain is this device's.
        let images = unsafe { self.swapchains.get_swapchain_images(raw) }
            .map_err(could_not("list a window's images"))?;
        for image in &images {
            views.push(self.create_view(*image)?);
        }
        *render_finished = create_semaphores(&self.gpu, images.len())?;
        Ok(images)
    }

    fn create_view(&self, image: vk::Image) -> Result<vk::ImageView, Error> {
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D_ARRAY)
            .format(self.format.format)
            .subresource_range(vk::ImageSubresourceRange {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                level_count: 1,
                layer_count: 1,
                ..vk::ImageSubresourceRange::default()
            });
        // SAFETY: the image is the swapchain's.
        unsafe { self.gpu.device.create_image_view(&info, None) }
            .map_err(could_not("view an image"))
    }

    fn destroy_swapchain(&self, swapchain: Swapchain) {
        let Swapchain { raw, render_target, views, render_finished, .. } = swapchain;
        drop(render_target);
        self.destroy_swapchain_parts(raw, views, render_finished);
    }

    fn destroy_swapchain_parts(
        &self,
        raw: vk::SwapchainKHR,
        views: Vec<vk::ImageView>,
        render_finished: Vec<vk::Semaphore>,
    ) {
        // SAFETY: the device was waited for, or is lost: nothing is under way.
        unsafe {
            views.into_iter().for_each(|view| self.gpu.device.destroy_image_view(view, None));
            render_finished
                .into_iter()
                .for_each(|one| self.gpu.device.destroy_semaphore(one, None));
            self.swapchains.destroy_swapchain(raw, None);
        }
    }
}

impl Drop for WindowSwapchain {
    fn drop(&mut self) {
        // A lost device has no work in flight.
        let _ = self.gpu.wait_idle();
        if let Some(swapchain) = self.swapchain.take() {
            self.destroy_swapchain(swapchain);
        }
        // SAFETY: nothing is under way, and the swapchain is gone.
        unsafe {
            for semaphore in &self.acquired {
                self.gpu.device.destroy_semaphore(*semaphore, None);
            }
            self.surfaces.destroy_surface(self.surface, None);
        }
    }
}

/// Creates `count` semaphores. On an error none are left.
fn create_semaphores(gpu: &Gpu, count: usize) -> Result<Vec<vk::Semaphore>, Error> {
    let info = vk::SemaphoreCreateInfo::default();
    let mut all = Vec::new();
    for _ in 0..count {
        // SAFETY: the info is complete.
        match unsafe { gpu.device.create_semaphore(&info, None) } {
            Ok(one) => all.push(one),
            Err(result) => {
                // SAFETY: nothing uses them yet.
                all.into_iter().for_each(|one| unsafe { gpu.device.destroy_semaphore(one, None) });
                return Err(could_not("make a semaphore")(result));
            }
        }
    }
    Ok(all)
}

/// Returns the supported composite alpha mode that is closest to opaque.
fn opaque_composite_alpha(ways: vk::CompositeAlphaFlagsKHR) -> vk::CompositeAlphaFlagsKHR {
    let all = [
        vk::CompositeAlphaFlagsKHR::OPAQUE,
        vk::CompositeAlphaFlagsKHR::INHERIT,
        vk::CompositeAlphaFlagsKHR::PRE_MULTIPLIED,
    ];
    let offered = all.into_iter().find(|way| ways.contains(*way));
    offered.unwrap_or(vk::CompositeAlphaFlagsKHR::POST_MULTIPLIED)
}

fn could_not(action: &'static str) -> impl Fn(vk::Result) -> Error {
    move |result| Error::Call { action, result }
}
