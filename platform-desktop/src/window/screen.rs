//! The window's images: a swapchain that follows the window's size.

use std::ffi::CStr;
use std::sync::Arc;

use ash::{khr, vk};
use paros_shaders::gpu::{Error, Format, Gpu, Instance, Options, Renderer, Surface, Sync};
use winit::raw_window_handle::{HasDisplayHandle, HasWindowHandle};
use winit::window::Window;

/// Frames that the renderer has under way, each with a semaphore.
const RING: usize = 2;

/// Nanoseconds that an image of the window is waited for: a frame is left out then.
const PATIENCE: u64 = 1_000_000_000;

/// A window's surface on a device.
pub(super) struct Screen {
    gpu: Arc<Gpu>,
    surfaces: khr::surface::Instance,
    surface: vk::SurfaceKHR,
    swapchains: khr::swapchain::Device,
    format: vk::SurfaceFormatKHR,
    chain: Option<Chain>,
    acquired: Vec<vk::Semaphore>,
    at: usize,
}

/// A swapchain of one size.
struct Chain {
    raw: vk::SwapchainKHR,
    /// What the renderer draws into.
    surface: Surface,
    views: Vec<vk::ImageView>,
    drawn: Vec<vk::Semaphore>,
    /// The window has changed since.
    stale: bool,
}

/// An image to draw into.
#[derive(Clone, Copy, Debug)]
pub(super) struct Target {
    /// Its number.
    pub(super) image: usize,
    /// What to wait for and to tell.
    pub(super) sync: Sync,
}

impl Screen {
    /// The best device that draws into a window, and its surface there.
    ///
    /// # Errors
    /// No Vulkan, no device that fits, or a call that failed.
    pub(super) fn new(window: &Window, validation: bool) -> Result<Self, Error> {
        let lost = |_| Error::NoLoader("the window has no handle".into());
        let display = window.display_handle().map_err(lost)?.as_raw();
        let handle = window.window_handle().map_err(lost)?.as_raw();
        let needed = ash_window::enumerate_required_extensions(display).map_err(failed("name"))?;
        // SAFETY: ash-window's names are C strings that live for good.
        let names = needed.iter().map(|name| unsafe { CStr::from_ptr(*name) });
        let options = Options {
            instance_extensions: names.collect(),
            device_extensions: vec![khr::swapchain::NAME],
            validation,
            ..Options::default()
        };
        let instance = Instance::new(&options)?;
        let (entry, raw) = (&instance.entry, &instance.raw);
        let surfaces = khr::surface::Instance::new(entry, raw);
        // SAFETY: the handles are the window's, which outlives the surface.
        let surface = unsafe { ash_window::create_surface(entry, raw, display, handle, None) }
            .map_err(failed("make a surface"))?;
        let made = Self::on(&instance, &options, &surfaces, surface);
        made.inspect_err(|_| {
            // SAFETY: nothing was made on the surface.
            unsafe { surfaces.destroy_surface(surface, None) };
        })
    }

    fn on(
        instance: &Arc<Instance>,
        options: &Options,
        surfaces: &khr::surface::Instance,
        surface: vk::SurfaceKHR,
    ) -> Result<Self, Error> {
        let gpu = Gpu::new(instance.clone(), options, |physical, family| {
            // SAFETY: the device and the surface are this instance's.
            unsafe { surfaces.get_physical_device_surface_support(physical, family, surface) }
                .unwrap_or(false)
        })?;
        // SAFETY: as above.
        let formats =
            unsafe { surfaces.get_physical_device_surface_formats(gpu.physical, surface) }
                .map_err(failed("list a window's formats"))?;
        let wanted = [vk::Format::B8G8R8A8_SRGB, vk::Format::R8G8B8A8_SRGB];
        let format = formats.into_iter().find(|format| wanted.contains(&format.format));
        let format = format.ok_or_else(|| {
            Error::NoDevice(vec![format!("{} draws no sRGB into windows", gpu.name)])
        })?;
        let swapchains = khr::swapchain::Device::new(&instance.raw, &gpu.device);
        let acquired = semaphores(&gpu, RING + 1)?;
        let (surfaces, chain) = (surfaces.clone(), None);
        Ok(Screen { gpu, surfaces, surface, swapchains, format, chain, acquired, at: 0 })
    }

    /// The device.
    #[must_use]
    pub(super) const fn gpu(&self) -> &Arc<Gpu> {
        &self.gpu
    }

