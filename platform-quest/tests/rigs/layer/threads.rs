//! Thread types (`XR_KHR_android_thread_settings`); the `openxr` crate only defines the call's type on
//! Android.

use openxr::sys;
use sys::{Result as Status, pfn};

use super::folder::log_line;

type SetThreadTypeFn =
    unsafe extern "system" fn(sys::Session, sys::AndroidThreadTypeKHR, u32) -> Status;

/// Returns the hook for a function's name, if there is one.
pub(crate) fn find_hook(name: &str) -> Option<pfn::VoidFunction> {
    let function: SetThreadTypeFn = set_thread_type;
    // SAFETY: the shell calls it by this type, and all functions are pointers of one size.
    let function = unsafe { core::mem::transmute::<SetThreadTypeFn, pfn::VoidFunction>(function) };
    (name == "xrSetAndroidApplicationThreadKHR").then_some(function)
}

/// Logs the type that a thread is given, and whether it is the calling thread.
unsafe extern "system" fn set_thread_type(
    _: sys::Session,
    thread_type: sys::AndroidThreadTypeKHR,
    thread_id: u32,
) -> Status {
    let here = std::fs::read_link("/proc/thread-self").unwrap_or_default();
    let own = here.ends_with(thread_id.to_string());
    log_line(&format!("thread {thread_type:?} {}", if own { "its own" } else { "another" }));
    Status::SUCCESS
}
