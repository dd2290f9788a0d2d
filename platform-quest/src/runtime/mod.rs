//! Finds Android's OpenXR runtime where the system has no loader: by Khronos' loader, if the package holds
//! one; otherwise the active runtime's library, which a runtime broker names, is opened and negotiated with
//! as a loader does (OpenXR loader specification, "Runtime Interaction").

mod broker;
mod negotiation;

use std::fmt;
use std::path::{Path, PathBuf};

use libloading::Library;
use openxr as xr;

pub use broker::{
    BROKERS, FUNCTION_COLUMNS, NEGOTIATE_FUNCTION, RUNTIME_COLUMNS, RuntimeLibrary, query_brokers,
};
pub use negotiation::{NegotiationError, negotiate_interface};

use crate::device;

/// Why no runtime was found.
#[derive(Debug)]
pub enum RuntimeError {
    /// No broker names one; each broker's error, if it gave one.
    NoBroker(Vec<(&'static str, Option<device::JavaError>)>),
    /// The library can't be opened.
    Open(PathBuf, libloading::Error),
    /// The library lacks the negotiation function, by this name.
    NoNegotiation(PathBuf, String),
    /// The negotiation failed.
    Refused(PathBuf, NegotiationError),
    /// The runtime lacks a function that every runtime has.
    Call(PathBuf, xr::sys::Result),
    /// The packaged loader can't be used.
    Loader(PathBuf, String),
}

/// Loads the runtime: by `loader` if that file exists, else the library that `broker` names.
///
/// # Errors
/// [`RuntimeError`], with the library and what was expected of it.
///
/// # Safety
/// What the loader or the broker names is a library that may be run in this process, and gives
/// functions as OpenXR has them.
pub unsafe fn find_runtime<P: xr::PlatformInfo>(
    loader: &Path,
    platform: &P,
    broker: impl FnOnce() -> Result<RuntimeLibrary, RuntimeError>,
) -> Result<xr::Entry, RuntimeError> {
    // SAFETY: the loader comes from the package.
    match unsafe { xr::Entry::load_from(loader, platform) } {
        Ok(entry) => Ok(entry),
        Err(xr::EntryError::Load(_)) => {
            // SAFETY: the caller says so of what the broker names.
            unsafe { open_runtime(&broker()?, platform) }
        }
        Err(error) => Err(RuntimeError::Loader(loader.into(), error.to_string())),
    }
}

/// Opens a runtime's library and negotiates with it. The library is never closed: a runtime has threads of
/// its own, and none is made to be unloaded.
///
/// # Errors
/// [`RuntimeError`] with the library, but for those of the broker and the loader.
///
/// # Safety
/// The library may be run in this process and gives functions as OpenXR has them.
pub unsafe fn open_runtime<P: xr::PlatformInfo>(
    library: &RuntimeLibrary,
    platform: &P,
) -> Result<xr::Entry, RuntimeError> {
    let RuntimeLibrary { path, negotiate_symbol } = library;
    // SAFETY: the caller says that its initialisers may run.
    let opened = unsafe { Library::new(path) };
    let opened = opened.map_err(|error| RuntimeError::Open(path.into(), error))?;
    // SAFETY: the name stands for this type in every runtime, and another in this.
    let symbol = unsafe { opened.get(negotiate_symbol.as_bytes()) };
    let function =
        *symbol.map_err(|_| RuntimeError::NoNegotiation(path.into(), negotiate_symbol.clone()))?;
    // SAFETY: it was just found in a runtime.
    let functions = unsafe { negotiate_interface(function) };
    let functions = functions.map_err(|refusal| RuntimeError::Refused(path.into(), refusal))?;
    std::mem::forget(opened);
    // SAFETY: the runtime's own, as a loader takes it. Not every runtime has a wish to hear of the
    // activity before an instance is made; a loader tells those alone that have.
    let entry = unsafe {
        xr::Entry::from_get_instance_proc_addr(functions, platform)
            .or_else(|_| xr::Entry::from_get_instance_proc_addr(functions, &()))
    };
    entry.map_err(|error| RuntimeError::Call(path.into(), error))
}

impl fmt::Display for RuntimeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RuntimeError::NoBroker(said) => {
                f.write_str("no OpenXR runtime: no broker names one")?;
                for (broker, error) in said {
                    match error {
                        Some(error) => write!(f, "; {broker}: {error}")?,
                        None => write!(f, "; {broker}: no answer")?,
                    }
                }
                Ok(())
            }
            RuntimeError::Open(library, error) => {
                write!(f, "{}: can't be opened: {error}", library.display())
            }
            RuntimeError::NoNegotiation(library, name) => {
                write!(f, "{}: no OpenXR runtime: it has no {name}", library.display())
            }
            RuntimeError::Refused(library, refusal) => {
                write!(f, "{}: {refusal}", library.display())
            }
            RuntimeError::Call(library, result) => {
                write!(f, "{}: lacks a function of OpenXR: {result}", library.display())
            }
            RuntimeError::Loader(loader, why) => write!(f, "{}: {why}", loader.display()),
        }
    }
}

impl std::error::Error for RuntimeError {}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use paros_shell::require::{MissingDependency, require_or_skip};

    use super::{RuntimeError, RuntimeLibrary, find_runtime, open_runtime};

    #[test]
    fn what_is_no_runtime_is_told() -> Result<(), MissingDependency> {
        // SAFETY: nothing is opened.
        let why = unsafe {
            open_runtime(&RuntimeLibrary::with_standard_names("/no/such/runtime.so".into()), &())
        };
        let why = why.err().expect("no library");
        assert!(why.to_string().starts_with("/no/such/runtime.so: can't be opened: "), "{why}");
        let libm =
            RuntimeLibrary { path: "libm.so.6".into(), negotiate_symbol: "maker_negotiate".into() };
        // SAFETY: the C library's mathematics are loaded already.
        let part = unsafe { libloading::Library::new(&libm.path) };
        if require_or_skip(part.map_err(|why| why.to_string()))?.is_some() {
            // SAFETY: as before.
            let why = unsafe { open_runtime(&libm, &()) }.err().expect("it is none");
            assert_eq!(why.to_string(), "libm.so.6: no OpenXR runtime: it has no maker_negotiate");
        }
        Ok(())
    }

    #[test]
    fn without_a_packaged_loader_the_broker_is_asked() {
        let nobody = || Err(RuntimeError::NoBroker(vec![("a", None), ("b", None)]));
        // SAFETY: nothing is opened.
        let found = unsafe { find_runtime(Path::new("/no/such/loader.so"), &(), nobody) };
        assert_eq!(
            found.err().expect("there is none").to_string(),
            "no OpenXR runtime: no broker names one; a: no answer; b: no answer"
        );
    }
}
