//! A Vulkan layer in the same library as the OpenXR layer. It reports `VK_EXT_fragment_density_map`, which
//! lavapipe lacks, and removes the extension again when the device is created; lavapipe then shades the whole
//! image at full density. The validation layer is above this one and checks every use of the density maps. If
//! the layer's folder has a file `one-view`, the device reports no multiview. Pipelines are handled in
//! `pipelines`.

use std::ffi::{CStr, c_char, c_void};
use std::sync::Mutex;

use ash::vk;

/// The next layer of the chain, or the driver: its functions for finding functions.
#[derive(Clone, Copy)]
struct NextVulkanLayer {
    instance: vk::PFN_vkGetInstanceProcAddr,
    made: vk::Instance,
    device: Option<vk::PFN_vkGetDeviceProcAddr>,
}

static NEXT: Mutex<Option<NextVulkanLayer>> = Mutex::new(None);

const NAME: &CStr = ash::ext::fragment_density_map::NAME;

/// `VkNegotiateLayerInterface`.
#[repr(C)]
pub(crate) struct LayerNegotiation {
    ty: i32,
    next: *mut c_void,
    version: u32,
    instance: Option<vk::PFN_vkGetInstanceProcAddr>,
    device: Option<vk::PFN_vkGetDeviceProcAddr>,
    physical: Option<vk::PFN_vkGetInstanceProcAddr>,
}

/// `VkLayerInstanceCreateInfo` and `VkLayerDeviceCreateInfo`, which differ in their links.
#[repr(C)]
struct ChainedCreateInfo<L> {
    ty: vk::StructureType,
    next: *const c_void,
    /// 0 if `link` is valid.
    function: i32,
    link: *mut L,
}

/// `VkLayerInstanceLink` and `VkLayerDeviceLink`. The last field is a device's `vkGetDeviceProcAddr`; an
/// instance's isn't used here.
#[repr(C)]
struct LayerLink {
    next: *mut LayerLink,
    instance: vk::PFN_vkGetInstanceProcAddr,
    device: Option<vk::PFN_vkGetDeviceProcAddr>,
}

/// Negotiates the interface version between loader and layer: 2 at most.
///
/// # Safety
/// `request` is valid during the call.
#[unsafe(no_mangle)]
pub(crate) unsafe extern "system" fn vkNegotiateLoaderLayerInterfaceVersion(
    request: *mut LayerNegotiation,
) -> vk::Result {
    // SAFETY: the loader's request is valid during the call.
    let request = unsafe { &mut *request };
    request.version = request.version.min(2);
    request.instance = Some(get_instance_proc_addr);
    request.device = Some(get_device_proc_addr);
    request.physical = None;
    vk::Result::SUCCESS
}

/// Returns the hook for a function's name; `None` if the layer doesn't change the function.
fn find_hook(name: &CStr) -> vk::PFN_vkVoidFunction {
    macro_rules! functions {
        ($($name:literal: $ty:ident = $function:ident,)*) => {
            match name.to_str() {
                $(Ok($name) => {
                    let function: vk::$ty = $function;
                    // SAFETY: it is called by the type that goes with the name.
                    Some(unsafe { core::mem::transmute::<vk::$ty, unsafe extern "system" fn()>(function) })
                })*
                _ => None,
            }
        };
    }
    functions! {
        "vkGetInstanceProcAddr": PFN_vkGetInstanceProcAddr = get_instance_proc_addr,
        "vkGetDeviceProcAddr": PFN_vkGetDeviceProcAddr = get_device_proc_addr,
        "vkCreateInstance": PFN_vkCreateInstance = create_instance,
        "vkCreateDevice": PFN_vkCreateDevice = create_device,
        "vkEnumerateDeviceExtensionProperties": PFN_vkEnumerateDeviceExtensionProperties = enumerate_device_extensions,
        "vkGetPhysicalDeviceFeatures2": PFN_vkGetPhysicalDeviceFeatures2 = get_features,
        // The loader also calls these names if the extension is enabled.
        "vkGetPhysicalDeviceFeatures2KHR": PFN_vkGetPhysicalDeviceFeatures2 = get_features,
        "vkGetPhysicalDeviceProperties2KHR": PFN_vkGetPhysicalDeviceProperties2 = get_properties,
        "vkGetPhysicalDeviceProperties2": PFN_vkGetPhysicalDeviceProperties2 = get_properties,
    }
}

unsafe extern "system" fn get_instance_proc_addr(
    instance: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the name is a C string.
    find_hook(unsafe { CStr::from_ptr(name) }).or_else(|| {
        let next = NEXT.lock().ok().and_then(|next| *next)?;
        // SAFETY: handed on as it came.
        unsafe { (next.instance)(instance, name) }
    })
}

