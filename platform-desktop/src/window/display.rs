//! The end of the display. Left alone, Xlib ends the program on the spot when its server is gone;
//! here it goes on, so that the session is saved first.

use std::ffi::{c_int, c_void};
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};

use libloading::Library;
use winit::raw_window_handle::{HasDisplayHandle, RawDisplayHandle};
use winit::window::Window;

/// Set from within Xlib, which has nowhere else to tell it.
static GONE: AtomicBool = AtomicBool::new(false);

/// A function of Xlib or libwayland that looks at a connection.
type Look = unsafe extern "C" fn(*mut c_void) -> c_int;
type ExitHandler = unsafe extern "C" fn(*mut c_void, *mut c_void);
type SetErrorHandler = unsafe extern "C" fn(Look) -> Option<Look>;
type SetExitHandler = unsafe extern "C" fn(*mut c_void, ExitHandler, *mut c_void);

/// Whether files can be dropped on a window: on Wayland `winit` hears of none.
#[must_use]
pub(super) fn takes_drops(window: &Window) -> bool {
    let display = window.display_handle().map(|display| display.as_raw());
    !matches!(display, Ok(RawDisplayHandle::Wayland(_)))
}

/// The connection to a window's display, watched.
#[derive(Debug)]
pub(super) struct Display {
    connection: *mut c_void,
    look: Look,
    // What `look` is in.
    _library: Library,
}

impl Display {
    /// That of a window. None where it can't be watched: Xlib before 1.7, or another system.
    #[must_use]
    pub(super) fn of(window: &Window) -> Option<Self> {
        match window.display_handle().ok()?.as_raw() {
            RawDisplayHandle::Xlib(handle) => Self::x11(handle.display?.as_ptr()),
            RawDisplayHandle::Wayland(handle) => Self::wayland(handle.display.as_ptr()),
            _ => None,
        }
    }

    /// Whether it is known to be gone.
    #[must_use]
    pub(super) fn is_gone(&self) -> bool {
        GONE.load(Ordering::Relaxed)
    }

    /// Whether it is gone, after a look at the connection.
    #[must_use]
    pub(super) fn has_gone(&self) -> bool {
        // SAFETY: `winit` keeps the connection while the window is there, and this is its thread.
        self.is_gone() || unsafe { (self.look)(self.connection) } < 0 || self.is_gone()
    }

    fn x11(connection: *mut c_void) -> Option<Self> {
        // SAFETY: this is the Xlib that `winit` has loaded and uses.
        let library = unsafe { Library::new("libX11.so.6") }.ok()?;
        // SAFETY: these are the functions' types in Xlib.h.
        unsafe {
            let on_exit = *library.get::<SetExitHandler>(b"XSetIOErrorExitHandler\0").ok()?;
            let on_error = *library.get::<SetErrorHandler>(b"XSetIOErrorHandler\0").ok()?;
            let look = *library.get::<Look>(b"XPending\0").ok()?;
            on_error(note_end);
            on_exit(connection, go_on, ptr::null_mut());
            Some(Display { connection, look, _library: library })
        }
    }

    fn wayland(connection: *mut c_void) -> Option<Self> {
        // SAFETY: this is the library that `winit` has loaded and uses.
        let library = unsafe { Library::new("libwayland-client.so.0") }.ok()?;
        // SAFETY: this is the function's type in wayland-client-core.h.
        let look = unsafe { *library.get::<Look>(b"wl_display_flush\0").ok()? };
        Some(Display { connection, look, _library: library })
    }
}

unsafe extern "C" fn note_end(_connection: *mut c_void) -> c_int {
    GONE.store(true, Ordering::Relaxed);
    0
}

unsafe extern "C" fn go_on(_connection: *mut c_void, _data: *mut c_void) {}
