//! The Vulkan instance with its validation messages, and the logical device with its queue.

use std::ffi::{CStr, c_char, c_void};
use std::sync::{Arc, Mutex};

use ash::{ext, vk};

use super::error::{Error, ErrorContext};
use super::features::{DeviceFeatures, NegotiatedFeatures};
use super::options::Options;
use super::selection::{
    API_VERSION, device_name, find_graphics_queue_family, rank_device_type_best_first,
};

/// A Vulkan instance, and the messages of the validation layer.
pub struct Instance {
    /// The Vulkan loader, which must outlive the instance.
    pub entry: ash::Entry,
    /// The instance.
    pub raw: ash::Instance,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    messages: Arc<Mutex<Vec<String>>>,
}

/// A logical device with one graphics queue. Every object made on it holds a reference.
pub struct Gpu {
    /// The instance, which outlives the device.
    pub instance: Arc<Instance>,
    /// The physical device.
    pub physical_device: vk::PhysicalDevice,
    /// The logical device.
    pub device: ash::Device,
    /// Index of the queue's family.
    pub queue_family: u32,
    /// The graphics queue, used by one thread.
    pub queue: vk::Queue,
    /// The optional features that are enabled.
    pub features: DeviceFeatures,
    /// Requested features that the device lacks, as text for the user; the renderer does without.
    pub missing_features: Vec<&'static str>,
    /// The device's name.
    pub name: String,
    pub(crate) memory: vk::PhysicalDeviceMemoryProperties,
}

/// The chosen physical device, and its queue family.
struct DeviceChoice {
    physical: vk::PhysicalDevice,
    /// Index of the queue family.
    family: u32,
    name: String,
}

/// A shared reference to a device.
pub type SharedGpu = Arc<Gpu>;

impl core::fmt::Debug for Gpu {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Gpu").field("name", &self.name).field("features", &self.features).finish()
    }
}

impl core::fmt::Debug for Instance {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Instance").field("validation", &self.messenger.is_some()).finish()
    }
}

impl Instance {
    /// Loads Vulkan and creates an instance.
    ///
    /// # Errors
    /// [`Error::NoLoader`], or a failed call, for example because a layer or an extension is missing.
    pub fn create(options: &Options) -> Result<Arc<Self>, Error> {
        Self::create_with(options, |entry, info| {
            // SAFETY: all that `info` points to lives until the call returns.
            let made =
                unsafe { entry.create_instance(info, None) }.could_not("make an instance")?;
            Ok(made.handle())
        })
    }

