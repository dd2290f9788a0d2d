//! Events that a test injects, and a frame wait that fails on request.

use std::fs;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use openxr::sys;
use sys::Handle;

use super::folder::{layer_folder, log_line};

/// The session that was created last.
static SESSION: AtomicU64 = AtomicU64::new(0);
/// `true` if the next frame wait must fail.
static FAIL_NEXT_WAIT: AtomicBool = AtomicBool::new(false);

/// Stores the session of injected events.
pub(crate) fn set_session(session: sys::Session) {
    SESSION.store(session.into_raw(), Ordering::SeqCst);
}

/// Returns `true` if this frame wait must fail, and resets the request.
pub(crate) fn take_wait_frame_failure() -> bool {
    FAIL_NEXT_WAIT.swap(false, Ordering::SeqCst)
}

/// Writes the event that the test's file `inject` requests. Returns `true` if it wrote one.
///
/// # Safety
/// There is room for an event.
pub(crate) unsafe fn try_write_injected_event(event: *mut sys::EventDataBuffer) -> bool {
    let path = layer_folder().join("inject");
    let Ok(request) = fs::read_to_string(&path) else { return false };
    // Remove the file, so that the event is injected once.
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
