//! The hooked functions of OpenXR: they check the order of calls and their arguments, log the shell's
//! requests, and forward most calls.

use std::sync::Mutex;

use openxr::sys;
use sys::{Result as Status, pfn};

use super::chain::call_next;
use super::folder::{layer_folder, log_line};
use super::{actions, events, formats, foveation, hands, notices, resolution, spaces, threads};

/// The state of a session and of its frame.
struct FrameLoopState {
    state: sys::SessionState,
    frame: FrameStep,
    should_render: bool,
    /// The number of images that are acquired, waited for, and not yet released.
    taken: u32,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum FrameStep {
    None,
    Waited,
    Begun,
}

static STATE: Mutex<FrameLoopState> = Mutex::new(FrameLoopState {
    state: sys::SessionState::UNKNOWN,
    frame: FrameStep::None,
    should_render: false,
    taken: 0,
});

/// Returns the hook for a function's name, if there is one.
pub(crate) fn find_hook(name: &str) -> Option<pfn::VoidFunction> {
    macro_rules! functions {
        ($($name:literal: $ty:ident = $function:path,)*) => {
            match name {
                $($name => {
                    let function: pfn::$ty = $function;
                    // SAFETY: the shell calls it by the type that goes with the name.
                    Some(unsafe { core::mem::transmute::<pfn::$ty, pfn::VoidFunction>(function) })
                })*
                name => threads::find_hook(name),
            }
        };
    }
    functions! {
        "xrCreateSession": CreateSession = create_session,
        "xrBeginSession": BeginSession = begin_session,
        "xrEndSession": EndSession = end_session,
        "xrPollEvent": PollEvent = poll_event,
        "xrWaitFrame": WaitFrame = wait_frame,
        "xrBeginFrame": BeginFrame = begin_frame,
        "xrEndFrame": EndFrame = end_frame,
        "xrGetRecommendedLayerResolutionMETA": GetRecommendedLayerResolutionMETA =
            resolution::get_recommended_resolution,
        "xrCreateSwapchain": CreateSwapchain = create_swapchain,
        "xrAcquireSwapchainImage": AcquireSwapchainImage = acquire_image,
        "xrReleaseSwapchainImage": ReleaseSwapchainImage = release_image,
        "xrDestroySwapchain": DestroySwapchain = foveation::destroy_swapchain,
        "xrEnumerateSwapchainFormats": EnumerateSwapchainFormats = formats::enumerate_swapchain_formats,
        "xrEnumerateSwapchainImages": EnumerateSwapchainImages = foveation::enumerate_swapchain_images,
        "xrCreateFoveationProfileFB": CreateFoveationProfileFB = foveation::create_profile,
        "xrDestroyFoveationProfileFB": DestroyFoveationProfileFB = foveation::destroy_profile,
        "xrUpdateSwapchainFB": UpdateSwapchainFB = foveation::update_swapchain,
        "xrGetSwapchainStateFB": GetSwapchainStateFB = foveation::get_swapchain_state,
        "xrEnumerateReferenceSpaces": EnumerateReferenceSpaces = spaces::enumerate_reference_spaces,
        "xrCreateReferenceSpace": CreateReferenceSpace = spaces::create_reference_space,
        "xrCreateAction": CreateAction = actions::create_action,
        "xrCreateActionSpace": CreateActionSpace = hands::create_action_space,
        "xrCreateHandTrackerEXT": CreateHandTrackerEXT = hands::create_hand_tracker,
        "xrSyncActions": SyncActions = hands::sync_actions,
        "xrGetCurrentInteractionProfile": GetCurrentInteractionProfile = hands::get_current_profile,
        "xrGetActionStateFloat": GetActionStateFloat = hands::get_float,
        "xrLocateSpace": LocateSpace = hands::locate_space,
        "xrLocateHandJointsEXT": LocateHandJointsEXT = hands::locate_joints,
        "xrSuggestInteractionProfileBindings": SuggestInteractionProfileBindings = actions::suggest_bindings,
        "xrApplyHapticFeedback": ApplyHapticFeedback = apply_haptic_feedback,
        "xrStopHapticFeedback": StopHapticFeedback = stop_haptic_feedback,
        "xrPerfSettingsSetPerformanceLevelEXT": PerfSettingsSetPerformanceLevelEXT = set_performance_level,
        "xrEnumerateDisplayRefreshRatesFB": EnumerateDisplayRefreshRatesFB = enumerate_refresh_rates,
        "xrRequestDisplayRefreshRateFB": RequestDisplayRefreshRateFB = request_refresh_rate,
    }
}

/// Updates and checks the state; logs a violation if the check fails.
fn update_and_check(rule: &str, holds_after_update: impl FnOnce(&mut FrameLoopState) -> bool) {
    let mut state = STATE.lock().expect("no check panics");
    if !holds_after_update(&mut state) {
        let FrameLoopState { state: told, frame, should_render, taken } = &*state;
        let now = format!("{told:?}, {frame:?}, to draw {should_render}, images taken {taken}");
        log_line(&format!("violation: {rule} at {now}"));
    }
}

unsafe extern "system" fn create_session(
    instance: sys::Instance,
    info: *const sys::SessionCreateInfo,
    session: *mut sys::Session,
) -> Status {
    let made = call_next!(c"xrCreateSession": CreateSession, instance, info, session);
    if made == Status::SUCCESS {
        // SAFETY: the call has succeeded.
        events::set_session(unsafe { *session });
        update_and_check("a session", |state| {
            (state.state, state.frame, state.taken) =
                (sys::SessionState::UNKNOWN, FrameStep::None, 0);
            true
        });
        // SAFETY: the shell's structure is valid during the call.
        unsafe { foveation::remember_device(info) };
        log_line("session");
    }
    made
}

unsafe extern "system" fn begin_session(
    session: sys::Session,
    info: *const sys::SessionBeginInfo,
) -> Status {
    update_and_check("xrBeginSession", |state| state.state == sys::SessionState::READY);
    log_line("begin");
    notices::note_begin();
    call_next!(c"xrBeginSession": BeginSession, session, info)
}

unsafe extern "system" fn end_session(session: sys::Session) -> Status {
    update_and_check("xrEndSession", |state| {
        state.state == sys::SessionState::STOPPING && state.frame == FrameStep::None
    });
    call_next!(c"xrEndSession": EndSession, session)
}

unsafe extern "system" fn poll_event(
    instance: sys::Instance,
    event: *mut sys::EventDataBuffer,
) -> Status {
    notices::note_poll();
    // SAFETY: the shell has room for an event.
    if unsafe { events::try_write_injected_event(event) } {
        return Status::SUCCESS;
    }
    let told = call_next!(c"xrPollEvent": PollEvent, instance, event);
    // SAFETY: the call has succeeded, and its first word says which event it is.
    if told == Status::SUCCESS && unsafe { (*event).ty } == sys::EventDataSessionStateChanged::TYPE
    {
        // SAFETY: it is of this type.
        let state = unsafe { (*event.cast::<sys::EventDataSessionStateChanged>()).state };
        update_and_check("an event", |now| {
            now.state = state;
            true
        });
    }
    told
}

unsafe extern "system" fn wait_frame(
    session: sys::Session,
    info: *const sys::FrameWaitInfo,
    frame: *mut sys::FrameState,
) -> Status {
    if events::take_wait_frame_failure() {
        return Status::ERROR_SESSION_LOST;
    }
    let done = call_next!(c"xrWaitFrame": WaitFrame, session, info, frame);
    // SAFETY: the shell has room for a frame's state.
    let should_render = bool::from(unsafe { (*frame).should_render });
    if layer_folder().join("fast-display").exists() {
        // SAFETY: as above.
        unsafe { (*frame).predicted_display_period = sys::Duration::from_nanos(100_000) };
    }
    update_and_check("xrWaitFrame", |state| {
        let fits = state.frame == FrameStep::None;
        (state.frame, state.should_render) = (FrameStep::Waited, should_render);
        fits
    });
    done
}

unsafe extern "system" fn begin_frame(
    session: sys::Session,
    info: *const sys::FrameBeginInfo,
) -> Status {
    update_and_check("xrBeginFrame", |state| {
        core::mem::replace(&mut state.frame, FrameStep::Begun) == FrameStep::Waited
    });
    call_next!(c"xrBeginFrame": BeginFrame, session, info)
}

unsafe extern "system" fn end_frame(
    session: sys::Session,
    info: *const sys::FrameEndInfo,
) -> Status {
    // SAFETY: the shell's structure is valid during the call.
    let count = unsafe { (*info).layer_count };
    update_and_check("xrEndFrame", |state| {
        let fits = state.frame == FrameStep::Begun && state.taken == 0;
        state.frame = FrameStep::None;
        fits && count == u32::from(state.should_render)
    });
    // SAFETY: there is a layer, if the count says so, and it says of which type it is.
    let layer = (count == 1).then(|| unsafe { *(*info).layers });
    // SAFETY: as above.
    let is_studio = layer.is_some_and(|layer| unsafe { !check_layer(layer) });
    notices::note_frame(is_studio);
    call_next!(c"xrEndFrame": EndFrame, session, info)
}

/// Checks a layer: both eyes' views of the studio, or a notice. Returns `true` for a notice.
///
/// # Safety
/// The shell's layer is valid.
unsafe fn check_layer(layer: *const sys::CompositionLayerBaseHeader) -> bool {
    // SAFETY: the caller's.
    unsafe {
        if (*layer).ty == sys::CompositionLayerQuad::TYPE {
            let fits = notices::is_notice(layer.cast());
            update_and_check("a notice", |_| fits);
            return true;
        }
        update_and_check("a layer", |_| (*layer).ty == sys::CompositionLayerProjection::TYPE);
        let layer = &*layer.cast::<sys::CompositionLayerProjection>();
        update_and_check("the views", |_| layer.view_count == 2);
        for eye in 0..2 {
            let view = &*layer.views.add(eye);
            let image = view.sub_image;
            resolution::note_submitted(image.image_rect);
            update_and_check("a view", |_| {
                let extent = image.image_rect.extent;
                view.ty == sys::CompositionLayerProjectionView::TYPE
                    && image.image_array_index as usize == eye
                    && extent.width > 0
                    && extent.height > 0
            });
            if !view.next.is_null() {
                let depth = &*view.next.cast::<sys::CompositionLayerDepthInfoKHR>();
                update_and_check("a view's depth", |_| {
                    depth.ty == sys::CompositionLayerDepthInfoKHR::TYPE
                        && depth.near_z > depth.far_z
                        && depth.sub_image.swapchain != image.swapchain
                });
                log_line("depth");
            }
        }
        false
    }
}

unsafe extern "system" fn create_swapchain(
    session: sys::Session,
    info: *const sys::SwapchainCreateInfo,
    swapchain: *mut sys::Swapchain,
) -> Status {
    // SAFETY: the shell's structure is valid during the call.
    let (layers, samples) = unsafe { ((*info).array_size, (*info).sample_count) };
    // A swapchain for both eyes, or for a notice.
    update_and_check("xrCreateSwapchain", |_| matches!(layers, 1 | 2) && samples == 1);
    // SAFETY: handed on as it came.
    unsafe { foveation::create_swapchain(session, info, swapchain) }
}

unsafe extern "system" fn acquire_image(
    swapchain: sys::Swapchain,
    info: *const sys::SwapchainImageAcquireInfo,
    index: *mut u32,
) -> Status {
    update_and_check("xrAcquireSwapchainImage", |state| {
        state.taken += 1;
        state.frame == FrameStep::Begun && state.should_render
    });
    call_next!(c"xrAcquireSwapchainImage": AcquireSwapchainImage, swapchain, info, index)
}

unsafe extern "system" fn release_image(
    swapchain: sys::Swapchain,
    info: *const sys::SwapchainImageReleaseInfo,
) -> Status {
    update_and_check("xrReleaseSwapchainImage", |state| {
        let fits = state.taken > 0;
        state.taken = state.taken.saturating_sub(1);
        fits
    });
    call_next!(c"xrReleaseSwapchainImage": ReleaseSwapchainImage, swapchain, info)
}

unsafe extern "system" fn apply_haptic_feedback(
    session: sys::Session,
    action: *const sys::HapticActionInfo,
    feedback: *const sys::HapticBaseHeader,
) -> Status {
    // SAFETY: the shell's structures are valid during the call, and say of which type they are.
    unsafe {
        update_and_check("a pulse", |_| (*feedback).ty == sys::HapticVibration::TYPE);
        let pulse = &*feedback.cast::<sys::HapticVibration>();
        let (hand, nanos) = ((*action).subaction_path.into_raw(), pulse.duration.as_nanos());
        let frame = STATE.lock().map_or(FrameStep::None, |state| state.frame);
        log_line(&format!(
            "pulse hand {hand} amplitude {} nanos {nanos} frequency {} {frame:?}",
            pulse.amplitude, pulse.frequency
        ));
    }
    call_next!(c"xrApplyHapticFeedback": ApplyHapticFeedback, session, action, feedback)
}

unsafe extern "system" fn stop_haptic_feedback(
    session: sys::Session,
    action: *const sys::HapticActionInfo,
) -> Status {
    // SAFETY: the shell's structure is valid during the call.
    log_line(&format!("stop hand {}", unsafe { (*action).subaction_path.into_raw() }));
    call_next!(c"xrStopHapticFeedback": StopHapticFeedback, session, action)
}

unsafe extern "system" fn set_performance_level(
    _: sys::Session,
    domain: sys::PerfSettingsDomainEXT,
    level: sys::PerfSettingsLevelEXT,
) -> Status {
    log_line(&format!("level {domain:?} {level:?}"));
    match layer_folder().join("refuse-levels").exists() {
        true => Status::ERROR_VALIDATION_FAILURE,
        false => Status::SUCCESS,
    }
}

unsafe extern "system" fn enumerate_refresh_rates(
    _: sys::Session,
    capacity: u32,
    count: *mut u32,
    rates: *mut f32,
) -> Status {
    let offered = if layer_folder().join("no-rates").exists() { &[] } else { &RATES[..] };
    // SAFETY: there is room for a count, and for as many rates as the shell says.
    unsafe {
        *count = offered.len() as u32;
        if capacity >= *count {
            rates.copy_from_nonoverlapping(offered.as_ptr(), offered.len());
        }
    }
    Status::SUCCESS
}

const RATES: [f32; 3] = [60.0, 72.0, 90.0];

unsafe extern "system" fn request_refresh_rate(_: sys::Session, rate_hz: f32) -> Status {
    log_line(&format!("rate {rate_hz}"));
    Status::SUCCESS
}
