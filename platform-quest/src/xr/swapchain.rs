//! A swapchain of two array layers, one for each eye, with views of its images and of their fragment density
//! maps.

use std::sync::Arc;

use ash::vk::{self, Handle as _};
use openxr as xr;
use paros_shaders::gpu::{self, Gpu, TargetFormat};
use xr::sys::Handle as _;

use crate::error::{CallContext, Error};
use crate::foveation::{Foveation, FoveationLevel};

/// A swapchain with views of its images.
pub(crate) struct EyeSwapchain {
    pub(super) gpu: Arc<Gpu>,
    pub(super) handle: xr::Swapchain<xr::Vulkan>,
    pub(super) images: Vec<vk::Image>,
    pub(super) views: Vec<vk::ImageView>,
    /// Views of the images' fragment density maps, if they have any.
    pub(super) density_views: Vec<vk::ImageView>,
    /// `true` if the images are subsampled.
    pub(super) is_subsampled: bool,
}

/// The parameters of a swapchain.
#[derive(Clone, Copy)]
pub(super) struct SwapchainSpec {
    /// Pixels across and down.
    pub(super) extent: [u32; 2],
    pub(super) format: vk::Format,
    pub(super) aspect: vk::ImageAspectFlags,
    pub(super) usage: xr::SwapchainUsageFlags,
    /// `true` to request fragment density maps for the images.
    pub(super) with_density_maps: bool,
    /// `true` to request images that are subsampled by these maps, if the runtime supports it: fewer texels
    /// are then written, and read by the compositor. Such images can't be read back.
    pub(super) prefers_subsampled: bool,
}

impl EyeSwapchain {
    /// Creates a swapchain for a device to draw into. It has no density maps if the runtime provides none.
    ///
    /// # Errors
    /// A call that failed.
    pub(super) fn create(
        session: &xr::Session<xr::Vulkan>,
        gpu: &Arc<Gpu>,
        spec: &SwapchainSpec,
    ) -> Result<Self, Error> {
        let (handle, is_subsampled) = create_swapchain_subsampled_or_not(session, spec)?;
        let SwapchainImages { images, density_maps } =
            enumerate_images(&handle, spec.with_density_maps)?;
        let (views, density_views) = (Vec::new(), Vec::new());
        let gpu = gpu.clone();
        let mut swapchain =
            EyeSwapchain { gpu, handle, images, views, density_views, is_subsampled };
        for i in 0..swapchain.images.len() {
            let view = swapchain.create_view(swapchain.images[i], spec.format, spec.aspect)?;
            swapchain.views.push(view);
        }
        for map in density_maps {
            let view =
                swapchain.create_view(map, TargetFormat::DENSITY, vk::ImageAspectFlags::COLOR)?;
            swapchain.density_views.push(view);
        }
        Ok(swapchain)
    }

    /// Returns `true` if the images have density maps.
    pub(super) const fn has_density_maps(&self) -> bool {
        !self.density_views.is_empty()
    }

    /// Acquires the next image and waits until the compositor has read it. Returns its index.
    ///
    /// # Errors
    /// A lost session.
    pub(super) fn acquire_and_wait_image(&mut self) -> Result<usize, Error> {
        let image = self.handle.acquire_image().could_not("take an image")?;
        self.handle.wait_image(xr::Duration::INFINITE).could_not("wait for an image")?;
        Ok(image as usize)
    }

    /// Sets the foveation: the runtime updates the density maps. The foveation profile is destroyed at once,
    /// as `xrUpdateSwapchainFB` doesn't need it any longer.
    ///
    /// # Errors
    /// A call that failed.
    pub(super) fn set_foveation(
        &self,
        session: &xr::Session<xr::Vulkan>,
        wanted: Foveation,
    ) -> Result<(), Error> {
        let Some(update) = &session.instance().exts().fb_swapchain_update_state else {
            return Ok(());
        };
        let level = match wanted.level {
            FoveationLevel::Off => xr::FoveationLevelFB::NONE,
            FoveationLevel::Low => xr::FoveationLevelFB::LOW,
            FoveationLevel::Medium => xr::FoveationLevelFB::MEDIUM,
            FoveationLevel::High => xr::FoveationLevelFB::HIGH,
        };
        let dynamic = match wanted.is_dynamic {
            true => xr::FoveationDynamicFB::LEVEL_ENABLED,
            false => xr::FoveationDynamicFB::DISABLED,
        };
        let profile = xr::FoveationLevelProfile { level, vertical_offset: 0.0, dynamic };
        let profile = session.create_foveation_profile(Some(profile));
        let profile = profile.could_not("make a foveation profile")?;
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
        check_result(result, "set the foveation")
    }

    /// Creates a view of both layers of an image.
    fn create_view(
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
        view.map_err(|result| Error::Gpu(gpu::Error::Call { action: "view an image", result }))
    }
}

