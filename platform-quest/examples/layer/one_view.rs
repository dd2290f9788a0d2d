//! A Vulkan layer in the same library: its devices have no multiview.

use std::ffi::{CStr, c_char, c_void};
use std::sync::Mutex;

use ash::vk;

/// What comes after the layer: the way to functions, and the one that the layer changes.
static NEXT: Mutex<Option<(vk::PFN_vkGetInstanceProcAddr, vk::PFN_vkGetPhysicalDeviceFeatures2)>> =
    Mutex::new(None);

/// `VkNegotiateLayerInterface` of Vulkan's `vk_layer.h`, of interface 2.
#[repr(C)]
pub(crate) struct Negotiation {
    kind: i32,
    next: *mut c_void,
    version: u32,
    instance: Option<vk::PFN_vkGetInstanceProcAddr>,
    device: Option<vk::PFN_vkGetDeviceProcAddr>,
    physical: Option<vk::PFN_vkGetInstanceProcAddr>,
}

/// `VkLayerInstanceCreateInfo`, in the chain of `VkInstanceCreateInfo`.
#[repr(C)]
struct Chain {
    ty: vk::StructureType,
    next: *const Chain,
    /// 0 where `link` is one.
    function: i32,
    link: *mut Link,
}

/// `VkLayerInstanceLink`.
#[repr(C)]
struct Link {
    next: *mut Link,
    get_instance_proc_addr: vk::PFN_vkGetInstanceProcAddr,
}

/// The Vulkan loader's first question.
///
/// # Safety
/// The loader's.
#[unsafe(no_mangle)]
unsafe extern "system" fn vkNegotiateLoaderLayerInterfaceVersion(
    negotiation: *mut Negotiation,
) -> vk::Result {
    // SAFETY: the loader's structure is valid during the call.
    let negotiation = unsafe { &mut *negotiation };
    negotiation.version = 2;
    negotiation.instance = Some(get_instance_proc_addr);
    negotiation.device = None;
    negotiation.physical = None;
    vk::Result::SUCCESS
}

unsafe extern "system" fn create_instance(
    info: *const vk::InstanceCreateInfo<'_>,
    allocator: *const vk::AllocationCallbacks<'_>,
    instance: *mut vk::Instance,
) -> vk::Result {
    // SAFETY: the loader's chain is valid during the call, and names what comes next; each layer
    // moves it on.
    let get = unsafe {
        let mut chain = (*info).p_next.cast::<Chain>();
        while (*chain).ty != vk::StructureType::LOADER_INSTANCE_CREATE_INFO
            || (*chain).function != 0
        {
            chain = (*chain).next;
        }
        let link = (*chain).link;
        (*chain.cast_mut()).link = (*link).next;
        (*link).get_instance_proc_addr
    };
    // SAFETY: the type is the function's.
    let create: vk::PFN_vkCreateInstance =
        unsafe { core::mem::transmute(get(vk::Instance::null(), c"vkCreateInstance".as_ptr())) };
    // SAFETY: handed on as it came.
    let made = unsafe { create(info, allocator, instance) };
    if made == vk::Result::SUCCESS {
        // SAFETY: the call has succeeded, and the names are C strings. Later the loader would lead
        // back here.
        let next = FEATURES.iter().find_map(|name| unsafe { get(*instance, name.as_ptr()) });
        let next = next.expect("it is Vulkan 1.1");
        // SAFETY: the type is the function's.
        let next: vk::PFN_vkGetPhysicalDeviceFeatures2 = unsafe { core::mem::transmute(next) };
        *NEXT.lock().expect("nothing panics") = Some((get, next));
    }
    made
}

unsafe extern "system" fn get_instance_proc_addr(
    instance: vk::Instance,
    name: *const c_char,
) -> vk::PFN_vkVoidFunction {
    // SAFETY: the caller's name is a C string.
    let name = unsafe { CStr::from_ptr(name) };
    let own: *const c_void = match name.to_bytes() {
        b"vkGetInstanceProcAddr" => get_instance_proc_addr as *const c_void,
        b"vkCreateInstance" => create_instance as *const c_void,
        name if FEATURES.iter().any(|own| own.to_bytes() == name) => features as *const c_void,
        _ => {
            let (get, _) = (*NEXT.lock().expect("nothing panics"))?;
            // SAFETY: handed on as it came.
            return unsafe { get(instance, name.as_ptr()) };
        }
    };
    // SAFETY: functions are pointers of one size, and this is none that is null.
    unsafe { core::mem::transmute::<*const c_void, vk::PFN_vkVoidFunction>(own) }
}

/// One function: an instance with the extension is asked by its name.
const FEATURES: [&CStr; 2] = [c"vkGetPhysicalDeviceFeatures2", c"vkGetPhysicalDeviceFeatures2KHR"];

unsafe extern "system" fn features(
    physical: vk::PhysicalDevice,
    features: *mut vk::PhysicalDeviceFeatures2<'_>,
) {
    let (_, next) = NEXT.lock().expect("nothing panics").expect("there is an instance");
    // SAFETY: handed on as it came; the chain's structures say of which type they are.
    unsafe {
        next(physical, features);
        let mut chain = (*features).p_next.cast::<vk::BaseOutStructure<'_>>();
        while let Some(structure) = chain.as_mut() {
            if structure.s_type == vk::StructureType::PHYSICAL_DEVICE_MULTIVIEW_FEATURES {
                let features = chain.cast::<vk::PhysicalDeviceMultiviewFeatures<'_>>();
                (*features).multiview = vk::FALSE;
            }
            chain = structure.p_next;
        }
    }
}
