//! An OpenXR API layer for tests, between the shell and the runtime. It advertises what Monado lacks
//! (performance levels, user presence, refresh rates, foveation, thread types, the Touch Plus), notes
//! what the shell asks for, checks the order of its calls and what it hands over, and has the runtime tell what a
//! test wants told. The library is a layer of Vulkan, too: see `vulkan`.
//!
//! It works in the folder that `PAROS_LAYER` names: it appends to `log` there, and does what a file
//! `inject` says, once: `presence 0`, `presence 1`, `heat`, `cool`, `lose session`, `lose instance`,
//! or `fail`, which has the next frame's wait fail. Where a file `no-depth` stands, the runtime takes
//! no pictures of depth; where `one-view` stands, its device has no multiview; `no-floor`, `no-stage`
//! and `no-rates` take away spaces and rates. What a file `refuse` names is refused.

mod actions;
mod checks;
mod formats;
mod foveation;
mod maps;
mod refusals;
mod spaces;
mod threads;
mod vulkan;

use std::ffi::{CStr, c_char};
use std::fs;
use std::io::Write;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use openxr::sys;
use sys::{Handle, Result as Status, pfn};

/// What comes after the layer.
static NEXT: Mutex<Option<(pfn::GetInstanceProcAddr, sys::Instance)>> = Mutex::new(None);
/// The session that was made last.
pub(crate) static SESSION: AtomicU64 = AtomicU64::new(0);
/// The next wait for a frame fails.
pub(crate) static FAIL: AtomicBool = AtomicBool::new(false);

/// What the layer does itself, as it says in its manifest.
const OWN: [&CStr; 8] = [
    c"XR_EXT_performance_settings",
    c"XR_EXT_user_presence",
    c"XR_FB_foveation",
    c"XR_FB_foveation_configuration",
    c"XR_FB_foveation_vulkan",
    c"XR_FB_swapchain_update_state",
    c"XR_KHR_android_thread_settings",
    c"XR_META_touch_controller_plus",
];

/// The loader's first question.
///
/// # Safety
/// The loader's.
#[unsafe(no_mangle)]
pub unsafe extern "system" fn xrNegotiateLoaderApiLayerInterface(
    _: *const sys::NegotiateLoaderInfo,
    _: *const c_char,
    request: *mut sys::NegotiateApiLayerRequest,
) -> Status {
    // SAFETY: the loader's request is valid during the call.
    let request = unsafe { &mut *request };
    request.layer_interface_version = 1;
    request.layer_api_version = sys::CURRENT_API_VERSION;
    request.get_instance_proc_addr = Some(get_instance_proc_addr);
    request.create_api_layer_instance = Some(create_instance);
    Status::SUCCESS
}

/// Appends a line to the log.
pub(crate) fn note(text: &str) {
    let path = folder().join("log");
    if let Ok(mut log) = fs::OpenOptions::new().append(true).create(true).open(path) {
        // The test misses the line.
        let _ = writeln!(log, "{text}");
    }
}

/// A function of the runtime's.
///
/// # Safety
/// `F` is the type of the function of this name.
pub(crate) unsafe fn next<F: Copy>(name: &CStr) -> F {
    let next = NEXT.lock().ok().and_then(|next| *next).expect("there is an instance");
    let mut function = None;
    // SAFETY: the instance is alive, as one of its functions is being called.
    let found = unsafe { (next.0)(next.1, name.as_ptr(), &mut function) };
    assert_eq!(found, Status::SUCCESS, "{name:?}");
    let function = function.expect("it was found");
    // SAFETY: the caller's, and all functions are pointers of one size.
    unsafe { core::mem::transmute_copy::<pfn::VoidFunction, F>(&function) }
}

pub(crate) fn folder() -> PathBuf {
    std::env::var_os("PAROS_LAYER").unwrap_or_default().into()
}

