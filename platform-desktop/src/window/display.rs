//! Loss of the display connection. By default Xlib exits the process on an I/O error (XIOErrorHandler). Here
//! the process continues, so that the session can be saved first.

use std::ffi::{c_int, c_void};
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};

use libloading::Library;
use winit::raw_window_handle::{HasDisplayHandle, RawDisplayHandle};
use winit::window::Window;

/// `true` once the connection is lost. Set by Xlib's handler, which gets no user data.
static GONE: AtomicBool = AtomicBool::new(false);

/// A function of Xlib or libwayland that polls a connection; negative on a Wayland error.
type CheckConnection = unsafe extern "C" fn(*mut c_void) -> c_int;
type ExitHandler = unsafe extern "C" fn(*mut c_void, *mut c_void);
type SetErrorHandler = unsafe extern "C" fn(CheckConnection) -> Option<CheckConnection>;
type SetExitHandler = unsafe extern "C" fn(*mut c_void, ExitHandler, *mut c_void);

/// Returns `true` if files can be dropped on a window. `winit` has no such event on Wayland.
#[must_use]
pub(super) fn supports_file_drops(window: &Window) -> bool {
    let display = window.display_handle().map(|display| display.as_raw());
    !matches!(display, Ok(RawDisplayHandle::Wayland(_)))
}

/// The connection of a window's display, with its I/O error handler set.
#[derive(Debug)]
pub(super) struct DisplayConnection {
    connection: *mut c_void,
    check: CheckConnection,
    // The library of `check`.
    _library: Library,
}

impl DisplayConnection {
    /// Sets the error handler of a window's connection. Returns `None` if the system has no such handler:
    /// Xlib before 1.7, or another window system.
    #[must_use]
    pub(super) fn watch_window(window: &Window) -> Option<Self> {
        match window.display_handle().ok()?.as_raw() {
            RawDisplayHandle::Xlib(handle) => {
                Self::set_xlib_error_handlers(handle.display?.as_ptr())
            }
            RawDisplayHandle::Wayland(handle) => {
                Self::watch_wayland_display(handle.display.as_ptr())
            }
            _ => None,
        }
    }

    /// Returns `true` if the connection is already known to be lost. Does not poll.
    #[must_use]
    pub(super) fn is_known_lost(&self) -> bool {
        GONE.load(Ordering::Relaxed)
    }

    /// Polls the connection. Returns `true` if it is lost.
    #[must_use]
    pub(super) fn poll_is_lost(&self) -> bool {
        // SAFETY: `winit` keeps the connection while the window is there, and this is its thread.
        self.is_known_lost() || unsafe { (self.check)(self.connection) } < 0 || self.is_known_lost()
    }

    fn set_xlib_error_handlers(xlib_display: *mut c_void) -> Option<Self> {
        // SAFETY: this is the Xlib that `winit` has loaded and uses.
        let library = unsafe { Library::new("libX11.so.6") }.ok()?;
        // SAFETY: these are the functions' types in Xlib.h.
        unsafe {
            let on_exit = *library.get::<SetExitHandler>(b"XSetIOErrorExitHandler\0").ok()?;
            let on_error = *library.get::<SetErrorHandler>(b"XSetIOErrorHandler\0").ok()?;
            let check = *library.get::<CheckConnection>(b"XPending\0").ok()?;
            on_error(on_io_error);
            on_exit(xlib_display, ignore_io_error_exit, ptr::null_mut());
            Some(DisplayConnection { connection: xlib_display, check, _library: library })
        }
    }

    fn watch_wayland_display(wl_display: *mut c_void) -> Option<Self> {
        // SAFETY: this is the library that `winit` has loaded and uses.
        let library = unsafe { Library::new("libwayland-client.so.0") }.ok()?;
        // SAFETY: this is the function's type in wayland-client-core.h.
        let check = unsafe { *library.get::<CheckConnection>(b"wl_display_flush\0").ok()? };
        Some(DisplayConnection { connection: wl_display, check, _library: library })
    }
}

unsafe extern "C" fn on_io_error(_connection: *mut c_void) -> c_int {
    GONE.store(true, Ordering::Relaxed);
    0
}

unsafe extern "C" fn ignore_io_error_exit(_connection: *mut c_void, _data: *mut c_void) {}
