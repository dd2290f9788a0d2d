//! The runtime: an instance, the head-mounted system, and the Vulkan device that is created through it
//! (`XR_KHR_vulkan_enable2`).

use std::sync::Arc;

use ash::vk::{self, Handle};
use openxr as xr;
use paros_shaders::gpu::{self, Gpu};

use super::VIEW_CONFIGURATION;
use crate::error::{CallContext, Error};
use crate::foveation::FoveationLevel;
use crate::options::ShellOptions;
use crate::platform::Platform;

/// Vulkan 1.1 has multiview in its core.
const VULKAN_VERSION: xr::Version = xr::Version::new(1, 1, 0);

/// An OpenXR instance and its head-mounted system.
pub(crate) struct Runtime {
    pub(crate) instance: xr::Instance,
    pub(crate) system: xr::SystemId,
    /// The enabled extensions.
    pub(crate) extensions: xr::ExtensionSet,
    /// The runtime's name and version, for messages.
    pub(crate) name: String,
    /// The recommended extent of an eye's image, in pixels.
    pub(crate) extent: [u32; 2],
    /// The environment blend mode.
    pub(crate) blend_mode: xr::EnvironmentBlendMode,
    /// `xrSetAndroidApplicationThreadKHR`, if the runtime has it.
    pub(crate) set_thread_type: Option<SetThreadType>,
}

/// The type `PFN_xrSetAndroidApplicationThreadKHR`, which the `openxr` crate only defines on Android.
pub(crate) type SetThreadType =
    unsafe extern "system" fn(xr::sys::Session, xr::AndroidThreadTypeKHR, u32) -> xr::sys::Result;

/// Returns OPAQUE if it is offered, as the virtual room hides the real one; otherwise the runtime's first
/// preference.
fn choose_blend_mode(offered: &[xr::EnvironmentBlendMode]) -> xr::EnvironmentBlendMode {
    let opaque = xr::EnvironmentBlendMode::OPAQUE;
    match offered.first() {
        Some(best) if !offered.contains(&opaque) => *best,
        _ => opaque,
    }
}

const THREAD_SETTINGS: &[u8] = b"XR_KHR_android_thread_settings\0";

