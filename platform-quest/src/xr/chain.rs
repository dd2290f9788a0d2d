//! A swapchain of two layers, the views of its images, and the density maps that tell how coarsely
//! each is to be shaded.

use std::sync::Arc;

use ash::vk::{self, Handle as _};
use openxr as xr;
use paros_shaders::gpu::{self, Format, Gpu};
use xr::sys::Handle as _;

use crate::error::{Doing, Error};
use crate::foveation::Foveation;

/// A swapchain with views of its images.
pub(crate) struct Chain {
    pub(super) gpu: Arc<Gpu>,
    pub(super) handle: xr::Swapchain<xr::Vulkan>,
    pub(super) images: Vec<vk::Image>,
    pub(super) views: Vec<vk::ImageView>,
    /// Of the images' density maps, if they have any.
    pub(super) densities: Vec<vk::ImageView>,
}

/// What a swapchain is for.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    /// Pixels across and down.
    pub(super) extent: [u32; 2],
    pub(super) format: vk::Format,
    pub(super) aspect: vk::ImageAspectFlags,
    pub(super) usage: xr::SwapchainUsageFlags,
    /// Whether density maps are to come with it.
    pub(super) mapped: bool,
}

impl Chain {
    /// A swapchain of a session whose pictures a device draws. Its density maps are left out where
    /// the runtime gives none after all.
    ///
    /// # Errors
    /// A call that failed.
    pub(super) fn new(
        session: &xr::Session<xr::Vulkan>,
        gpu: &Arc<Gpu>,
        kind: &Kind,
    ) -> Result<Self, Error> {
        let handle = make(session, kind)?;
        let (images, maps) = images(&handle, kind.mapped)?;
        let (views, densities) = (Vec::new(), Vec::new());
        let mut chain = Chain { gpu: gpu.clone(), handle, images, views, densities };
        for i in 0..chain.images.len() {
            let view = chain.view(chain.images[i], kind.format, kind.aspect)?;
            chain.views.push(view);
        }
        for map in maps {
            let view = chain.view(map, Format::DENSITY, vk::ImageAspectFlags::COLOR)?;
            chain.densities.push(view);
        }
        Ok(chain)
    }

    /// Whether there are density maps.
    pub(super) const fn is_mapped(&self) -> bool {
        !self.densities.is_empty()
    }

    /// Takes the next image, once the compositor has read it: its number.
    ///
    /// # Errors
    /// A lost session.
    pub(super) fn acquire(&mut self) -> Result<usize, Error> {
        let image = self.handle.acquire_image().doing("take an image")?;
        self.handle.wait_image(xr::Duration::INFINITE).doing("wait for an image")?;
        Ok(image as usize)
    }

    /// Has the runtime fill the density maps for a level. The profile that says so is needed no
    /// longer than that.
    ///
    /// # Errors
    /// A call that failed.
    pub(super) fn foveate(
        &self,
        session: &xr::Session<xr::Vulkan>,
        level: Foveation,
    ) -> Result<(), Error> {
        let Some(update) = &session.instance().exts().fb_swapchain_update_state else {
            return Ok(());
        };
        let level = match level {
            Foveation::Off => xr::FoveationLevelFB::NONE,
            Foveation::Low => xr::FoveationLevelFB::LOW,
            Foveation::Medium => xr::FoveationLevelFB::MEDIUM,
            Foveation::High => xr::FoveationLevelFB::HIGH,
        };
        let dynamic = xr::FoveationDynamicFB::DISABLED;
        let profile = xr::FoveationLevelProfile { level, vertical_offset: 0.0, dynamic };
        let profile = session.create_foveation_profile(Some(profile));
        let profile = profile.doing("make a foveation profile")?;
        let state = xr::sys::SwapchainStateFoveationFB {
            ty: xr::sys::SwapchainStateFoveationFB::TYPE,
            next: core::ptr::null_mut(),
            flags: xr::SwapchainStateFoveationFlagsFB::EMPTY,
            profile: profile.as_raw(),
        };
        let state = (&raw const state).cast();
        // SAFETY: the swapchain and the profile are alive, the extension is enabled, and the state
        // begins as its base does.
        let result = unsafe { (update.update_swapchain)(self.handle.as_raw(), state) };
        done(result, "set the foveation")
    }