unsafe extern "system" fn get_device_proc_addr(
    device: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the name is a C string.
    if let Some(hook) = super::pipelines::find_hook(unsafe { CStr::from_ptr(name) }) {
        return Some(hook);
    }
    // SAFETY: handed on as it came.
    unsafe { next_device_function(device, name) }
}

/// Returns a function of the next layer for a device.
///
/// # Safety
/// The device is alive, and the name a C string.
pub(crate) unsafe fn next_device_function(
    device: vk::Device,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    let next = NEXT.lock().ok().and_then(|next| *next)?.device?;
    // SAFETY: the caller's.
    unsafe { next(device, name) }
}

/// Returns a function of the next layer, for the instance that was created last.
///
/// # Safety
/// `F` is the type of the function of this name.
unsafe fn next_function<F: Copy>(name: &CStr) -> F {
    let next = NEXT.lock().ok().and_then(|next| *next).expect("there is an instance");
    // SAFETY: the instance is alive, as one of its functions is being called.
    let function = unsafe { (next.instance)(next.made, name.as_ptr()) }.expect("it is there");
    // SAFETY: the caller's, and all functions are pointers of one size.
    unsafe { core::mem::transmute_copy::<unsafe extern "system" fn(), F>(&function) }
}

/// Removes this layer's link from a chain of create infos, and puts the next layer's in its place.
///
/// # Safety
/// The chain is one of the loader's, with a link.
unsafe fn take_layer_link(chain: *const c_void, ty: vk::StructureType) -> LayerLink {
    let mut at = chain.cast::<ChainedCreateInfo<LayerLink>>().cast_mut();
    // SAFETY: the caller's; each of its structures begins with its type and the next.
    unsafe {
        while (*at).ty != ty || (*at).function != 0 {
            at = (*at).next.cast::<ChainedCreateInfo<LayerLink>>().cast_mut();
        }
        let link = core::ptr::read((*at).link);
        (*at).link = link.next;
        link
    }
}

unsafe extern "system" fn create_instance(
    info: *const vk::InstanceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    instance: *mut vk::Instance,
) -> vk::Result {
    // SAFETY: the loader's structures are valid during the call.
    let link =
        unsafe { take_layer_link((*info).p_next, vk::StructureType::LOADER_INSTANCE_CREATE_INFO) };
    // SAFETY: it needs no instance.
    let create = unsafe { (link.instance)(vk::Instance::null(), c"vkCreateInstance".as_ptr()) };
    let Some(create) = create else { return vk::Result::ERROR_INITIALIZATION_FAILED };
    // SAFETY: this is the type that goes with the name.
    let create: vk::PFN_vkCreateInstance = unsafe { core::mem::transmute(create) };
    // SAFETY: handed on as it came, but for the link.
    let result = unsafe { create(info, allocator, instance) };
    if let (vk::Result::SUCCESS, Ok(mut next)) = (result, NEXT.lock()) {
        // SAFETY: the call has succeeded.
        let instance = unsafe { *instance };
        *next = Some(NextVulkanLayer { instance: link.instance, made: instance, device: None });
    }
    result
}

unsafe extern "system" fn create_device(
    physical: vk::PhysicalDevice,
    info: *const vk::DeviceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    device: *mut vk::Device,
) -> vk::Result {
    // SAFETY: the loader's structures are valid during the call.
    let (mut info, link) = unsafe {
        (*info, take_layer_link((*info).p_next, vk::StructureType::LOADER_DEVICE_CREATE_INFO))
    };
    if let Ok(mut next) = NEXT.lock()
        && let Some(next) = &mut *next
    {
        next.device = link.device;
    }
    let count = info.enabled_extension_count as usize;
    let names = match count {
        0 => &[],
        // SAFETY: as many names as the shell says.
        _ => unsafe { core::slice::from_raw_parts(info.pp_enabled_extension_names, count) },
    };
    // SAFETY: they are C strings.
    let theirs = |name: &*const c_char| unsafe { CStr::from_ptr(*name) } != NAME;
    let names: Vec<*const c_char> = names.iter().copied().filter(theirs).collect();
    super::folder::log_line(&format!("density maps {}", count - names.len()));
    info.enabled_extension_count = names.len() as u32;
    info.pp_enabled_extension_names = names.as_ptr();
    // The feature structure is removed with the extension.
    let first = (&raw mut info).cast::<vk::BaseOutStructure<'_>>();
    let wanted = vk::StructureType::PHYSICAL_DEVICE_FRAGMENT_DENSITY_MAP_FEATURES_EXT;
    let mut at = first;
    // SAFETY: each structure of the chain is alive, and begins with its type and the next.
    let cut = unsafe {
        while !(*at).p_next.is_null() && (*(*at).p_next).s_type != wanted {
            at = (*at).p_next;
        }
        let cut = (*at).p_next;
        if !cut.is_null() {
            (*at).p_next = (*cut).p_next;
        }
        cut
    };
    // SAFETY: this is the type that goes with the name.
    let create: vk::PFN_vkCreateDevice = unsafe { next_function(c"vkCreateDevice") };
    // SAFETY: handed on, but for what was taken out.
    let result = unsafe { create(physical, &raw const info, allocator, device) };
    if !cut.is_null() {
        // SAFETY: as above; the chain is the shell's, and is whole again.
        unsafe { (*at).p_next = cut };
    }
    result
}