impl Drop for EyeSwapchain {
    fn drop(&mut self) {
        // A lost device has no work under way.
        let _ = self.gpu.wait_idle();
        for view in self.views.iter().chain(&self.density_views) {
            // SAFETY: the device is idle, and framebuffers may outlive their views.
            unsafe { self.gpu.device.destroy_image_view(*view, None) };
        }
    }
}

/// The struct `XrVulkanSwapchainCreateInfoMETA`, whose flags have 32 bits, as in Vulkan; in the `openxr`
/// crate they have 64.
#[repr(C)]
struct MoreImageFlags {
    ty: xr::sys::StructureType,
    next: *const core::ffi::c_void,
    create_flags: vk::ImageCreateFlags,
    usage_flags: vk::ImageUsageFlags,
}

/// Creates a swapchain of subsampled images if preferred, and of ordinary ones if that is refused. Returns
/// the swapchain, and `true` if it is subsampled.
fn create_swapchain_subsampled_or_not(
    session: &xr::Session<xr::Vulkan>,
    spec: &SwapchainSpec,
) -> Result<(xr::Swapchain<xr::Vulkan>, bool), Error> {
    if spec.prefers_subsampled {
        match create_swapchain(session, spec) {
            Err(Error::Call { result: xr::sys::Result::ERROR_FEATURE_UNSUPPORTED, .. }) => {}
            made => return Ok((made?, true)),
        }
    }
    let plain = SwapchainSpec { prefers_subsampled: false, ..*spec };
    Ok((create_swapchain(session, &plain)?, false))
}

fn create_swapchain(
    session: &xr::Session<xr::Vulkan>,
    spec: &SwapchainSpec,
) -> Result<xr::Swapchain<xr::Vulkan>, Error> {
    let mut subsampled = MoreImageFlags {
        ty: xr::sys::VulkanSwapchainCreateInfoMETA::TYPE,
        next: core::ptr::null(),
        create_flags: vk::ImageCreateFlags::SUBSAMPLED_EXT,
        usage_flags: vk::ImageUsageFlags::empty(),
    };
    let mut foveation = xr::sys::SwapchainCreateInfoFoveationFB {
        ty: xr::sys::SwapchainCreateInfoFoveationFB::TYPE,
        next: match spec.prefers_subsampled {
            true => (&raw mut subsampled).cast(),
            false => core::ptr::null_mut(),
        },
        flags: xr::SwapchainCreateFoveationFlagsFB::FRAGMENT_DENSITY_MAP,
    };
    let [width, height] = spec.extent;
    let info = xr::sys::SwapchainCreateInfo {
        ty: xr::sys::SwapchainCreateInfo::TYPE,
        next: if spec.with_density_maps {
            (&raw mut foveation).cast()
        } else {
            core::ptr::null_mut()
        },
        create_flags: xr::SwapchainCreateFlags::EMPTY,
        usage_flags: spec.usage,
        format: i64::from(spec.format.as_raw()),
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
    check_result(result, "make a swapchain")?;
    // SAFETY: it was just made for this session.
    Ok(unsafe { xr::Swapchain::from_raw(session.clone(), handle) })
}

/// A swapchain's images.
struct SwapchainImages {
    images: Vec<vk::Image>,
    /// A fragment density map for each image, or none at all.
    density_maps: Vec<vk::Image>,
}

/// Lists a swapchain's images.
fn enumerate_images(
    swapchain: &xr::Swapchain<xr::Vulkan>,
    with_density_maps: bool,
) -> Result<SwapchainImages, Error> {
    let enumerate = swapchain.instance().fp().enumerate_swapchain_images;
    let mut count = 0;
    // SAFETY: there is room for a count.
    let result = unsafe { enumerate(swapchain.as_raw(), 0, &mut count, core::ptr::null_mut()) };
    check_result(result, "count a swapchain's images")?;
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
        let next = if with_density_maps { (&raw mut *map).cast() } else { core::ptr::null_mut() };
        xr::sys::SwapchainImageVulkanKHR { ty, next, image: 0 }
    };
    let mut images: Vec<_> = maps.iter_mut().map(image).collect();
    let at = images.as_mut_ptr().cast();
    // SAFETY: there is room for so many images, each chained to a density map where there are any.
    let result = unsafe { enumerate(swapchain.as_raw(), count, &mut count, at) };
    check_result(result, "list a swapchain's images")?;
    let images = images.iter().map(|image| vk::Image::from_raw(image.image)).collect();
    let maps: Vec<_> = maps.iter().map(|map| vk::Image::from_raw(map.image)).collect();
    let whole = with_density_maps && maps.iter().all(|map| !map.is_null());
    Ok(SwapchainImages { images, density_maps: if whole { maps } else { Vec::new() } })
}

fn check_result(result: xr::sys::Result, could_not: &'static str) -> Result<(), Error> {
    if result.into_raw() < 0 { Err(Error::Call { action: could_not, result }) } else { Ok(()) }
}
