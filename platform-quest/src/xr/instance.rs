//! The runtime: an instance, the headset, and a Vulkan device made by way of it.

use std::sync::Arc;

use ash::vk::{self, Handle};
use openxr as xr;
use paros_shaders::gpu::{self, Gpu};

use super::VIEWS;
use crate::error::{Doing, Error};
use crate::foveation::Foveation;
use crate::host::Host;
use crate::options::Options;

/// Vulkan 1.1 has multiview in its core.
const VULKAN: xr::Version = xr::Version::new(1, 1, 0);

/// An instance and the headset behind it.
pub(crate) struct Runtime {
    pub(crate) instance: xr::Instance,
    pub(crate) system: xr::SystemId,
    /// What was asked for, of what is offered.
    pub(crate) extensions: xr::ExtensionSet,
    /// Its name and version, for people.
    pub(crate) name: String,
    /// Pixels of an eye's image, as recommended.
    pub(crate) extent: [u32; 2],
    /// How pictures are laid over the world.
    pub(crate) blend: xr::EnvironmentBlendMode,
    /// Tells the system what a thread is for.
    pub(crate) thread_types: Option<NameThread>,
}

/// `PFN_xrSetAndroidApplicationThreadKHR`, which the crate has on Android alone.
pub(crate) type NameThread =
    unsafe extern "system" fn(xr::sys::Session, xr::AndroidThreadTypeKHR, u32) -> xr::sys::Result;

const THREADS: &[u8] = b"XR_KHR_android_thread_settings\0";

impl Runtime {
    /// The runtime of this system and its headset.
    ///
    /// # Errors
    /// [`Error::Unavailable`] with what is missing, or a call that failed.
    pub(crate) fn new(host: &mut dyn Host, options: &Options) -> Result<Self, Error> {
        let entry = host.entry()?;
        let offered = entry.enumerate_extensions().map_err(unavailable)?;
        if !offered.khr_vulkan_enable2 {
            let why = "the OpenXR runtime has no XR_KHR_vulkan_enable2";
            return Err(Error::Unavailable(why.into()));
        }
        let extensions = wanted(options).intersection(&offered);
        let application = xr::ApplicationInfo {
            application_name: "Paros",
            application_version: 1,
            engine_name: "Paros",
            engine_version: 1,
            api_version: xr::Version::new(1, 0, 0),
        };
        let made = host.instance(&entry, &application, extensions.clone());
        let instance = made.map_err(unavailable)?;
        let properties = instance.properties().doing("name the runtime")?;
        let name = format!("{} {}", properties.runtime_name, properties.runtime_version);
        let system = instance.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY).map_err(|result| {
            Error::Unavailable(format!("{name} has no headset ({result:?}): connect one"))
        })?;
        let extent = stereo(&instance, system, &name)?;
        let modes = instance.enumerate_environment_blend_modes(system, VIEWS);
        let blend = modes.doing("list the blend modes")?.first().copied();
        let blend = blend.unwrap_or(xr::EnvironmentBlendMode::OPAQUE);
        let thread_types = thread_types(&instance, &extensions);
        Ok(Runtime { instance, system, extensions, name, extent, blend, thread_types })
    }

    /// Which of some extensions it can't be asked for, by name.
    pub(crate) fn lacks<'a>(&self, names: &[&'a str]) -> Vec<&'a str> {
        let asked = self.extensions.names();
        let has = |name: &str| {
            asked.iter().any(|asked| asked.strip_suffix(b"\0") == Some(name.as_bytes()))
        };
        names.iter().copied().filter(|name| !has(name)).collect()
    }

    /// Vulkan by way of this runtime.
    ///
    /// # Errors
    /// [`Error::Unavailable`], or a call that failed.
    pub(crate) fn vulkan(&self, options: &gpu::Options) -> Result<Arc<gpu::Instance>, Error> {
        let needs = self.instance.graphics_requirements::<xr::Vulkan>(self.system);
        let needs = needs.doing("ask what Vulkan it needs")?;
        if needs.min_api_version_supported > VULKAN {
            let least = needs.min_api_version_supported;
            let why = format!("{} needs Vulkan {least}, and this is for {VULKAN}", self.name);
            return Err(Error::Unavailable(why));
        }
        gpu::Instance::made_by(options, |entry, info| self.make_vulkan(entry, info))
    }

    /// The device that the headset's pictures must be drawn by.
    ///
    /// # Errors
    /// A device without multiview, or a call that failed.
    pub(crate) fn gpu(
        &self,
        instance: Arc<gpu::Instance>,
        options: &gpu::Options,
    ) -> Result<Arc<Gpu>, Error> {
        let raw = instance.raw.handle().as_raw() as xr::sys::platform::VkInstance;
        // SAFETY: the instance was made by way of this runtime.
        let physical = unsafe { self.instance.vulkan_graphics_device(self.system, raw) };
        let physical = vk::PhysicalDevice::from_raw(physical.doing("name the device")? as u64);
        let entry = instance.entry.clone();
        Gpu::made_by(instance, options, physical, |info| self.device(&entry, physical, info))
    }

    fn make_vulkan(
        &self,
        entry: &ash::Entry,
        info: &vk::InstanceCreateInfo<'_>,
    ) -> Result<vk::Instance, Error> {
        let info = core::ptr::from_ref(info).cast();
        // SAFETY: all that `info` points to lives until the call returns, and the loader is open.
        let made =
            unsafe { self.instance.create_vulkan_instance(self.system, loader(entry), info) };
        let made = made.doing("make a Vulkan instance")?.map_err(call("make an instance"))?;
        Ok(vk::Instance::from_raw(made as u64))
    }

    fn device(
        &self,
        entry: &ash::Entry,
        physical: vk::PhysicalDevice,
        info: &vk::DeviceCreateInfo<'_>,
    ) -> Result<vk::Device, Error> {
        let physical = physical.as_raw() as xr::sys::platform::VkPhysicalDevice;
        let info = core::ptr::from_ref(info).cast();
        // SAFETY: as above, and the physical device is the one that the runtime named.
        let made = unsafe {
            self.instance.create_vulkan_device(self.system, loader(entry), physical, info)
        };
        let made = made.doing("make a Vulkan device")?.map_err(call("make a device"))?;
        Ok(vk::Device::from_raw(made as u64))
    }
}

