//! The time before the studio: the quad layer of a notice, and the waits of events and frames meanwhile. The
//! log has `notice after N ms` for the first notice of each session, since its begin; and, with the first
//! frame of the studio, `studio after N notices, events waited N ms, frames N ms`, the longest waits.

use std::sync::Mutex;
use std::time::{Duration, Instant};

use openxr::sys;

use super::folder::log_line;

/// A session before its first frame of the studio.
struct Notices {
    begun: Instant,
    polled: Instant,
    ended: Instant,
    longest_poll: Duration,
    longest_frame: Duration,
    count: u32,
}

static NOTICES: Mutex<Option<Notices>> = Mutex::new(None);

/// Records the begin of a session.
pub(crate) fn note_begin() {
    let (now, none) = (Instant::now(), Duration::ZERO);
    if let Ok(mut notices) = NOTICES.lock() {
        *notices = Some(Notices {
            begun: now,
            polled: now,
            ended: now,
            longest_poll: none,
            longest_frame: none,
            count: 0,
        });
    }
}

/// Records that events were polled.
pub(crate) fn note_poll() {
    if let Ok(mut notices) = NOTICES.lock()
        && let Some(notices) = &mut *notices
    {
        notices.longest_poll = notices.longest_poll.max(notices.polled.elapsed());
        notices.polled = Instant::now();
    }
}

/// Records the end of a frame, with the studio or without.
pub(crate) fn note_frame(has_studio: bool) {
    if let Ok(mut kept) = NOTICES.lock()
        && let Some(notices) = &mut *kept
    {
        if has_studio {
            let Notices { count, longest_poll, longest_frame, .. } = notices;
            let [poll, frame] = [longest_poll, longest_frame].map(|longest| longest.as_millis());
            log_line(&format!(
                "studio after {count} notices, events waited {poll} ms, frames {frame} ms"
            ));
            *kept = None;
            return;
        }
        notices.longest_frame = notices.longest_frame.max(notices.ended.elapsed());
        notices.ended = Instant::now();
    }
}

/// Returns `true` if a quad layer shows a whole picture to both eyes, upright. Records that it was seen.
///
/// # Safety
/// The layer is one of this type, and valid.
pub(crate) unsafe fn is_notice(layer: *const sys::CompositionLayerQuad) -> bool {
    if let Ok(mut notices) = NOTICES.lock()
        && let Some(notices) = &mut *notices
    {
        notices.count += 1;
        if notices.count == 1 {
            log_line(&format!("notice after {} ms", notices.begun.elapsed().as_millis()));
        }
    }
    // SAFETY: the caller's.
    let layer = unsafe { &*layer };
    let (extent, turn) = (layer.sub_image.image_rect.extent, layer.pose.orientation);
    layer.eye_visibility == sys::EyeVisibility::BOTH
        && (extent.width, extent.height) == (1024, 512)
        && layer.size.width > 0.5
        && layer.size.height > 0.25
        && turn.x.abs() + turn.z.abs() < 1e-3
}
