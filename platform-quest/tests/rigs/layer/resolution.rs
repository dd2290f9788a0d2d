//! Dynamic resolution: recommends (`XR_META_recommended_layer_resolution`) the two numbers of pixels in the
//! file `recommended` in the layer's folder, and logs the extent that the shell submits whenever it changes.

use std::fs;
use std::sync::Mutex;

use openxr::sys;
use sys::Result as Status;

use super::folder::{layer_folder, log_line};

/// The extent that was submitted last, and the number of submitted views.
static SUBMITTED: Mutex<([i32; 2], u32)> = Mutex::new(([0; 2], 0));

/// Logs a view's extent and the frame's number if the extent has changed.
pub(crate) fn note_submitted(rect: sys::Rect2Di) {
    let extent = [rect.extent.width, rect.extent.height];
    let mut last = SUBMITTED.lock().expect("no holder panics");
    // A frame has two views.
    last.1 += 1;
    if last.0 != extent {
        last.0 = extent;
        log_line(&format!("submitted {}x{} in frame {}", extent[0], extent[1], last.1 / 2));
    }
}

/// `xrGetRecommendedLayerResolutionMETA`.
///
/// # Safety
/// The shell's structures are valid.
pub(crate) unsafe extern "system" fn get_recommended_resolution(
    _: sys::Session,
    info: *const sys::RecommendedLayerResolutionGetInfoMETA,
    resolution: *mut sys::RecommendedLayerResolutionMETA,
) -> Status {
    // SAFETY: the caller's.
    let (info, resolution) = unsafe { (&*info, &mut *resolution) };
    let is_right = info.ty == sys::RecommendedLayerResolutionGetInfoMETA::TYPE
        && resolution.ty == sys::RecommendedLayerResolutionMETA::TYPE
        && !info.layer.is_null()
        && info.predicted_display_time.as_nanos() > 0
        // SAFETY: a layer begins with its type.
        && unsafe { (*info.layer).ty } == sys::CompositionLayerProjection::TYPE;
    if !is_right {
        log_line("violation: what resolution is recommended for");
        return Status::ERROR_VALIDATION_FAILURE;
    }
    let text = fs::read_to_string(layer_folder().join("recommended")).unwrap_or_default();
    let numbers: Vec<i32> = text.split_whitespace().filter_map(|word| word.parse().ok()).collect();
    let told = <[i32; 2]>::try_from(numbers).ok();
    resolution.is_valid = told.is_some().into();
    let [width, height] = told.unwrap_or_default();
    resolution.recommended_image_dimensions = sys::Extent2Di { width, height };
    Status::SUCCESS
}