    /// The renderer's format.
    #[must_use]
    pub(super) fn format(&self, samples: u32) -> Format {
        Format {
            color: self.format.format,
            samples,
            views: 1,
            final_layout: vk::ImageLayout::PRESENT_SRC_KHR,
            keep_depth: false,
            density_map: false,
        }
    }

    /// The window has another size, or is to be looked at again.
    pub(super) fn resized(&mut self) {
        if let Some(chain) = &mut self.chain {
            chain.stale = true;
        }
    }

    /// What is drawn into, once [`Screen::acquire`] gave an image of it.
    #[must_use]
    pub(super) fn surface(&self) -> Option<&Surface> {
        self.chain.as_ref().map(|chain| &chain.surface)
    }

    /// The next image, in a frame that has begun; none while the window has no size, or if it has
    /// just changed.
    ///
    /// # Errors
    /// A lost device or window.
    pub(super) fn acquire(
        &mut self,
        renderer: &Renderer,
        size: [u32; 2],
    ) -> Result<Option<Target>, Error> {
        let fresh = |chain: &Chain| !chain.stale;
        if !self.chain.as_ref().is_some_and(fresh) && !self.rebuild(renderer, size)? {
            return Ok(None);
        }
        let Some(chain) = &mut self.chain else { return Ok(None) };
        let wait = self.acquired[self.at];
        let none = vk::Fence::null();
        // SAFETY: the frame that waited for this semaphore last is done, as the ring is shorter
        // than the semaphores are many.
        let next = unsafe { self.swapchains.acquire_next_image(chain.raw, PATIENCE, wait, none) };
        match next {
            Ok((image, suboptimal)) => {
                chain.stale = suboptimal;
                self.at = (self.at + 1) % self.acquired.len();
                let image = image as usize;
                let sync = Sync { wait: Some(wait), signal: Some(chain.drawn[image]) };
                Ok(Some(Target { image, sync }))
            }
            Err(vk::Result::TIMEOUT | vk::Result::NOT_READY) => Ok(None),
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                chain.stale = true;
                Ok(None)
            }
            Err(result) => Err(Error::Call { doing: "take a window's image", result }),
        }
    }

    /// Shows an image that was drawn.
    ///
    /// # Errors
    /// A lost device or window.
    pub(super) fn present(&mut self, target: Target) -> Result<(), Error> {
        let Some(chain) = &mut self.chain else { return Ok(()) };
        let (swapchains, images) = ([chain.raw], [target.image as u32]);
        let waits: Vec<_> = target.sync.signal.into_iter().collect();
        let info = vk::PresentInfoKHR::default()
            .wait_semaphores(&waits)
            .swapchains(&swapchains)
            .image_indices(&images);
        // SAFETY: the image was acquired, and the semaphore is told by its drawing.
        match unsafe { self.swapchains.queue_present(self.gpu.queue, &info) } {
            Ok(suboptimal) => {
                chain.stale |= suboptimal;
                Ok(())
            }
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                chain.stale = true;
                Ok(())
            }
            Err(result) => Err(Error::Call { doing: "show an image", result }),
        }
    }

    /// Makes a swapchain for the window as it is. Whether it has a size.
    fn rebuild(&mut self, renderer: &Renderer, size: [u32; 2]) -> Result<bool, Error> {
        self.gpu.wait()?;
        // SAFETY: the device and the surface are this instance's.
        let can = unsafe {
            self.surfaces.get_physical_device_surface_capabilities(self.gpu.physical, self.surface)
        }
        .map_err(failed("look at a window"))?;
        let vk::Extent2D { width, height } = match can.current_extent {
            // The window goes by the images.
            vk::Extent2D { width: u32::MAX, .. } => vk::Extent2D {
                width: size[0].clamp(can.min_image_extent.width, can.max_image_extent.width),
                height: size[1].clamp(can.min_image_extent.height, can.max_image_extent.height),
            },
            extent => extent,
        };
        if width == 0 || height == 0 || size.contains(&0) {
            return Ok(false);
        }
        let old = self.chain.take();
        let most = if can.max_image_count == 0 { u32::MAX } else { can.max_image_count };
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(self.surface)
            .min_image_count((can.min_image_count + 1).min(most))
            .image_format(self.format.format)
            .image_color_space(self.format.color_space)
            .image_extent(vk::Extent2D { width, height })
            .image_array_layers(1)
            .image_usage(vk::ImageUsageFlags::COLOR_ATTACHMENT)
            .pre_transform(can.current_transform)
            .composite_alpha(opaque(can.supported_composite_alpha))
            .present_mode(vk::PresentModeKHR::FIFO)
            .clipped(true)
            .old_swapchain(old.as_ref().map_or(vk::SwapchainKHR::null(), |old| old.raw));
        // SAFETY: the surface is not in use by another swapchain than the old one.
        let raw = unsafe { self.swapchains.create_swapchain(&info, None) };
        if let Some(old) = old {
            self.destroy(old);
        }
        let raw = raw.map_err(failed("make a swapchain"))?;
        self.chain = Some(self.chain(raw, renderer, [width, height])?);
        Ok(true)
    }

    /// What goes with a swapchain, which goes too if that can't be made.
    fn chain(
        &self,
        raw: vk::SwapchainKHR,
        renderer: &Renderer,
        extent: [u32; 2],
    ) -> Result<Chain, Error> {
        let (mut views, mut drawn) = (Vec::new(), Vec::new());
        let made = self
            .fill(raw, &mut views, &mut drawn)
            .and_then(|()| renderer.surface(extent, &views, &[]));
        match made {
            Ok(surface) => Ok(Chain { raw, surface, views, drawn, stale: false }),
            Err(error) => {
                self.destroy_parts(raw, views, drawn);
                Err(error)
            }
        }
    }

    fn fill(
        &self,
        raw: vk::SwapchainKHR,
        views: &mut Vec<vk::ImageView>,
        drawn: &mut Vec<vk::Semaphore>,
    ) -> Result<(), Error> {
        // SAFETY: the swapchain is this device's.
        let images = unsafe { self.swapchains.get_swapchain_images(raw) }
            .map_err(failed("list a window's images"))?;
        for image in &images {
            views.push(self.view(*image)?);
        }
        *drawn = semaphores(&self.gpu, images.len())?;
        Ok(())
    }

    fn view(&self, image: vk::Image) -> Result<vk::ImageView, Error> {
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
        unsafe { self.gpu.device.create_image_view(&info, None) }.map_err(failed("view an image"))
    }

    fn destroy(&self, chain: Chain) {
        let Chain { raw, surface, views, drawn, .. } = chain;
        drop(surface);
        self.destroy_parts(raw, views, drawn);
    }

    fn destroy_parts(
        &self,
        raw: vk::SwapchainKHR,
        views: Vec<vk::ImageView>,
        drawn: Vec<vk::Semaphore>,
    ) {
        // SAFETY: the device was waited for, or is lost: nothing is under way.
        unsafe {
            views.into_iter().for_each(|view| self.gpu.device.destroy_image_view(view, None));
            drawn.into_iter().for_each(|one| self.gpu.device.destroy_semaphore(one, None));
            self.swapchains.destroy_swapchain(raw, None);
        }
    }
}

