//! Events that a test injects, and the frame wait that it has fail.

use std::fs;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use openxr::sys;
use sys::Handle;

use super::folder::{layer_folder, log_line};

/// The session that was made last.
static SESSION: AtomicU64 = AtomicU64::new(0);
/// Whether the next frame wait fails.
static FAIL_NEXT_WAIT: AtomicBool = AtomicBool::new(false);

/// Remembers the session that injected events are about.
pub(crate) fn set_session(session: sys::Session) {
    SESSION.store(session.into_raw(), Ordering::SeqCst);
}

/// Whether this frame wait is to fail; the next one is not.
pub(crate) fn take_wait_frame_failure() -> bool {
    FAIL_NEXT_WAIT.swap(false, Ordering::SeqCst)
}

/// Writes the event that a test's file `inject` asks for, if there is one: returns whether it did.
///
/// # Safety
/// There is room for an event.
pub(crate) unsafe fn try_write_injected_event(event: *mut sys::EventDataBuffer) -> bool {
    let path = layer_folder().join("inject");
    let Ok(request) = fs::read_to_string(&path) else { return false };
    // It is done once, as far as we can help.
    let _ = fs::remove_file(path);
    log_line(&format!("injected {}", request.trim()));
    let session = sys::Session::from_raw(SESSION.load(Ordering::SeqCst));
    let next = core::ptr::null();
    match request.trim() {
        "presence 0" | "presence 1" => {
            let is_user_present = sys::Bool32::from(request.trim().ends_with('1'));
            let ty = sys::EventDataUserPresenceChangedEXT::TYPE;
            let data = sys::EventDataUserPresenceChangedEXT { ty, next, session, is_user_present };
            // SAFETY: an event fits into the buffer.
            unsafe { event.cast::<sys::EventDataUserPresenceChangedEXT>().write(data) };
        }
        "heat" | "cool" => {
            let (cool, hot) = (
                sys::PerfSettingsNotificationLevelEXT::NORMAL,
                sys::PerfSettingsNotificationLevelEXT::IMPAIRED,
            );
            let (from_level, to_level) =
                if request.trim() == "heat" { (cool, hot) } else { (hot, cool) };
            let data = sys::EventDataPerfSettingsEXT {
                ty: sys::EventDataPerfSettingsEXT::TYPE,
                next,
                domain: sys::PerfSettingsDomainEXT::GPU,
                sub_domain: sys::PerfSettingsSubDomainEXT::THERMAL,
                from_level,
                to_level,
            };
            // SAFETY: as above.
            unsafe { event.cast::<sys::EventDataPerfSettingsEXT>().write(data) };
        }
        "lose session" => {
            let data = sys::EventDataSessionStateChanged {
                ty: sys::EventDataSessionStateChanged::TYPE,
                next,
                session,
                state: sys::SessionState::LOSS_PENDING,
                time: sys::Time::from_nanos(1),
            };
            // SAFETY: as above.
            unsafe { event.cast::<sys::EventDataSessionStateChanged>().write(data) };
        }
        "lose instance" => {
            let ty = sys::EventDataInstanceLossPending::TYPE;
            let loss_time = sys::Time::from_nanos(1);
            let data = sys::EventDataInstanceLossPending { ty, next, loss_time };
            // SAFETY: as above.
            unsafe { event.cast::<sys::EventDataInstanceLossPending>().write(data) };
        }
        _ => {
            FAIL_NEXT_WAIT.store(true, Ordering::SeqCst);
            return false;
        }
    }
    true
}