    /// A view of both layers of an image.
    fn view(
        &self,
        image: vk::Image,
        format: vk::Format,
        aspect: vk::ImageAspectFlags,
    ) -> Result<vk::ImageView, Error> {
        let range = vk::ImageSubresourceRange {
            aspect_mask: aspect,
            level_count: 1,
            layer_count: 2,
            ..vk::ImageSubresourceRange::default()
        };
        let info = vk::ImageViewCreateInfo::default()
            .image(image)
            .view_type(vk::ImageViewType::TYPE_2D_ARRAY)
            .format(format)
            .subresource_range(range);
        // SAFETY: the image is the swapchain's, which outlives the view.
        let view = unsafe { self.gpu.device.create_image_view(&info, None) };
        view.map_err(|result| Error::Gpu(gpu::Error::Call { doing: "view an image", result }))
    }
}

impl Drop for Chain {
    fn drop(&mut self) {
        // A lost device has nothing under way.
        let _ = self.gpu.wait();
        for view in self.views.iter().chain(&self.densities) {
            // SAFETY: nothing is under way, and framebuffers of it may outlive a view.
            unsafe { self.gpu.device.destroy_image_view(*view, None) };
        }
    }
}

fn make(
    session: &xr::Session<xr::Vulkan>,
    kind: &Kind,
) -> Result<xr::Swapchain<xr::Vulkan>, Error> {
    let mut foveation = xr::sys::SwapchainCreateInfoFoveationFB {
        ty: xr::sys::SwapchainCreateInfoFoveationFB::TYPE,
        next: core::ptr::null_mut(),
        flags: xr::SwapchainCreateFoveationFlagsFB::FRAGMENT_DENSITY_MAP,
    };
    let [width, height] = kind.extent;
    let info = xr::sys::SwapchainCreateInfo {
        ty: xr::sys::SwapchainCreateInfo::TYPE,
        next: if kind.mapped { (&raw mut foveation).cast() } else { core::ptr::null_mut() },
        create_flags: xr::SwapchainCreateFlags::EMPTY,
        usage_flags: kind.usage,
        format: i64::from(kind.format.as_raw()),
        sample_count: 1,
        width,
        height,
        face_count: 1,
        array_size: 2,
        mip_count: 1,
    };
    let mut handle = xr::sys::Swapchain::NULL;
    let create = session.instance().fp().create_swapchain;
    // SAFETY: the session is alive, and all that `info` points to lives until the call returns.
    let result = unsafe { create(session.as_raw(), &info, &mut handle) };
    done(result, "make a swapchain")?;
    // SAFETY: it was just made for this session.
    Ok(unsafe { xr::Swapchain::from_raw(session.clone(), handle) })
}

/// A swapchain's images; and a density map for each, or none.
fn images(
    chain: &xr::Swapchain<xr::Vulkan>,
    mapped: bool,
) -> Result<(Vec<vk::Image>, Vec<vk::Image>), Error> {
    let all = chain.instance().fp().enumerate_swapchain_images;
    let mut count = 0;
    // SAFETY: there is room for a count.
    let result = unsafe { all(chain.as_raw(), 0, &mut count, core::ptr::null_mut()) };
    done(result, "count a swapchain's images")?;
    let map = xr::sys::SwapchainImageFoveationVulkanFB {
        ty: xr::sys::SwapchainImageFoveationVulkanFB::TYPE,
        next: core::ptr::null_mut(),
        image: 0,
        width: 0,
        height: 0,
    };
    let mut maps = vec![map; count as usize];
    let image = |map: &mut xr::sys::SwapchainImageFoveationVulkanFB| {
        let ty = xr::sys::SwapchainImageVulkanKHR::TYPE;
        let next = if mapped { (&raw mut *map).cast() } else { core::ptr::null_mut() };
        xr::sys::SwapchainImageVulkanKHR { ty, next, image: 0 }
    };
    let mut images: Vec<_> = maps.iter_mut().map(image).collect();
    let at = images.as_mut_ptr().cast();
    // SAFETY: there is room for so many images, each chained to a density map where there are any.
    let result = unsafe { all(chain.as_raw(), count, &mut count, at) };
    done(result, "list a swapchain's images")?;
    let images = images.iter().map(|image| vk::Image::from_raw(image.image)).collect();
    let maps: Vec<_> = maps.iter().map(|map| vk::Image::from_raw(map.image)).collect();
    let whole = mapped && maps.iter().all(|map| !map.is_null());
    Ok((images, if whole { maps } else { Vec::new() }))
}

fn done(result: xr::sys::Result, doing: &'static str) -> Result<(), Error> {
    if result.into_raw() < 0 { Err(Error::Call { doing, result }) } else { Ok(()) }
}