impl Drop for Screen {
    fn drop(&mut self) {
        // A lost device has nothing under way.
        let _ = self.gpu.wait();
        if let Some(chain) = self.chain.take() {
            self.destroy(chain);
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

/// So many semaphores, or none.
fn semaphores(gpu: &Gpu, count: usize) -> Result<Vec<vk::Semaphore>, Error> {
    let info = vk::SemaphoreCreateInfo::default();
    let mut all = Vec::new();
    for _ in 0..count {
        // SAFETY: the info is complete.
        match unsafe { gpu.device.create_semaphore(&info, None) } {
            Ok(one) => all.push(one),
            Err(result) => {
                // SAFETY: nothing uses them yet.
                all.into_iter().for_each(|one| unsafe { gpu.device.destroy_semaphore(one, None) });
                return Err(failed("make a semaphore")(result));
            }
        }
    }
    Ok(all)
}

/// The way of showing that lets nothing shine through, if there is a choice.
fn opaque(ways: vk::CompositeAlphaFlagsKHR) -> vk::CompositeAlphaFlagsKHR {
    let all = [
        vk::CompositeAlphaFlagsKHR::OPAQUE,
        vk::CompositeAlphaFlagsKHR::INHERIT,
        vk::CompositeAlphaFlagsKHR::PRE_MULTIPLIED,
    ];
    let offered = all.into_iter().find(|way| ways.contains(*way));
    offered.unwrap_or(vk::CompositeAlphaFlagsKHR::POST_MULTIPLIED)
}

fn failed(doing: &'static str) -> impl Fn(vk::Result) -> Error {
    move |result| Error::Call { doing, result }
}