    /// Loads Vulkan and has `make` create the instance from the given info: with OpenXR the runtime
    /// creates it, and may add extensions.
    ///
    /// # Errors
    /// [`Error::NoLoader`], or the error of `make`.
    pub fn create_with<E: From<Error>>(
        options: &Options,
        make: impl FnOnce(&ash::Entry, &vk::InstanceCreateInfo<'_>) -> Result<vk::Instance, E>,
    ) -> Result<Arc<Self>, E> {
        // SAFETY: the loader is the system's own; loading it runs its initialisers.
        let entry =
            unsafe { ash::Entry::load() }.map_err(|error| Error::NoLoader(error.to_string()))?;
        let application =
            vk::ApplicationInfo::default().application_name(c"Paros").api_version(API_VERSION);
        let mut extensions: Vec<*const c_char> =
            options.instance_extensions.iter().map(|name| name.as_ptr()).collect();
        let mut layers = Vec::new();
        if options.validation {
            extensions.push(ext::debug_utils::NAME.as_ptr());
            layers.push(c"VK_LAYER_KHRONOS_validation".as_ptr());
        }
        let checks = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let mut features =
            vk::ValidationFeaturesEXT::default().enabled_validation_features(&checks);
        let mut info = vk::InstanceCreateInfo::default()
            .application_info(&application)
            .enabled_extension_names(&extensions)
            .enabled_layer_names(&layers);
        if options.validation {
            info = info.push_next(&mut features);
        }
        let made = make(&entry, &info)?;
        // SAFETY: the instance is alive, and was made by way of this loader.
        let raw = unsafe { ash::Instance::load(entry.static_fn(), made) };
        let messages = Arc::new(Mutex::new(Vec::new()));
        let mut instance = Instance { entry, raw, messenger: None, messages };
        if options.validation {
            instance.install_messenger()?;
        }
        Ok(Arc::new(instance))
    }

    /// Returns the warnings and errors of validation so far.
    #[must_use]
    pub fn validation_messages(&self) -> Vec<String> {
        self.messages.lock().map(|messages| messages.clone()).unwrap_or_default()
    }

    /// Installs the debug messenger that collects validation messages.
    fn install_messenger(&mut self) -> Result<(), Error> {
        let debug = ext::debug_utils::Instance::new(&self.entry, &self.raw);
        let info = vk::DebugUtilsMessengerCreateInfoEXT::default()
            .message_severity(
                vk::DebugUtilsMessageSeverityFlagsEXT::ERROR
                    | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING,
            )
            .message_type(
                vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION
                    | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE,
            )
            .pfn_user_callback(Some(store_message))
            .user_data(Arc::as_ptr(&self.messages).cast_mut().cast::<c_void>());
        // SAFETY: the messages outlive the messenger, which `drop` destroys first.
        let messenger = unsafe { debug.create_debug_utils_messenger(&info, None) }
            .could_not("listen to validation")?;
        self.messenger = Some((debug, messenger));
        Ok(())
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        if let Some((debug, messenger)) = self.messenger.take() {
            // SAFETY: it was made from this instance and is destroyed once.
            unsafe { debug.destroy_debug_utils_messenger(messenger, None) };
        }
        // SAFETY: devices keep the instance alive, so none is left.
        unsafe { self.raw.destroy_instance(None) };
    }
}

unsafe extern "system" fn store_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: `install_messenger` gave a pointer to the messages, which outlive the messenger.
    let messages = unsafe { &*messages.cast::<Mutex<Vec<String>>>() };
    // SAFETY: the layer's data is valid during the call, its message a C string or null.
    let text = unsafe {
        match data.as_ref().map(|data| data.p_message) {
            Some(text) if !text.is_null() => CStr::from_ptr(text).to_string_lossy().into_owned(),
            _ => String::from("a message without a text"),
        }
    };
    if let Ok(mut messages) = messages.lock() {
        messages.push(text);
    }
    vk::FALSE
}

impl Gpu {
    /// Creates a device on the best physical device of this machine, without presentation.
    ///
    /// # Errors
    /// See [`Instance::create`] and [`Gpu::choose`].
    pub fn headless(options: &Options) -> Result<Arc<Self>, Error> {
        Gpu::choose(Instance::create(options)?, options, |_, _| true)
    }

    /// Chooses the best suitable physical device and creates a logical device on it. `presents` returns
    /// `true` if a physical device and a queue family can present to the shell's window.
    ///
    /// # Errors
    /// [`Error::NoDevice`] with the reason for each physical device, or a failed call.
    pub fn choose(
        instance: Arc<Instance>,
        options: &Options,
        presents: impl Fn(vk::PhysicalDevice, u32) -> bool,
    ) -> Result<Arc<Self>, Error> {
        // SAFETY: the instance is alive.
        let all = unsafe { instance.raw.enumerate_physical_devices() }.could_not("list devices")?;
        let mut refused = Vec::new();
        let mut fitting = Vec::new();
        for physical in all {
            // SAFETY: the physical device is one of this instance's.
            let properties = unsafe { instance.raw.get_physical_device_properties(physical) };
            let name = device_name(&properties);
            let meant = options
                .device_name
                .as_ref()
                .is_none_or(|part| name.to_lowercase().contains(&part.to_lowercase()));
            if !meant {
                refused.push(format!("{name} is not the one asked for"));
                continue;
            }
            match find_graphics_queue_family(&instance.raw, physical, &properties, &presents) {
                Ok(family) => {
                    let rank = rank_device_type_best_first(properties.device_type);
                    fitting.push((rank, DeviceChoice { physical, family, name }));
                }
                Err(lacks) => refused.push(format!("{name} {lacks}")),
            }
        }
        fitting.sort_by_key(|(rank, ..)| *rank);
        let Some((_, choice)) = fitting.into_iter().next() else {
            return Err(Error::NoDevice(refused));
        };
        let (raw, physical) = (instance.raw.clone(), choice.physical);
        Self::create_device(instance, options, choice, |info| {
            // SAFETY: all that `info` points to lives until the call returns.
            let made =
                unsafe { raw.create_device(physical, info, None) }.could_not("make a device")?;
            Ok(made.handle())
        })
    }

