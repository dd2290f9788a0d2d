//! A runtime's functions, asked for as Khronos' loader asks for them. Before there is an instance that is for
//! two of them only, as the loader answers for the layers itself; a forwarding runtime of a headset is reported
//! to break off at others.

use std::ffi::{CStr, c_char};
use std::sync::{Mutex, PoisonError, RwLock};

use openxr as xr;
use openxr::sys::pfn::{GetInstanceProcAddr, VoidFunction};
use openxr::sys::{Handle as _, Instance, Result as XrResult};

/// What a loader asks a runtime for without an instance.
const BEFORE_INSTANCE: [&CStr; 2] =
    [c"xrEnumerateInstanceExtensionProperties", c"xrCreateInstance"];

/// The process's runtime, which [`get_instance_proc_addr`] asks: a C function has no other place for it.
static RUNTIME: RwLock<Option<GetInstanceProcAddr>> = RwLock::new(None);

/// Held while an entry point is made, whose functions are to be of one runtime.
static MAKING: Mutex<()> = Mutex::new(());

/// Makes the entry point of a runtime. One serves a process: functions of an instance are always those of the
/// runtime that came last.
///
/// # Errors
/// The runtime lacks a function that each has.
///
/// # Safety
/// This is the `xrGetInstanceProcAddr` of a runtime that stays open.
pub(super) unsafe fn make_runtime_entry(
    runtime: GetInstanceProcAddr,
) -> Result<xr::Entry, XrResult> {
    let _making = MAKING.lock().unwrap_or_else(PoisonError::into_inner);
    *RUNTIME.write().unwrap_or_else(PoisonError::into_inner) = Some(runtime);
    // SAFETY: what it gives is the runtime's, as the caller says.
    unsafe { xr::Entry::from_get_instance_proc_addr(get_instance_proc_addr, &()) }
}

/// `xrGetInstanceProcAddr` as a loader has it.
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