/// All that the shell makes use of where it is offered. Thread types are of no use but on Android,
/// and only there has the crate a name for them.
fn wanted(options: &Options) -> xr::ExtensionSet {
    let mut wanted: xr::ExtensionSet = [THREADS].into_iter().collect();
    wanted.khr_vulkan_enable2 = true;
    wanted.khr_composition_layer_depth = options.depth;
    wanted.ext_hand_tracking = true;
    wanted.ext_local_floor = true;
    wanted.ext_user_presence = true;
    wanted.ext_performance_settings = true;
    wanted.fb_display_refresh_rate = true;
    wanted.meta_touch_controller_plus = true;
    if options.foveation != Some(Foveation::Off) {
        wanted.fb_foveation = true;
        wanted.fb_foveation_configuration = true;
        wanted.fb_foveation_vulkan = true;
        wanted.fb_swapchain_update_state = true;
    }
    wanted
}

fn thread_types(instance: &xr::Instance, extensions: &xr::ExtensionSet) -> Option<NameThread> {
    if !extensions.names().contains(&THREADS) {
        return None;
    }
    let (name, mut found) = (c"xrSetAndroidApplicationThreadKHR", None);
    let find = instance.entry().fp().get_instance_proc_addr;
    // SAFETY: the instance is alive, the name a C string, and there is room for a function.
    let _ = unsafe { find(instance.as_raw(), name.as_ptr(), &mut found) };
    // SAFETY: this is the type that goes with the name.
    found.map(|found| unsafe {
        core::mem::transmute::<xr::sys::pfn::VoidFunction, NameThread>(found)
    })
}

/// Pixels of an eye's image.
fn stereo(instance: &xr::Instance, system: xr::SystemId, name: &str) -> Result<[u32; 2], Error> {
    let views = instance.enumerate_view_configuration_views(system, VIEWS);
    let views = views.map_err(|_| Error::Unavailable(format!("{name} shows no two eyes")))?;
    let [left, right] = &views[..] else {
        return Err(Error::Unavailable(format!("{name} shows {} eyes, not two", views.len())));
    };
    // Both are layers of one image.
    let size = |view: &xr::ViewConfigurationView| {
        [view.recommended_image_rect_width, view.recommended_image_rect_height]
    };
    let (left, right) = (size(left), size(right));
    Ok([left[0].max(right[0]), left[1].max(right[1])])
}

fn unavailable(result: xr::sys::Result) -> Error {
    match result {
        xr::sys::Result::ERROR_RUNTIME_UNAVAILABLE | xr::sys::Result::ERROR_RUNTIME_FAILURE => {
            let remedy = "start one, or name another by XR_RUNTIME_JSON";
            Error::Unavailable(format!("no OpenXR runtime answers ({result:?}): {remedy}"))
        }
        result => Error::Call { doing: "make an instance", result },
    }
}

fn call(doing: &'static str) -> impl Fn(i32) -> Error {
    move |result| Error::Gpu(gpu::Error::Call { doing, result: vk::Result::from_raw(result) })
}

/// Where the runtime finds Vulkan's functions.
fn loader(entry: &ash::Entry) -> xr::sys::platform::VkGetInstanceProcAddr {
    let from = entry.static_fn().get_instance_proc_addr;
    // SAFETY: both are the type of `vkGetInstanceProcAddr`, as two crates spell it.
    unsafe { core::mem::transmute(from) }
}
