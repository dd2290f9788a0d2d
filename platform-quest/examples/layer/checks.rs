//! The calls that the layer looks at.

use std::sync::Mutex;
use std::sync::atomic::Ordering;

use openxr::sys;
use sys::{Handle, Result as Status, pfn};

use super::{
    FAIL, SESSION, actions, folder, formats, foveation, inject, next, note, spaces, threads,
};

/// Where a session and its frame stand.
struct State {
    told: sys::SessionState,
    frame: Frame,
    should_render: bool,
    /// Images that are taken, waited for, and not yet handed over.
    taken: u32,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Frame {
    None,
    Waited,
    Begun,
}

static STATE: Mutex<State> = Mutex::new(State {
    told: sys::SessionState::UNKNOWN,
    frame: Frame::None,
    should_render: false,
    taken: 0,
});

/// The layer's function of a name.
pub(crate) fn own(name: &str) -> Option<pfn::VoidFunction> {
    macro_rules! functions {
        ($($name:literal: $ty:ident = $function:path,)*) => {
            match name {
                $($name => {
                    let function: pfn::$ty = $function;
                    // SAFETY: the shell calls it by the type that goes with the name.
                    Some(unsafe { core::mem::transmute::<pfn::$ty, pfn::VoidFunction>(function) })
                })*
                name => threads::own(name),
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
        "xrCreateSwapchain": CreateSwapchain = create_swapchain,
        "xrAcquireSwapchainImage": AcquireSwapchainImage = acquire,
        "xrReleaseSwapchainImage": ReleaseSwapchainImage = release,
        "xrDestroySwapchain": DestroySwapchain = foveation::destroy,
        "xrEnumerateSwapchainFormats": EnumerateSwapchainFormats = formats::formats,
        "xrEnumerateSwapchainImages": EnumerateSwapchainImages = foveation::images,
        "xrCreateFoveationProfileFB": CreateFoveationProfileFB = foveation::make_profile,
        "xrDestroyFoveationProfileFB": DestroyFoveationProfileFB = foveation::destroy_profile,
        "xrUpdateSwapchainFB": UpdateSwapchainFB = foveation::update,
        "xrGetSwapchainStateFB": GetSwapchainStateFB = foveation::told,
        "xrEnumerateReferenceSpaces": EnumerateReferenceSpaces = spaces::spaces,
        "xrCreateReferenceSpace": CreateReferenceSpace = spaces::create_space,
        "xrCreateAction": CreateAction = actions::create_action,
        "xrSuggestInteractionProfileBindings": SuggestInteractionProfileBindings = actions::suggest,
        "xrApplyHapticFeedback": ApplyHapticFeedback = haptic,
        "xrPerfSettingsSetPerformanceLevelEXT": PerfSettingsSetPerformanceLevelEXT = level,
        "xrEnumerateDisplayRefreshRatesFB": EnumerateDisplayRefreshRatesFB = rates,
        "xrRequestDisplayRefreshRateFB": RequestDisplayRefreshRateFB = rate,
    }
}

/// Looks at the state; what is not as it must be is noted.
fn check(what: &str, look: impl FnOnce(&mut State) -> bool) {
    let mut state = STATE.lock().expect("no check panics");
    if !look(&mut state) {
        let State { told, frame, should_render, taken } = &*state;
        let now = format!("{told:?}, {frame:?}, to draw {should_render}, images taken {taken}");
        note(&format!("violation: {what} at {now}"));
    }
}

/// Hands a call on, as it came.
macro_rules! on {
    ($name:literal: $ty:ident, $($argument:expr),*) => {{
        // SAFETY: the type is the function's.
        let function: pfn::$ty = unsafe { next($name) };
        // SAFETY: handed on as it came.
        unsafe { function($($argument),*) }
    }};
}
pub(crate) use on;

unsafe extern "system" fn create_session(
    instance: sys::Instance,
    info: *const sys::SessionCreateInfo,
    session: *mut sys::Session,
) -> Status {
    let made = on!(c"xrCreateSession": CreateSession, instance, info, session);
    if made == Status::SUCCESS {
        // SAFETY: the call has succeeded.
        SESSION.store(unsafe { (*session).into_raw() }, Ordering::SeqCst);
        check("a session", |state| {
            (state.told, state.frame, state.taken) = (sys::SessionState::UNKNOWN, Frame::None, 0);
            true
        });
        // SAFETY: the shell's structure is valid during the call.
        unsafe { foveation::bound(info) };
        note("session");
    }
    made
}

unsafe extern "system" fn begin_session(
    session: sys::Session,
    info: *const sys::SessionBeginInfo,
) -> Status {
    check("xrBeginSession", |state| state.told == sys::SessionState::READY);
    on!(c"xrBeginSession": BeginSession, session, info)
}

unsafe extern "system" fn end_session(session: sys::Session) -> Status {
    check("xrEndSession", |state| {
        state.told == sys::SessionState::STOPPING && state.frame == Frame::None
    });
    on!(c"xrEndSession": EndSession, session)
}

unsafe extern "system" fn poll_event(
    instance: sys::Instance,
    event: *mut sys::EventDataBuffer,
) -> Status {
    // SAFETY: the shell has room for an event.
    if unsafe { inject(event) } {
        return Status::SUCCESS;
    }
    let told = on!(c"xrPollEvent": PollEvent, instance, event);
    // SAFETY: the call has succeeded, and its first word says which event it is.
    if told == Status::SUCCESS && unsafe { (*event).ty } == sys::EventDataSessionStateChanged::TYPE
    {
        // SAFETY: it is of this type.
        let state = unsafe { (*event.cast::<sys::EventDataSessionStateChanged>()).state };
        check("an event", |now| {
            now.told = state;
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
    if FAIL.swap(false, Ordering::SeqCst) {
        return Status::ERROR_SESSION_LOST;
    }
    let done = on!(c"xrWaitFrame": WaitFrame, session, info, frame);
    // SAFETY: the shell has room for a frame's state.
    let should_render = bool::from(unsafe { (*frame).should_render });
    check("xrWaitFrame", |state| {
        let fits = state.frame == Frame::None;
        (state.frame, state.should_render) = (Frame::Waited, should_render);
        fits
    });
    done
}

unsafe extern "system" fn begin_frame(
    session: sys::Session,
    info: *const sys::FrameBeginInfo,
) -> Status {
    check("xrBeginFrame", |state| {
        core::mem::replace(&mut state.frame, Frame::Begun) == Frame::Waited
    });
    on!(c"xrBeginFrame": BeginFrame, session, info)
}

unsafe extern "system" fn end_frame(
    session: sys::Session,
    info: *const sys::FrameEndInfo,
) -> Status {
    // SAFETY: the shell's structure is valid during the call.
    let count = unsafe { (*info).layer_count };
    check("xrEndFrame", |state| {
        let fits = state.frame == Frame::Begun && state.taken == 0;
        state.frame = Frame::None;
        fits && count == u32::from(state.should_render)
    });
    if count == 1 {
        // SAFETY: there is a layer, and it says of which type it is.
        unsafe {
            let layer = *(*info).layers;
            check("a layer", |_| (*layer).ty == sys::CompositionLayerProjection::TYPE);
            let layer = &*layer.cast::<sys::CompositionLayerProjection>();
            check("the views", |_| layer.view_count == 2);
            for eye in 0..2 {
                let view = &*layer.views.add(eye);
                let image = view.sub_image;
                check("a view", |_| {
                    let extent = image.image_rect.extent;
                    view.ty == sys::CompositionLayerProjectionView::TYPE
                        && image.image_array_index as usize == eye
                        && extent.width > 0
                        && extent.height > 0
                });
                if !view.next.is_null() {
                    let depth = &*view.next.cast::<sys::CompositionLayerDepthInfoKHR>();
                    check("a view's depth", |_| {
                        depth.ty == sys::CompositionLayerDepthInfoKHR::TYPE
                            && depth.near_z > depth.far_z
                            && depth.sub_image.swapchain != image.swapchain
                    });
                    note("depth");
                }
            }
        }
    }
    on!(c"xrEndFrame": EndFrame, session, info)
}

unsafe extern "system" fn create_swapchain(
    session: sys::Session,
    info: *const sys::SwapchainCreateInfo,
    swapchain: *mut sys::Swapchain,
) -> Status {
    // SAFETY: the shell's structure is valid during the call.
    let (layers, samples) = unsafe { ((*info).array_size, (*info).sample_count) };
    check("xrCreateSwapchain", |_| layers == 2 && samples == 1);
    // SAFETY: handed on as it came.
    unsafe { foveation::make(session, info, swapchain) }
}

unsafe extern "system" fn acquire(
    swapchain: sys::Swapchain,
    info: *const sys::SwapchainImageAcquireInfo,
    index: *mut u32,
) -> Status {
    check("xrAcquireSwapchainImage", |state| {
        state.taken += 1;
        state.frame == Frame::Begun && state.should_render
    });
    on!(c"xrAcquireSwapchainImage": AcquireSwapchainImage, swapchain, info, index)
}

unsafe extern "system" fn release(
    swapchain: sys::Swapchain,
    info: *const sys::SwapchainImageReleaseInfo,
) -> Status {
    check("xrReleaseSwapchainImage", |state| {
        let fits = state.taken > 0;
        state.taken = state.taken.saturating_sub(1);
        fits
    });
    on!(c"xrReleaseSwapchainImage": ReleaseSwapchainImage, swapchain, info)
}

unsafe extern "system" fn haptic(
    session: sys::Session,
    action: *const sys::HapticActionInfo,
    feedback: *const sys::HapticBaseHeader,
) -> Status {
    // SAFETY: the shell's structures are valid during the call, and say of which type they are.
    unsafe {
        check("a pulse", |_| (*feedback).ty == sys::HapticVibration::TYPE);
        let pulse = &*feedback.cast::<sys::HapticVibration>();
        let (hand, nanos) = ((*action).subaction_path.into_raw(), pulse.duration.as_nanos());
        let frame = STATE.lock().map_or(Frame::None, |state| state.frame);
        note(&format!("pulse hand {hand} amplitude {} nanos {nanos} {frame:?}", pulse.amplitude));
    }
    on!(c"xrApplyHapticFeedback": ApplyHapticFeedback, session, action, feedback)
}

unsafe extern "system" fn level(
    _: sys::Session,
    domain: sys::PerfSettingsDomainEXT,
    level: sys::PerfSettingsLevelEXT,
) -> Status {
    note(&format!("level {domain:?} {level:?}"));
    Status::SUCCESS
}

unsafe extern "system" fn rates(
    _: sys::Session,
    capacity: u32,
    count: *mut u32,
    rates: *mut f32,
) -> Status {
    let offered = if folder().join("no-rates").exists() { &[] } else { &RATES[..] };
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

unsafe extern "system" fn rate(_: sys::Session, rate: f32) -> Status {
    note(&format!("rate {rate}"));
    Status::SUCCESS
}
