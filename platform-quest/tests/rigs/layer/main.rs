//! An OpenXR API layer for tests, between the shell and the runtime. It advertises features that Monado lacks
//! (performance levels, user presence, display refresh rates, foveation, thread types, the Touch Plus
//! profile), logs the shell's requests, checks the order of its calls and their arguments, and injects events
//! for a test. The library is also a Vulkan layer: see `vulkan`.
//!
//! `main` receives the loader's calls, `refusals` and `checks` contain the hooked functions, and `chain`,
//! `folder` and `events`, below all of them, the common state.
//!
//! The layer works in the folder that `PAROS_LAYER` names. It appends to `log` there, and performs the
//! request in the file `inject` once: `presence 0`, `presence 1`, `heat`, `cool`, `lose session`, `lose
//! instance`, or `fail`, which makes the next frame wait fail. These files have an effect while they exist:
//! `no-depth` hides depth formats, `one-view` hides the device's multiview, `no-floor`, `no-stage` and
//! `no-rates` hide spaces and rates, `no-subsampling` refuses subsampled images, and with `fast-display` each
//! picture is due after 0.1 ms. Functions named in `refuse` are refused. `hands` sets the state of bare
//! hands, `slow-pipelines` and `no-pipelines` the driver's compilation, and `recommended` the recommended
//! resolution.

mod actions;
mod chain;
mod checks;
mod density_maps;
mod events;
mod folder;
mod formats;
mod foveation;
mod hands;
mod notices;
mod pipelines;
mod refusals;
mod resolution;
mod spaces;
mod threads;
mod vulkan;

use std::ffi::{CStr, c_char};

use openxr::sys;
use sys::{Result as Status, pfn};

use folder::log_line;

/// The extensions that the layer implements itself, as listed in its manifest.
const OWN_EXTENSIONS: [&CStr; 11] = [
    c"XR_EXT_hand_interaction",
    c"XR_EXT_performance_settings",
    c"XR_EXT_user_presence",
    c"XR_FB_foveation",
    c"XR_FB_foveation_configuration",
    c"XR_FB_foveation_vulkan",
    c"XR_FB_swapchain_update_state",
    c"XR_KHR_android_thread_settings",
    c"XR_META_recommended_layer_resolution",
    c"XR_META_touch_controller_plus",
    c"XR_META_vulkan_swapchain_create_info",
];

/// Negotiates with the loader, before the first call.
///
/// # Safety
/// `request` is valid during the call.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn xrNegotiateLoaderApiLayerInterface(
    _: *const sys::NegotiateLoaderInfo,
    _: *const c_char,
    request: *mut sys::NegotiateApiLayerRequest,
) -> Status {
    // SAFETY: the loader's request is valid during the call.
    let request = unsafe { &mut *request };
    request.layer_interface_version = 1;
    request.layer_api_version = sys::CURRENT_API_VERSION;
    request.get_instance_proc_addr = Some(get_instance_proc_addr);
    request.create_api_layer_instance = Some(create_instance);
    Status::SUCCESS
}

unsafe extern "system" fn create_instance(
    info: *const sys::InstanceCreateInfo,
    layer: *const sys::ApiLayerCreateInfo,
    instance: *mut sys::Instance,
) -> Status {
    // SAFETY: the loader's structures are valid during the call, and name what comes next.
    let (mut info, layer, after) = unsafe { (*info, *layer, *(*layer).next_info) };
    let (Some(get), Some(create)) =
        (after.next_get_instance_proc_addr, after.next_create_api_layer_instance)
    else {
        return Status::ERROR_INITIALIZATION_FAILED;
    };
    let count = info.enabled_extension_count as usize;
    // SAFETY: as many names as the shell says.
    let names = unsafe { core::slice::from_raw_parts(info.enabled_extension_names, count) };
    // SAFETY: they are C strings.
    let mine = |name: &*const c_char| OWN_EXTENSIONS.contains(&unsafe { CStr::from_ptr(*name) });
    let theirs: Vec<*const c_char> = names.iter().copied().filter(|name| !mine(name)).collect();
    log_line(&format!("own extensions {}", names.len() - theirs.len()));
    info.enabled_extension_count = theirs.len() as u32;
    info.enabled_extension_names = theirs.as_ptr();
    let layer = sys::ApiLayerCreateInfo { next_info: after.next, ..layer };
    // SAFETY: all that is handed on lives until the call returns.
    let made = unsafe { create(&info, &layer, instance) };
    if made == Status::SUCCESS {
        // SAFETY: the call has succeeded.
        chain::set_next_layer(get, unsafe { *instance });
    }
    made
}

unsafe extern "system" fn get_instance_proc_addr(
    instance: sys::Instance,
    name: *const c_char,
    function: *mut Option<pfn::VoidFunction>,
) -> Status {
    // SAFETY: the shell's name is a C string.
    let name = unsafe { CStr::from_ptr(name) };
    let find_hook = |name| refusals::find_hook(name).or_else(|| checks::find_hook(name));
    if let Some(hook) = name.to_str().ok().and_then(find_hook) {
        // SAFETY: there is room for a function.
        unsafe { *function = Some(hook) };
        return Status::SUCCESS;
    }
    let Some(next) = chain::next_layer() else {
        return Status::ERROR_FUNCTION_UNSUPPORTED;
    };
    // SAFETY: handed on as it came.
    unsafe { (next.get_instance_proc_addr)(instance, name.as_ptr(), function) }
}
