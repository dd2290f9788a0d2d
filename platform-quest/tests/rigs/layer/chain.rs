//! What comes next in the chain of API layers: the functions that hooked calls are forwarded to.

use std::ffi::CStr;
use std::sync::Mutex;

use openxr::sys;
use sys::{Result as Status, pfn};

/// How the next layer's or the runtime's functions are found.
#[derive(Clone, Copy)]
pub(crate) struct NextLayer {
    pub(crate) get_instance_proc_addr: pfn::GetInstanceProcAddr,
    pub(crate) instance: sys::Instance,
}

static NEXT: Mutex<Option<NextLayer>> = Mutex::new(None);

/// Remembers what comes next, for the instance that was made last.
pub(crate) fn set_next_layer(
    get_instance_proc_addr: pfn::GetInstanceProcAddr,
    instance: sys::Instance,
) {
    if let Ok(mut next) = NEXT.lock() {
        *next = Some(NextLayer { get_instance_proc_addr, instance });
    }
}

/// What comes next, once there is an instance.
pub(crate) fn next_layer() -> Option<NextLayer> {
    NEXT.lock().ok().and_then(|next| *next)
}

/// Finds the next function of a name.
///
/// # Safety
/// `F` is the type of the function of this name.
pub(crate) unsafe fn next_function<F: Copy>(name: &CStr) -> F {
    let next = next_layer().expect("there is an instance");
    let mut function = None;
    // SAFETY: the instance is alive, as one of its functions is being called.
    let found =
        unsafe { (next.get_instance_proc_addr)(next.instance, name.as_ptr(), &mut function) };
    assert_eq!(found, Status::SUCCESS, "{name:?}");
    let function = function.expect("it was found");
    // SAFETY: the caller's, and all functions are pointers of one size.
    unsafe { core::mem::transmute_copy::<pfn::VoidFunction, F>(&function) }
}

/// Forwards a call with its arguments as they came.
macro_rules! call_next {
    ($name:literal: $ty:ident, $($argument:expr),*) => {{
        // SAFETY: the type is the function's.
        let function: pfn::$ty = unsafe { $crate::chain::next_function($name) };
        // SAFETY: forwarded as it came.
        unsafe { function($($argument),*) }
    }};
}
pub(crate) use call_next;