    /// Has `make` create a logical device on a given physical device: with OpenXR the runtime chooses the
    /// physical device, creates the logical one, and may add extensions.
    ///
    /// # Errors
    /// [`Error::NoDevice`] with what the device lacks, or the error of `make`.
    pub fn create_with<E: From<Error>>(
        instance: Arc<Instance>,
        options: &Options,
        physical: vk::PhysicalDevice,
        make: impl FnOnce(&vk::DeviceCreateInfo<'_>) -> Result<vk::Device, E>,
    ) -> Result<Arc<Self>, E> {
        // SAFETY: the physical device is one of this instance's.
        let properties = unsafe { instance.raw.get_physical_device_properties(physical) };
        let name = device_name(&properties);
        let family = find_graphics_queue_family(&instance.raw, physical, &properties, &|_, _| true)
            .map_err(|lacks| Error::NoDevice(vec![format!("{name} {lacks}")]))?;
        Self::create_device(instance, options, DeviceChoice { physical, family, name }, make)
    }

    /// Creates the logical device and fetches its queue.
    fn create_device<E: From<Error>>(
        instance: Arc<Instance>,
        options: &Options,
        DeviceChoice { physical, family, name }: DeviceChoice,
        make: impl FnOnce(&vk::DeviceCreateInfo<'_>) -> Result<vk::Device, E>,
    ) -> Result<Arc<Self>, E> {
        let NegotiatedFeatures { enabled, missing } =
            DeviceFeatures::negotiate(&instance.raw, physical, family, options);
        let made = enabled.with_create_info(family, options, make)?;
        // SAFETY: the device is alive, and is this instance's.
        let device = unsafe { ash::Device::load(instance.raw.fp_v1_0(), made) };
        let device = match options.device_hook {
            Some(around) => around(device),
            None => device,
        };
        // SAFETY: the device was made with one queue of this family.
        let queue = unsafe { device.get_device_queue(family, 0) };
        // SAFETY: the physical device is one of this instance's.
        let memory = unsafe { instance.raw.get_physical_device_memory_properties(physical) };
        Ok(Arc::new(Gpu {
            instance,
            physical_device: physical,
            device,
            queue_family: family,
            queue,
            features: enabled,
            missing_features: missing,
            name,
            memory,
        }))
    }

    /// Returns the side of the largest square render target, in pixels.
    #[must_use]
    pub fn max_image_side(&self) -> u32 {
        let limits = self.properties().limits;
        limits.max_image_dimension2_d.min(limits.max_framebuffer_width)
    }

    /// Returns `true` if the device is a software implementation on the CPU.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.properties().device_type == vk::PhysicalDeviceType::CPU
    }

    /// Returns `true` for an integrated GPU, which shares the processor's memory, as a headset's does.
    #[must_use]
    pub fn is_integrated(&self) -> bool {
        self.properties().device_type == vk::PhysicalDeviceType::INTEGRATED_GPU
    }

    fn properties(&self) -> vk::PhysicalDeviceProperties {
        // SAFETY: the physical device is one of this instance's.
        unsafe { self.instance.raw.get_physical_device_properties(self.physical_device) }
    }

    /// Waits until the device is idle.
    ///
    /// # Errors
    /// A lost device.
    pub fn wait_idle(&self) -> Result<(), Error> {
        // SAFETY: the queue is used by one thread.
        unsafe { self.device.device_wait_idle() }.could_not("wait for the device")
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        // SAFETY: whatever was made on the device keeps it alive, so nothing is left.
        unsafe { self.device.destroy_device(None) };
    }
}