unsafe extern "system" fn enumerate_device_extensions(
    physical: vk::PhysicalDevice,
    layer_name: *const c_char,
    count: *mut u32,
    properties: *mut vk::ExtensionProperties,
) -> vk::Result {
    // SAFETY: this is the type that goes with the name.
    let all: vk::PFN_vkEnumerateDeviceExtensionProperties =
        unsafe { next_function(c"vkEnumerateDeviceExtensionProperties") };
    // SAFETY: there is room for a count, and for as many as it says where `properties` is somewhere.
    unsafe {
        let room = *count;
        let result = all(physical, layer_name, count, properties);
        if !layer_name.is_null() || result != vk::Result::SUCCESS {
            return result;
        }
        if !properties.is_null() {
            if room <= *count {
                return vk::Result::INCOMPLETE;
            }
            let mut more = vk::ExtensionProperties { spec_version: 2, ..Default::default() };
            let name = NAME.to_bytes_with_nul();
            more.extension_name[..name.len()]
                .copy_from_slice(core::mem::transmute::<&[u8], &[c_char]>(name));
            *properties.add(*count as usize) = more;
        }
        *count += 1;
    }
    vk::Result::SUCCESS
}

unsafe extern "system" fn get_features(
    physical: vk::PhysicalDevice,
    features: *mut vk::PhysicalDeviceFeatures2<'_>,
) {
    // SAFETY: this is the type that goes with the name.
    let all: vk::PFN_vkGetPhysicalDeviceFeatures2 =
        unsafe { next_function(c"vkGetPhysicalDeviceFeatures2") };
    // SAFETY: handed on as it came; a structure of this type is one.
    unsafe {
        all(physical, features);
        let ty = vk::StructureType::PHYSICAL_DEVICE_FRAGMENT_DENSITY_MAP_FEATURES_EXT;
        let found = find_structure(features.cast(), ty)
            .cast::<vk::PhysicalDeviceFragmentDensityMapFeaturesEXT<'_>>();
        if let Some(found) = found.as_mut() {
            found.fragment_density_map = vk::TRUE;
            found.fragment_density_map_non_subsampled_images = vk::TRUE;
        }
        let ty = vk::StructureType::PHYSICAL_DEVICE_MULTIVIEW_FEATURES;
        let found =
            find_structure(features.cast(), ty).cast::<vk::PhysicalDeviceMultiviewFeatures<'_>>();
        if let Some(found) = found.as_mut()
            && super::folder::layer_folder().join("one-view").exists()
        {
            found.multiview = vk::FALSE;
        }
    }
}

unsafe extern "system" fn get_properties(
    physical: vk::PhysicalDevice,
    properties: *mut vk::PhysicalDeviceProperties2<'_>,
) {
    // SAFETY: this is the type that goes with the name.
    let all: vk::PFN_vkGetPhysicalDeviceProperties2 =
        unsafe { next_function(c"vkGetPhysicalDeviceProperties2") };
    // SAFETY: handed on as it came; a structure of this type is one.
    unsafe {
        all(physical, properties);
        let ty = vk::StructureType::PHYSICAL_DEVICE_FRAGMENT_DENSITY_MAP_PROPERTIES_EXT;
        let found = find_structure(properties.cast(), ty)
            .cast::<vk::PhysicalDeviceFragmentDensityMapPropertiesEXT<'_>>();
        if let Some(found) = found.as_mut() {
            // The values of an Adreno.
            let texel = vk::Extent2D {
                width: super::density_maps::TEXEL,
                height: super::density_maps::TEXEL,
            };
            found.min_fragment_density_texel_size = texel;
            found.max_fragment_density_texel_size = texel;
            found.fragment_density_invocations = vk::TRUE;
        }
    }
}

/// Finds the first structure of a type in a `pNext` chain; null if there is none.
///
/// # Safety
/// Each structure of the chain is alive, and begins with its type and the next.
unsafe fn find_structure(
    chain: *mut vk::BaseOutStructure<'_>,
    ty: vk::StructureType,
) -> *mut vk::BaseOutStructure<'_> {
    let mut at = chain;
    // SAFETY: the caller's.
    while let Some(structure) = unsafe { at.as_ref() } {
        if structure.s_type == ty {
            break;
        }
        at = structure.p_next;
    }
    at
}
