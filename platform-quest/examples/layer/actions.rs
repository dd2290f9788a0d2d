//! Logs the shell's actions and the bindings that it suggests for each interaction profile. Monado does
//! not know the Touch Plus: suggestions for it end here.

use std::collections::HashMap;
use std::ffi::{CStr, c_char};
use std::sync::{LazyLock, Mutex};

use openxr::sys;
use sys::{Handle, Result as Status, pfn};

use super::chain::call_next;
use super::folder::log_line;

const TOUCH_PLUS: &str = "/interaction_profiles/meta/touch_controller_plus";

/// Names of the actions that were made.
static NAMES: LazyLock<Mutex<HashMap<u64, String>>> = LazyLock::new(Mutex::default);

/// Logs `action NAME TYPE`.
pub(crate) unsafe extern "system" fn create_action(
    set: sys::ActionSet,
    info: *const sys::ActionCreateInfo,
    action: *mut sys::Action,
) -> Status {
    let made = call_next!(c"xrCreateAction": CreateAction, set, info, action);
    if made == Status::SUCCESS {
        // SAFETY: the shell's structure is valid during the call, its name ends in 0, and the call
        // has succeeded.
        let (info, handle) = unsafe { (&*info, (*action).into_raw()) };
        // SAFETY: as above.
        let name = unsafe { CStr::from_ptr(info.action_name.as_ptr()) }.to_string_lossy();
        log_line(&format!("action {name} {:?}", info.action_type));
        NAMES.lock().expect("no holder panics").insert(handle, name.into_owned());
    }
    made
}

/// Logs `bind PROFILE PATH NAME` for each binding.
pub(crate) unsafe extern "system" fn suggest_bindings(
    instance: sys::Instance,
    info: *const sys::InteractionProfileSuggestedBinding,
) -> Status {
    // SAFETY: the shell's structure is valid during the call, with as many bindings as it says.
    let (profile, bindings) = unsafe {
        let (first, count) = ((*info).suggested_bindings, (*info).count_suggested_bindings);
        (
            path_text(instance, (*info).interaction_profile),
            core::slice::from_raw_parts(first, count as usize),
        )
    };
    let names = NAMES.lock().expect("no holder panics");
    for binding in bindings {
        let name = names.get(&binding.action.into_raw()).map_or("?", String::as_str);
        log_line(&format!("bind {profile} {} {name}", path_text(instance, binding.binding)));
    }
    if profile == TOUCH_PLUS {
        return Status::SUCCESS;
    }
    call_next!(
        c"xrSuggestInteractionProfileBindings": SuggestInteractionProfileBindings, instance, info
    )
}

/// A path's text.
fn path_text(instance: sys::Instance, path: sys::Path) -> String {
    let mut text: [c_char; sys::MAX_PATH_LENGTH] = [0; _];
    let (capacity, mut count) = (text.len() as u32, 0);
    let (to, count) = (text.as_mut_ptr(), &raw mut count);
    let told = call_next!(c"xrPathToString": PathToString, instance, path, capacity, count, to);
    assert_eq!(told, Status::SUCCESS, "a path without a text");
    // SAFETY: the call has succeeded, and such a text ends in 0.
    unsafe { CStr::from_ptr(text.as_ptr()) }.to_string_lossy().into_owned()
}
