//! Logs the shell's actions and the bindings that it suggests for each interaction profile. Suggestions for
//! the Touch Plus, which Monado doesn't know, and for hands, which `hands` imitates, aren't forwarded.
//! Profiles whose paths are in the file `refuse-profiles` are refused.

use std::ffi::{CStr, c_char};
use std::fs;
use std::sync::Mutex;

use openxr::sys;
use sys::{Handle, Result as Status, pfn};

use super::chain::call_next;
use super::folder::{layer_folder, log_line};

pub(crate) const HAND_INTERACTION: &str = "/interaction_profiles/ext/hand_interaction_ext";
const TOUCH_PLUS: &str = "/interaction_profiles/meta/touch_controller_plus";

/// The created actions, with their names.
static ACTIONS: Mutex<Vec<(u64, String)>> = Mutex::new(Vec::new());

/// The profiles for which bindings were last accepted.
static ACCEPTED: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// Returns the name of an action.
pub(crate) fn name_action(action: sys::Action) -> String {
    let actions = ACTIONS.lock().expect("no holder panics");
    let named = actions.iter().rfind(|(handle, _)| *handle == action.into_raw());
    named.map_or("?", |(_, name)| name).to_owned()
}

/// Returns the last created action of a name.
pub(crate) fn find_action(name: &str) -> sys::Action {
    let actions = ACTIONS.lock().expect("no holder panics");
    let found = actions.iter().rfind(|(_, named)| named == name);
    found.map_or(sys::Action::NULL, |(handle, _)| sys::Action::from_raw(*handle))
}

/// Returns `true` if bindings were accepted for a profile.
pub(crate) fn is_accepted(profile: &str) -> bool {
    ACCEPTED.lock().expect("no holder panics").iter().any(|accepted| accepted == profile)
}

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
        ACTIONS.lock().expect("no holder panics").push((handle, name.into_owned()));
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
    for binding in bindings {
        let name = name_action(binding.action);
        log_line(&format!("bind {profile} {} {name}", path_text(instance, binding.binding)));
    }
    let refused = fs::read_to_string(layer_folder().join("refuse-profiles")).unwrap_or_default();
    let done = if refused.split_whitespace().any(|refused| refused == profile) {
        Status::ERROR_PATH_UNSUPPORTED
    } else if profile == TOUCH_PLUS || profile == HAND_INTERACTION {
        Status::SUCCESS
    } else {
        call_next!(
            c"xrSuggestInteractionProfileBindings": SuggestInteractionProfileBindings, instance, info
        )
    };
    let mut accepted = ACCEPTED.lock().expect("no holder panics");
    accepted.retain(|accepted| *accepted != profile);
    if done == Status::SUCCESS {
        accepted.push(profile);
    }
    done
}

/// Returns a path as text.
pub(crate) fn path_text(instance: sys::Instance, path: sys::Path) -> String {
    let mut text: [c_char; sys::MAX_PATH_LENGTH] = [0; _];
    let (capacity, mut count) = (text.len() as u32, 0);
    let (to, count) = (text.as_mut_ptr(), &raw mut count);
    let told = call_next!(c"xrPathToString": PathToString, instance, path, capacity, count, to);
    assert_eq!(told, Status::SUCCESS, "a path without a text");
    // SAFETY: the call has succeeded, and such a text ends in 0.
    unsafe { CStr::from_ptr(text.as_ptr()) }.to_string_lossy().into_owned()
}