impl Runtime {
    /// Creates an instance through the platform's loader, and finds its head-mounted system.
    ///
    /// # Errors
    /// [`Error::Unavailable`] with what is missing, or a call that failed.
    pub(crate) fn create(
        platform: &mut dyn Platform,
        options: &ShellOptions,
    ) -> Result<Self, Error> {
        let entry = platform.load_openxr()?;
        let offered = entry.enumerate_extensions().map_err(instance_error)?;
        if !offered.khr_vulkan_enable2 {
            let why = "the OpenXR runtime has no XR_KHR_vulkan_enable2";
            return Err(Error::Unavailable(why.into()));
        }
        let extensions = wanted_extensions(options).intersection(&offered);
        let application = xr::ApplicationInfo {
            application_name: "Paros",
            application_version: 1,
            engine_name: "Paros",
            engine_version: 1,
            api_version: xr::Version::new(1, 0, 0),
        };
        let made = platform.create_instance(&entry, &application, extensions.clone());
        let instance = made.map_err(instance_error)?;
        let properties = instance.properties().could_not("name the runtime")?;
        let name = format!("{} {}", properties.runtime_name, properties.runtime_version);
        let system = instance.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY).map_err(|result| {
            Error::Unavailable(format!("{name} has no headset ({result:?}): connect one"))
        })?;
        let extent = recommended_eye_extent(&instance, system, &name)?;
        let modes = instance.enumerate_environment_blend_modes(system, VIEW_CONFIGURATION);
        let blend_mode = choose_blend_mode(&modes.could_not("list the blend modes")?);
        let set_thread_type = find_set_thread_type(&instance, &extensions);
        Ok(Runtime { instance, system, extensions, name, extent, blend_mode, set_thread_type })
    }

    /// Returns `true` if swapchains may be requested with subsampled images.
    pub(crate) fn can_subsample(&self) -> bool {
        self.extensions.names().contains(&xr::sys::META_VULKAN_SWAPCHAIN_CREATE_INFO_EXTENSION_NAME)
    }

    /// Returns the names of those extensions that are not enabled.
    pub(crate) fn find_disabled_extensions<'a>(&self, names: &[&'a str]) -> Vec<&'a str> {
        let asked = self.extensions.names();
        let has = |name: &str| {
            asked.iter().any(|asked| asked.strip_suffix(b"\0") == Some(name.as_bytes()))
        };
        names.iter().copied().filter(|name| !has(name)).collect()
    }

    /// Creates a Vulkan instance through this runtime.
    ///
    /// # Errors
    /// [`Error::Unavailable`], or a call that failed.
    pub(crate) fn create_vulkan(
        &self,
        options: &gpu::Options,
    ) -> Result<Arc<gpu::Instance>, Error> {
        let needs = self.instance.graphics_requirements::<xr::Vulkan>(self.system);
        let needs = needs.could_not("ask what Vulkan it needs")?;
        if needs.min_api_version_supported > VULKAN_VERSION {
            let least = needs.min_api_version_supported;
            let why =
                format!("{} needs Vulkan {least}, and this is for {VULKAN_VERSION}", self.name);
            return Err(Error::Unavailable(why));
        }
        gpu::Instance::create_with(options, |entry, info| self.create_vulkan_instance(entry, info))
    }

    /// Creates a device on the physical device that the runtime names.
    ///
    /// # Errors
    /// A device without multiview, or a call that failed.
    pub(crate) fn create_gpu(
        &self,
        instance: Arc<gpu::Instance>,
        options: &gpu::Options,
    ) -> Result<Arc<Gpu>, Error> {
        let raw = instance.raw.handle().as_raw() as xr::sys::platform::VkInstance;
        // SAFETY: the instance was made by way of this runtime.
        let physical = unsafe { self.instance.vulkan_graphics_device(self.system, raw) };
        let physical = vk::PhysicalDevice::from_raw(physical.could_not("name the device")? as u64);
        let entry = instance.entry.clone();
        Gpu::create_with(instance, options, physical, |info| {
            self.create_vulkan_device(&entry, physical, info)
        })
    }

    fn create_vulkan_instance(
        &self,
        entry: &ash::Entry,
        info: &vk::InstanceCreateInfo<'_>,
    ) -> Result<vk::Instance, Error> {
        let info = core::ptr::from_ref(info).cast();
        // SAFETY: all that `info` points to lives until the call returns, and the loader is open.
        let made = unsafe {
            self.instance.create_vulkan_instance(self.system, vulkan_proc_addr(entry), info)
        };
        let made = made
            .could_not("make a Vulkan instance")?
            .map_err(vulkan_could_not("make an instance"))?;
        Ok(vk::Instance::from_raw(made as u64))
    }

    fn create_vulkan_device(
        &self,
        entry: &ash::Entry,
        physical: vk::PhysicalDevice,
        info: &vk::DeviceCreateInfo<'_>,
    ) -> Result<vk::Device, Error> {
        let physical = physical.as_raw() as xr::sys::platform::VkPhysicalDevice;
        let info = core::ptr::from_ref(info).cast();
        // SAFETY: as above, and the physical device is the one that the runtime named.
        let made = unsafe {
            self.instance.create_vulkan_device(self.system, vulkan_proc_addr(entry), physical, info)
        };
        let made =
            made.could_not("make a Vulkan device")?.map_err(vulkan_could_not("make a device"))?;
        Ok(vk::Device::from_raw(made as u64))
    }
}

