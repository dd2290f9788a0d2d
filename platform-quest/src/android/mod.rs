//! Android's side of the shell: the activity's entry point, its events, and a replay for tests.

mod replay;

// What `std` unwinds with. Android's own is in the NDK alone.
extern crate unwinding as _;

use std::time::Duration;

use android_activity::{AndroidApp, InputStatus, MainEvent, PollEvent, WindowManagerFlags};

#[unsafe(no_mangle)]
fn android_main(app: AndroidApp) {
    app.set_window_flags(WindowManagerFlags::KEEP_SCREEN_ON, WindowManagerFlags::empty());
    let mut going = true;
    while going {
        app.poll_events(Some(Duration::from_millis(10)), |event| match event {
            PollEvent::Main(MainEvent::Destroy) => going = false,
            PollEvent::Main(MainEvent::InputAvailable) => {}
            _ => {}
        });
        drain(&app);
    }
}

/// Reads the activity's input queue empty. The hands come through OpenXR; but a volume key that
/// nobody reads ends the process after five seconds.
fn drain(app: &AndroidApp) {
    if let Ok(mut events) = app.input_events_iter() {
        while events.next(|_| InputStatus::Unhandled) {}
    }
}