unsafe extern "system" fn create_instance(
    info: *const sys::InstanceCreateInfo,
    layer: *const sys::ApiLayerCreateInfo,
    instance: *mut sys::Instance,
) -> Status {
    // SAFETY: the loader's structures are valid during the call, and name what comes next.
    let (mut info, layer, after) = unsafe { (*info, *layer, *(*layer).next_info) };
    let (Some(get), Some(create)) =
        (after.next_get_instance_proc_addr, after.next_create_api_layer_instance)
    else {
        return Status::ERROR_INITIALIZATION_FAILED;
    };
    let count = info.enabled_extension_count as usize;
    // SAFETY: as many names as the shell says.
    let names = unsafe { core::slice::from_raw_parts(info.enabled_extension_names, count) };
    // SAFETY: they are C strings.
    let mine = |name: &*const c_char| OWN.contains(&unsafe { CStr::from_ptr(*name) });
    let theirs: Vec<*const c_char> = names.iter().copied().filter(|name| !mine(name)).collect();
    note(&format!("own extensions {}", names.len() - theirs.len()));
    info.enabled_extension_count = theirs.len() as u32;
    info.enabled_extension_names = theirs.as_ptr();
    let layer = sys::ApiLayerCreateInfo { next_info: after.next, ..layer };
    // SAFETY: all that is handed on lives until the call returns.
    let made = unsafe { create(&info, &layer, instance) };
    if made == Status::SUCCESS
        && let Ok(mut next) = NEXT.lock()
    {
        // SAFETY: the call has succeeded.
        *next = Some((get, unsafe { *instance }));
    }
    made
}

unsafe extern "system" fn get_instance_proc_addr(
    instance: sys::Instance,
    name: *const c_char,
    function: *mut Option<pfn::VoidFunction>,
) -> Status {
    // SAFETY: the shell's name is a C string.
    let name = unsafe { CStr::from_ptr(name) };
    let own = |name| refusals::own(name).or_else(|| checks::own(name));
    if let Some(own) = name.to_str().ok().and_then(own) {
        // SAFETY: there is room for a function.
        unsafe { *function = Some(own) };
        return Status::SUCCESS;
    }
    let Some((get, _)) = NEXT.lock().ok().and_then(|next| *next) else {
        return Status::ERROR_FUNCTION_UNSUPPORTED;
    };
    // SAFETY: handed on as it came.
    unsafe { get(instance, name.as_ptr(), function) }
}

/// What a test wants told: an event written where the shell wants it. Whether there is one.
///
/// # Safety
/// There is room for an event.
pub(crate) unsafe fn inject(event: *mut sys::EventDataBuffer) -> bool {
    let path = folder().join("inject");
    let Ok(wish) = fs::read_to_string(&path) else { return false };
    // It is done once, as far as we can help.
    let _ = fs::remove_file(path);
    note(&format!("injected {}", wish.trim()));
    let session = sys::Session::from_raw(SESSION.load(Ordering::SeqCst));
    let next = core::ptr::null();
    match wish.trim() {
        "presence 0" | "presence 1" => {
            let is_user_present = sys::Bool32::from(wish.trim().ends_with('1'));
            let ty = sys::EventDataUserPresenceChangedEXT::TYPE;
            let told = sys::EventDataUserPresenceChangedEXT { ty, next, session, is_user_present };
            // SAFETY: an event fits into the buffer.
            unsafe { event.cast::<sys::EventDataUserPresenceChangedEXT>().write(told) };
        }
        "heat" | "cool" => {
            let (cool, hot) = (
                sys::PerfSettingsNotificationLevelEXT::NORMAL,
                sys::PerfSettingsNotificationLevelEXT::IMPAIRED,
            );
            let (from_level, to_level) =
                if wish.trim() == "heat" { (cool, hot) } else { (hot, cool) };
            let told = sys::EventDataPerfSettingsEXT {
                ty: sys::EventDataPerfSettingsEXT::TYPE,
                next,
                domain: sys::PerfSettingsDomainEXT::GPU,
                sub_domain: sys::PerfSettingsSubDomainEXT::THERMAL,
                from_level,
                to_level,
            };
            // SAFETY: as above.
            unsafe { event.cast::<sys::EventDataPerfSettingsEXT>().write(told) };
        }
        "lose session" => {
            let told = sys::EventDataSessionStateChanged {
                ty: sys::EventDataSessionStateChanged::TYPE,
                next,
                session,
                state: sys::SessionState::LOSS_PENDING,
                time: sys::Time::from_nanos(1),
            };
            // SAFETY: as above.
            unsafe { event.cast::<sys::EventDataSessionStateChanged>().write(told) };
        }
        "lose instance" => {
            let ty = sys::EventDataInstanceLossPending::TYPE;
            let loss_time = sys::Time::from_nanos(1);
            let told = sys::EventDataInstanceLossPending { ty, next, loss_time };
            // SAFETY: as above.
            unsafe { event.cast::<sys::EventDataInstanceLossPending>().write(told) };
        }
        _ => {
            FAIL.store(true, Ordering::SeqCst);
            return false;
        }
    }
    true
}
