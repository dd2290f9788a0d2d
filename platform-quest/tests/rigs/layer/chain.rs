//! The next element in the chain of API layers, to whose functions hooked calls are forwarded.

use std::ffi::CStr;
use std::sync::Mutex;

use openxr::sys;
use sys::{Result as Status, pfn};

/// The access to the functions of the next layer or the runtime.
#[derive(Clone, Copy)]
pub(crate) struct NextLayer {
    pub(crate) get_instance_proc_addr: pfn::GetInstanceProcAddr,
    pub(crate) instance: sys::Instance,
}

static NEXT: Mutex<Option<NextLayer>> = Mutex::new(None);

/// Stores the next layer of the last created instance.
pub(crate) fn set_next_layer(
    get_instance_proc_addr: pfn::GetInstanceProcAddr,
    instance: sys::Instance,
) {
    if let Ok(mut next) = NEXT.lock() {
        *next = Some(NextLayer { get_instance_proc_addr, instance });
    }
}

/// Returns the next layer, once there is an instance.
pub(crate) fn next_layer() -> Option<NextLayer> {
    NEXT.lock().ok().and_then(|next| *next)
}

/// Returns the next layer's function of a name.
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

/// Forwards a call with unchanged arguments.
macro_rules! call_next {
    ($name:literal: $ty:ident, $($argument:expr),*) => {{
        // SAFETY: the type is the function's.
        let function: pfn::$ty = unsafe { $crate::chain::next_function($name) };
        // SAFETY: forwarded as it came.
        unsafe { function($($argument),*) }
    }};
}
pub(crate) use call_next;
