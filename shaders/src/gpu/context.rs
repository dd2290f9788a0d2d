//! A Vulkan instance and device: which one fits, and what it offers beyond the least.

use std::ffi::{CStr, c_char, c_void};
use std::sync::{Arc, Mutex};

use ash::{ext, vk};

use super::error::{Doing, Error};
use super::faults;
use super::needs::Needs;
use super::offer::{family, name_of, rank};

/// Vulkan 1.1 has multiview in its core.
pub(super) const API: u32 = vk::API_VERSION_1_1;

/// How an instance and a device are made.
#[derive(Clone, Default, Debug)]
pub struct Options {
    /// Instance extensions that the shell needs, for its window.
    pub instance_extensions: Vec<&'static CStr>,
    /// Device extensions that the shell needs, for its swapchain.
    pub device_extensions: Vec<&'static CStr>,
    /// Whether the Khronos validation layer looks on; what it says is kept.
    pub validation: bool,
    /// A part of the name of the device that is meant, in any case; else the best one.
    pub device: Option<String>,
    /// Whether to do without half precision where it is offered.
    pub single: bool,
    /// Whether to upload by copies alone, as where programs can't write textures.
    pub copies: bool,
    /// Whether density maps are wanted, for a format with [`Format::density_map`].
    ///
    /// [`Format::density_map`]: super::Format::density_map
    pub density_map: bool,
    /// Whether shaded fragments are to be counted, for measuring.
    pub fragment_counts: bool,
    /// Puts a measurer's functions around the device's own.
    pub around_device: Option<fn(ash::Device) -> ash::Device>,
}

/// An instance, and what validation has said about it.
pub struct Instance {
    /// The loader, which must outlive the instance.
    pub entry: ash::Entry,
    /// The instance.
    pub raw: ash::Instance,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
    messages: Arc<Mutex<Vec<String>>>,
}

/// A device with one queue, shared by all that is made on it.
pub struct Gpu {
    /// The instance that it comes from; it outlives the device.
    pub instance: Arc<Instance>,
    /// The physical device.
    pub physical: vk::PhysicalDevice,
    /// The device.
    pub device: ash::Device,
    /// The family of its queue.
    pub family: u32,
    /// A queue for graphics.
    pub queue: vk::Queue,
    /// What it offers.
    pub needs: Needs,
    /// What was asked for and it has not, for the shell to tell once: the renderer does without.
    pub lacks: Vec<&'static str>,
    /// Its name.
    pub name: String,
    pub(super) memory: vk::PhysicalDeviceMemoryProperties,
}

/// A device of this process alone, for pictures without a window.
pub type Context = Arc<Gpu>;

impl core::fmt::Debug for Gpu {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Gpu").field("name", &self.name).field("needs", &self.needs).finish()
    }
}

impl core::fmt::Debug for Instance {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Instance").field("validation", &self.messenger.is_some()).finish()
    }
}

impl Instance {
    /// Opens the loader and makes an instance.
    ///
    /// # Errors
    /// [`Error::NoLoader`], or a call that failed: a layer or an extension that isn't there.
    pub fn new(options: &Options) -> Result<Arc<Self>, Error> {
        Self::made_by(options, |entry, info| {
            // SAFETY: all that `info` points to lives until the call returns.
            let made = unsafe { entry.create_instance(info, None) }.doing("make an instance")?;
            Ok(made.handle())
        })
    }

    /// Opens the loader and has `make` make an instance: a headset's runtime adds to what is asked.
    ///
    /// # Errors
    /// [`Error::NoLoader`], or what `make` met with.
    pub fn made_by<E: From<Error>>(
        options: &Options,
        make: impl FnOnce(&ash::Entry, &vk::InstanceCreateInfo<'_>) -> Result<vk::Instance, E>,
    ) -> Result<Arc<Self>, E> {
        // SAFETY: the loader is the system's own; loading it runs its initialisers.
        let entry =
            unsafe { ash::Entry::load() }.map_err(|error| Error::NoLoader(error.to_string()))?;
        let application =
            vk::ApplicationInfo::default().application_name(c"Paros").api_version(API);
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
            instance.listen()?;
        }
        Ok(Arc::new(instance))
    }

    /// What validation has complained of so far.
    #[must_use]
    pub fn messages(&self) -> Vec<String> {
        self.messages.lock().map(|messages| messages.clone()).unwrap_or_default()
    }

