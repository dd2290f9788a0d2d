//! Functions of libraries that are loaded at run time.

use std::ffi::{CStr, c_char};
use std::path::Path;

use libloading::Library;

use super::DeviceError;

/// Loads a library of a sound interface. It is never unloaded: some libraries leave threads and handlers
/// behind that still need its code.
pub(super) fn load_and_keep(path: &Path) -> Result<&'static Library, DeviceError> {
    // SAFETY: the system's sound library, whose initialisers may run in any program.
    let library = unsafe { Library::new(path) };
    let library = library.map_err(|error| DeviceError::NoLibrary(error.to_string()))?;
    Ok(Box::leak(Box::new(library)))
}

/// Finds a function.
///
/// # Safety
/// In this library the name stands for a function of type `F`.
pub(super) unsafe fn find_function<F: Copy>(
    library: &'static Library,
    name: &'static str,
) -> Result<F, DeviceError> {
    // SAFETY: as the caller says.
    let found = unsafe { library.get::<F>(name.as_bytes()) };
    found.map(|symbol| *symbol).map_err(|_| DeviceError::NoFunction(name))
}

/// Copies a text that a library owns; a null pointer becomes `error` with the number.
///
/// # Safety
/// It is null or ends with a zero byte, and stays until this returns.
pub(super) unsafe fn text_of(text: *const c_char, number: i64) -> String {
    if text.is_null() {
        return format!("error {number}");
    }
    // SAFETY: as the caller says.
    unsafe { CStr::from_ptr(text) }.to_string_lossy().into_owned()
}
