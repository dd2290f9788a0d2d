//! Refusals: functions whose names are in the file `refuse` in the layer's folder fail with an error that a
//! runtime may return.

use std::ffi::CString;
use std::fs;

use openxr::sys;
use sys::{Result as Status, pfn};

use super::chain::next_function;
use super::checks;
use super::folder::{layer_folder, log_line};

/// The functions, each with the result of its refusal.
macro_rules! refusals {
    ($($name:literal: $ty:ident = $function:ident($($argument:ident: $type:ty),*), $status:ident;)*) => {
        /// Returns the hook for a function's name, if there is one.
        pub(crate) fn find_hook(name: &str) -> Option<pfn::VoidFunction> {
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
            let function: pfn::$ty = unsafe { hook_or_next_function($name) };
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
    "xrSuggestInteractionProfileBindings": SuggestInteractionProfileBindings = suggest_bindings(
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
    let refused = fs::read_to_string(layer_folder().join("refuse")).unwrap_or_default();
    let refused = refused.split_whitespace().any(|refused| refused == name);
    if refused {
        log_line(&format!("refused {name}"));
    }
    refused
}

/// Returns the function that is called if it isn't refused: the layer's own hook, or the runtime's.
///
/// # Safety
/// `F` is the type of the function of this name.
unsafe fn hook_or_next_function<F: Copy>(name: &str) -> F {
    match checks::find_hook(name) {
        // SAFETY: the caller's, and all functions are pointers of one size.
        Some(hook) => unsafe { core::mem::transmute_copy::<pfn::VoidFunction, F>(&hook) },
        None => {
            let name = CString::new(name).expect("a name");
            // SAFETY: the caller's.
            unsafe { next_function(&name) }
        }
    }
}