    fn listen(&mut self) -> Result<(), Error> {
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
            .pfn_user_callback(Some(keep_message))
            .user_data(Arc::as_ptr(&self.messages).cast_mut().cast::<c_void>());
        // SAFETY: the messages outlive the messenger, which `drop` destroys first.
        let messenger = unsafe { debug.create_debug_utils_messenger(&info, None) }
            .doing("listen to validation")?;
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

unsafe extern "system" fn keep_message(
    _severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    messages: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: `listen` gave a pointer to the messages, which outlive the messenger.
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
    /// The best device of this machine without a window.
    ///
    /// # Errors
    /// See [`Instance::new`] and [`Gpu::new`].
    pub fn headless(options: &Options) -> Result<Arc<Self>, Error> {
        Gpu::new(Instance::new(options)?, options, |_, _| true)
    }

    /// The best device of which `presents` says, of it and a family of its queues, that it serves
    /// the shell.
    ///
    /// # Errors
    /// [`Error::NoDevice`] with what each lacks, or a call that failed.
    pub fn new(
        instance: Arc<Instance>,
        options: &Options,
        presents: impl Fn(vk::PhysicalDevice, u32) -> bool,
    ) -> Result<Arc<Self>, Error> {
        // SAFETY: the instance is alive.
        let all = unsafe { instance.raw.enumerate_physical_devices() }.doing("list devices")?;
        let mut refused = Vec::new();
        let mut fitting = Vec::new();
        for physical in all {
            // SAFETY: the physical device is one of this instance's.
            let properties = unsafe { instance.raw.get_physical_device_properties(physical) };
            let name = name_of(&properties);
            let meant = options
                .device
                .as_ref()
                .is_none_or(|part| name.to_lowercase().contains(&part.to_lowercase()));
            if !meant {
                refused.push(format!("{name} is not the one asked for"));
                continue;
            }
            match family(&instance.raw, physical, &properties, &presents) {
                Ok(family) => fitting.push((rank(properties.device_type), physical, family, name)),
                Err(lacks) => refused.push(format!("{name} {lacks}")),
            }
        }
        fitting.sort_by_key(|(rank, ..)| *rank);
        let Some((_, physical, family, name)) = fitting.into_iter().next() else {
            return Err(Error::NoDevice(refused));
        };
        let raw = instance.raw.clone();
        Self::on(instance, options, (physical, family, name), |info| {
            // SAFETY: all that `info` points to lives until the call returns.
            let made = unsafe { raw.create_device(physical, info, None) }.doing("make a device")?;
            Ok(made.handle())
        })
    }

    /// A physical device that is not ours to choose; `make` makes the device: a headset's runtime
    /// adds to what is asked.
    ///
    /// # Errors
    /// [`Error::NoDevice`] with what it lacks, or what `make` met with.
    pub fn made_by<E: From<Error>>(
        instance: Arc<Instance>,
        options: &Options,
        physical: vk::PhysicalDevice,
        make: impl FnOnce(&vk::DeviceCreateInfo<'_>) -> Result<vk::Device, E>,
    ) -> Result<Arc<Self>, E> {
        // SAFETY: the physical device is one of this instance's.
        let properties = unsafe { instance.raw.get_physical_device_properties(physical) };
        let name = name_of(&properties);
        let family = family(&instance.raw, physical, &properties, &|_, _| true)
            .map_err(|lacks| Error::NoDevice(vec![format!("{name} {lacks}")]))?;
        Self::on(instance, options, (physical, family, name), make)
    }

    fn on<E: From<Error>>(
        instance: Arc<Instance>,
        options: &Options,
        (physical, family, name): (vk::PhysicalDevice, u32, String),
        make: impl FnOnce(&vk::DeviceCreateInfo<'_>) -> Result<vk::Device, E>,
    ) -> Result<Arc<Self>, E> {
        let (needs, lacks) = Needs::agreed(&instance.raw, physical, family, options);
        let made = needs.with_device_info(family, options, make)?;
        // SAFETY: the device is alive, and is this instance's.
        let device = unsafe { ash::Device::load(instance.raw.fp_v1_0(), made) };
        let device = faults::wrapped(device);
        let device = match options.around_device {
            Some(around) => around(device),
            None => device,
        };
        // SAFETY: the device was made with one queue of this family.
        let queue = unsafe { device.get_device_queue(family, 0) };
        // SAFETY: the physical device is one of this instance's.
        let memory = unsafe { instance.raw.get_physical_device_memory_properties(physical) };
        Ok(Arc::new(Gpu { instance, physical, device, family, queue, needs, lacks, name, memory }))
    }

    /// Pixels along a side of the largest image that it draws into.
    #[must_use]
    pub fn longest_side(&self) -> u32 {
        let limits = self.properties().limits;
        limits.max_image_dimension2_d.min(limits.max_framebuffer_width)
    }

    /// Whether it is no device, but this machine's processors.
    #[must_use]
    pub fn is_software(&self) -> bool {
        self.properties().device_type == vk::PhysicalDeviceType::CPU
    }

    fn properties(&self) -> vk::PhysicalDeviceProperties {
        // SAFETY: the physical device is one of this instance's.
        unsafe { self.instance.raw.get_physical_device_properties(self.physical) }
    }

    /// Waits until the device has done all it was given.
    ///
    /// # Errors
    /// A lost device.
    pub fn wait(&self) -> Result<(), Error> {
        // SAFETY: the queue is used by one thread.
        unsafe { self.device.device_wait_idle() }.doing("wait for the device")
    }
}

impl Drop for Gpu {
    fn drop(&mut self) {
        // SAFETY: whatever was made on the device keeps it alive, so nothing is left.
        unsafe { self.device.destroy_device(None) };
    }
}