/// Returns all extensions that the shell enables if they are offered. Thread settings matter only on Android,
/// and only there does the `openxr` crate name them.
fn wanted_extensions(options: &ShellOptions) -> xr::ExtensionSet {
    let mut names = vec![THREAD_SETTINGS];
    if options.foveation != Some(FoveationLevel::Off) {
        names.push(xr::sys::META_VULKAN_SWAPCHAIN_CREATE_INFO_EXTENSION_NAME);
    }
    let mut wanted: xr::ExtensionSet = names.into_iter().collect();
    wanted.khr_vulkan_enable2 = true;
    wanted.khr_composition_layer_depth = options.submit_depth;
    wanted.ext_hand_interaction = true;
    wanted.ext_hand_tracking = true;
    wanted.ext_local_floor = true;
    wanted.ext_user_presence = true;
    wanted.ext_performance_settings = true;
    wanted.fb_display_refresh_rate = true;
    wanted.fb_touch_controller_pro = true;
    wanted.meta_touch_controller_plus = true;
    wanted.meta_recommended_layer_resolution = true;
    if options.foveation != Some(FoveationLevel::Off) {
        wanted.fb_foveation = true;
        wanted.fb_foveation_configuration = true;
        wanted.fb_foveation_vulkan = true;
        wanted.fb_swapchain_update_state = true;
    }
    wanted
}

fn find_set_thread_type(
    instance: &xr::Instance,
    extensions: &xr::ExtensionSet,
) -> Option<SetThreadType> {
    if !extensions.names().contains(&THREAD_SETTINGS) {
        return None;
    }
    let (name, mut found) = (c"xrSetAndroidApplicationThreadKHR", None);
    let find = instance.entry().fp().get_instance_proc_addr;
    // SAFETY: the instance is alive, the name a C string, and there is room for a function.
    let _ = unsafe { find(instance.as_raw(), name.as_ptr(), &mut found) };
    // SAFETY: this is the type that goes with the name.
    found.map(|found| unsafe {
        core::mem::transmute::<xr::sys::pfn::VoidFunction, SetThreadType>(found)
    })
}

/// Returns the recommended extent of an eye's image, which both eyes share.
fn recommended_eye_extent(
    instance: &xr::Instance,
    system: xr::SystemId,
    runtime_name: &str,
) -> Result<[u32; 2], Error> {
    let views = instance.enumerate_view_configuration_views(system, VIEW_CONFIGURATION);
    let views =
        views.map_err(|_| Error::Unavailable(format!("{runtime_name} shows no two eyes")))?;
    let [left, right] = &views[..] else {
        return Err(Error::Unavailable(format!(
            "{runtime_name} shows {} eyes, not two",
            views.len()
        )));
    };
    // Both eyes are layers of one image: take the larger extent.
    let size = |view: &xr::ViewConfigurationView| {
        [view.recommended_image_rect_width, view.recommended_image_rect_height]
    };
    let (left, right) = (size(left), size(right));
    Ok([left[0].max(right[0]), left[1].max(right[1])])
}

fn instance_error(result: xr::sys::Result) -> Error {
    match result {
        xr::sys::Result::ERROR_RUNTIME_UNAVAILABLE | xr::sys::Result::ERROR_RUNTIME_FAILURE => {
            let remedy = "start one, or name another by XR_RUNTIME_JSON";
            Error::Unavailable(format!("no OpenXR runtime answers ({result:?}): {remedy}"))
        }
        result => Error::Call { action: "make an instance", result },
    }
}

fn vulkan_could_not(action: &'static str) -> impl Fn(i32) -> Error {
    move |result| Error::Gpu(gpu::Error::Call { action, result: vk::Result::from_raw(result) })
}

/// Returns `vkGetInstanceProcAddr`, through which the runtime finds Vulkan's functions.
fn vulkan_proc_addr(entry: &ash::Entry) -> xr::sys::platform::VkGetInstanceProcAddr {
    let from = entry.static_fn().get_instance_proc_addr;
    // SAFETY: both are the type of `vkGetInstanceProcAddr`, as two crates spell it.
    unsafe { core::mem::transmute(from) }
}
