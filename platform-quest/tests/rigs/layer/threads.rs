//! Thread types (`XR_KHR_android_thread_settings`); the crate has the call's type on Android alone.

use openxr::sys;
use sys::{Result as Status, pfn};

use super::folder::log_line;

type SetThreadTypeFn =
    unsafe extern "system" fn(sys::Session, sys::AndroidThreadTypeKHR, u32) -> Status;

/// Finds the hook of a name.
pub(crate) fn find_hook(name: &str) -> Option<pfn::VoidFunction> {
    let function: SetThreadTypeFn = set_thread_type;
    // SAFETY: the shell calls it by this type, and all functions are pointers of one size.
    let function = unsafe { core::mem::transmute::<SetThreadTypeFn, pfn::VoidFunction>(function) };
    (name == "xrSetAndroidApplicationThreadKHR").then_some(function)
}

/// Logs which thread is given a type, and whether it is the one that calls.
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
