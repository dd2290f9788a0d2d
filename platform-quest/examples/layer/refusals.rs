//! What a runtime may refuse, it refuses: the functions that a file `refuse` in the layer's folder
//! names, at every call for as long as it does.

use std::ffi::CString;
use std::fs;

use openxr::sys;
use sys::{Result as Status, pfn};

use super::{checks, folder, next, note};

/// Functions with what they answer where they refuse.
macro_rules! refusals {
    ($($name:literal: $ty:ident = $function:ident($($argument:ident: $type:ty),*), $status:ident;)*) => {
        /// The layer's function of a name.
        pub(crate) fn own(name: &str) -> Option<pfn::VoidFunction> {
            match name {
                $($name => {
                    let function: pfn::$ty = $function;
                    // SAFETY: the shell calls it by the type that goes with the name.
                    Some(unsafe { core::mem::transmute::<pfn::$ty, pfn::VoidFunction>(function) })
                })*
                _ => None,
            }
        }

        $(unsafe extern "system" fn $function($($argument: $type),*) -> Status {
            if is_refused($name) {
                return Status::$status;
            }
            // SAFETY: the type is the function's.
            let function: pfn::$ty = unsafe { behind($name) };
            // SAFETY: handed on as it came.
            unsafe { function($($argument),*) }
        })*
    };
}

refusals! {
    "xrCreateSession": CreateSession = create_session(
        instance: sys::Instance,
        info: *const sys::SessionCreateInfo,
        session: *mut sys::Session
    ), ERROR_LIMIT_REACHED;
    "xrCreateSwapchain": CreateSwapchain = create_swapchain(
        session: sys::Session,
        info: *const sys::SwapchainCreateInfo,
        swapchain: *mut sys::Swapchain
    ), ERROR_FEATURE_UNSUPPORTED;
    "xrEndFrame": EndFrame = end_frame(
        session: sys::Session,
        info: *const sys::FrameEndInfo
    ), ERROR_LAYER_INVALID;
    "xrSuggestInteractionProfileBindings": SuggestInteractionProfileBindings = suggest(
        instance: sys::Instance,
        info: *const sys::InteractionProfileSuggestedBinding
    ), ERROR_PATH_UNSUPPORTED;
    "xrRequestDisplayRefreshRateFB": RequestDisplayRefreshRateFB = request_rate(
        session: sys::Session,
        rate: f32
    ), ERROR_DISPLAY_REFRESH_RATE_UNSUPPORTED_FB;
    "xrCreateHandTrackerEXT": CreateHandTrackerEXT = create_hand_tracker(
        session: sys::Session,
        info: *const sys::HandTrackerCreateInfoEXT,
        tracker: *mut sys::HandTrackerEXT
    ), ERROR_FEATURE_UNSUPPORTED;
}

fn is_refused(name: &str) -> bool {
    let refused = fs::read_to_string(folder().join("refuse")).unwrap_or_default();
    let refused = refused.split_whitespace().any(|refused| refused == name);
    if refused {
        note(&format!("refused {name}"));
    }
    refused
}

/// The function that comes next, be it the layer's own.
///
/// # Safety
/// `F` is the type of the function of this name.
unsafe fn behind<F: Copy>(name: &str) -> F {
    match checks::own(name) {
        // SAFETY: the caller's, and all functions are pointers of one size.
        Some(own) => unsafe { core::mem::transmute_copy::<pfn::VoidFunction, F>(&own) },
        None => {
            let name = CString::new(name).expect("a name");
            // SAFETY: the caller's.
            unsafe { next(&name) }
        }
    }
}
