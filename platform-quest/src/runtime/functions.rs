//! The functions of a runtime, looked up as Khronos' loader does. Without an instance only two functions are
//! requested, as the loader answers layer queries itself; a forwarding runtime of a headset is reported to
//! abort on other requests.

use std::ffi::{CStr, c_char};
use std::sync::{Mutex, PoisonError, RwLock};

use openxr as xr;
use openxr::sys::pfn::{GetInstanceProcAddr, VoidFunction};
use openxr::sys::{Handle as _, Instance, Result as XrResult};

/// The functions that a loader requests from a runtime without an instance.
const BEFORE_INSTANCE: [&CStr; 2] =
    [c"xrEnumerateInstanceExtensionProperties", c"xrCreateInstance"];

/// The process's runtime, which [`get_instance_proc_addr`] forwards to: a C function can't carry state.
static RUNTIME: RwLock<Option<GetInstanceProcAddr>> = RwLock::new(None);

/// Locked while an entry point is made, as all its functions must come from one runtime.
static MAKING: Mutex<()> = Mutex::new(());

/// Makes the entry point of a runtime. A process can use one runtime: functions of an instance always come
/// from the last one.
///
/// # Errors
/// The runtime lacks a function that every runtime must have.
///
/// # Safety
/// `runtime` is the `xrGetInstanceProcAddr` of a runtime that stays open.
pub(super) unsafe fn make_runtime_entry(
    runtime: GetInstanceProcAddr,
) -> Result<xr::Entry, XrResult> {
    let _making = MAKING.lock().unwrap_or_else(PoisonError::into_inner);
    *RUNTIME.write().unwrap_or_else(PoisonError::into_inner) = Some(runtime);
    // SAFETY: what it gives is the runtime's, as the caller says.
    unsafe { xr::Entry::from_get_instance_proc_addr(get_instance_proc_addr, &()) }
}

/// Implements `xrGetInstanceProcAddr` as a loader does.
unsafe extern "system" fn get_instance_proc_addr(
    instance: Instance,
    name: *const c_char,
    function: *mut Option<VoidFunction>,
) -> XrResult {
    // SAFETY: whoever calls `xrGetInstanceProcAddr` hands over a C string.
    let asked_for = unsafe { CStr::from_ptr(name) };
    if instance == Instance::NULL && !BEFORE_INSTANCE.contains(&asked_for) {
        return XrResult::ERROR_FUNCTION_UNSUPPORTED;
    }
    match *RUNTIME.read().unwrap_or_else(PoisonError::into_inner) {
        // SAFETY: it is a runtime's, and takes what this takes.
        Some(runtime) => unsafe { runtime(instance, name, function) },
        None => XrResult::ERROR_RUNTIME_UNAVAILABLE,
    }
}
