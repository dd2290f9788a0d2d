//! What threads are for, which only Android is told; the crate has the call's type there alone.

use openxr::sys;
use sys::{Result as Status, pfn};

use super::note;

type Name = unsafe extern "system" fn(sys::Session, sys::AndroidThreadTypeKHR, u32) -> Status;

/// The layer's function of a name.
pub(crate) fn own(name: &str) -> Option<pfn::VoidFunction> {
    let function: Name = name_thread;
    // SAFETY: the shell calls it by this type, and all functions are pointers of one size.
    let function = unsafe { core::mem::transmute::<Name, pfn::VoidFunction>(function) };
    (name == "xrSetAndroidApplicationThreadKHR").then_some(function)
}

/// Notes which thread is named, and whether it is the one that calls.
unsafe extern "system" fn name_thread(
    _: sys::Session,
    kind: sys::AndroidThreadTypeKHR,
    thread: u32,
) -> Status {
    let here = std::fs::read_link("/proc/thread-self").unwrap_or_default();
    let own = here.ends_with(thread.to_string());
    note(&format!("thread {kind:?} {}", if own { "its own" } else { "another" }));
    Status::SUCCESS
}
