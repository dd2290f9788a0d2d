//! Finds the headset's OpenXR runtime where no loader is installed: a packaged Khronos loader is
//! used if there is one; otherwise the runtime's own library, which a broker names, is opened and
//! negotiated with as a loader would (OpenXR specification, "Runtime Interaction").

mod broker;
mod negotiation;

use std::fmt;
use std::path::{Path, PathBuf};

use libloading::Library;
use openxr as xr;

pub use broker::{BROKERS, COLUMNS, FUNCTIONS, NEGOTIATE, Named, ask};
pub use negotiation::{Refusal, negotiate};

use crate::device;

/// Khronos' loader in the package, beside the shell's own library.
pub const LOADER: &str = "libopenxr_loader.so";

/// Why there is no runtime.
#[derive(Debug)]
pub enum Error {
    /// No broker names one; what each said.
    NoBroker(Vec<(&'static str, Option<device::Error>)>),
    /// The library can't be opened.
    Open(PathBuf, libloading::Error),
    /// The library lacks the function, of this name, that every runtime has.
    NoRuntime(PathBuf, String),
    /// The library is no runtime of ours.
    Refused(PathBuf, Refusal),
    /// It lacks a function that every runtime has.
    Call(PathBuf, xr::sys::Result),
    /// The packaged loader won't start.
    Loader(PathBuf, String),
}

/// The way to the headset's runtime: by `loader` if it is there, or the library that `broker` names.
///
/// # Errors
/// [`Error`], with the library and what was expected of it.
///
/// # Safety
/// What the loader or the broker names is a library that may be run in this process, and gives
/// functions as OpenXR has them.
pub unsafe fn find<P: xr::PlatformInfo>(
    loader: &Path,
    platform: &P,
    broker: impl FnOnce() -> Result<Named, Error>,
) -> Result<xr::Entry, Error> {
    // SAFETY: the loader comes from the package.
    match unsafe { xr::Entry::load_from(loader, platform) } {
        Ok(entry) => Ok(entry),
        Err(xr::EntryError::Load(_)) => {
            // SAFETY: the caller says so of what the broker names.
            unsafe { open(&broker()?, platform) }
        }
        Err(error) => Err(Error::Loader(loader.into(), error.to_string())),
    }
}

/// Opens a runtime's library and negotiates with it. It stays open: a runtime has threads of its
/// own, and none is made to be unloaded.
///
/// # Errors
/// [`Error`] with the library, but for those of the broker and the loader.
///
/// # Safety
/// The library may be run in this process and gives functions as OpenXR has them.
pub unsafe fn open<P: xr::PlatformInfo>(named: &Named, platform: &P) -> Result<xr::Entry, Error> {
    let Named { library, negotiate: name } = named;
    // SAFETY: the caller says that its initialisers may run.
    let opened = unsafe { Library::new(library) };
    let opened = opened.map_err(|error| Error::Open(library.into(), error))?;
    // SAFETY: the name stands for this type in every runtime, and another in this.
    let symbol = unsafe { opened.get(name.as_bytes()) };
    let function = *symbol.map_err(|_| Error::NoRuntime(library.into(), name.clone()))?;
    // SAFETY: it was just found in a runtime.
    let functions = unsafe { negotiate(function) };
    let functions = functions.map_err(|refusal| Error::Refused(library.into(), refusal))?;
    std::mem::forget(opened);
    // SAFETY: the runtime's own, as a loader takes it. Not every runtime has a wish to hear of the
    // activity before an instance is made; a loader tells those alone that have.
    let entry = unsafe {
        xr::Entry::from_get_instance_proc_addr(functions, platform)
            .or_else(|_| xr::Entry::from_get_instance_proc_addr(functions, &()))
    };
    entry.map_err(|error| Error::Call(library.into(), error))
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Error::NoBroker(said) => {
                f.write_str("no OpenXR runtime: no broker names one")?;
                for (broker, error) in said {
                    match error {
                        Some(error) => write!(f, "; {broker}: {error}")?,
                        None => write!(f, "; {broker}: no answer")?,
                    }
                }
                Ok(())
            }
            Error::Open(library, error) => {
                write!(f, "{}: can't be opened: {error}", library.display())
            }
            Error::NoRuntime(library, name) => {
                write!(f, "{}: no OpenXR runtime: it has no {name}", library.display())
            }
            Error::Refused(library, refusal) => write!(f, "{}: {refusal}", library.display()),
            Error::Call(library, result) => {
                write!(f, "{}: lacks a function of OpenXR: {result}", library.display())
            }
            Error::Loader(loader, why) => write!(f, "{}: {why}", loader.display()),
        }
    }
}

impl std::error::Error for Error {}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use paros_shell::require::{Required, require};

    use super::{Error, Named, find, open};

    #[test]
    fn what_is_no_runtime_is_told() -> Result<(), Required> {
        // SAFETY: nothing is opened.
        let why = unsafe { open(&Named::plain("/no/such/runtime.so".into()), &()) };
        let why = why.err().expect("no library");
        assert!(why.to_string().starts_with("/no/such/runtime.so: can't be opened: "), "{why}");
        let libm = Named { library: "libm.so.6".into(), negotiate: "maker_negotiate".into() };
        // SAFETY: the C library's mathematics are loaded already.
        let part = unsafe { libloading::Library::new(&libm.library) };
        if require(part.map_err(|why| why.to_string()))?.is_some() {
            // SAFETY: as before.
            let why = unsafe { open(&libm, &()) }.err().expect("it is none");
            assert_eq!(why.to_string(), "libm.so.6: no OpenXR runtime: it has no maker_negotiate");
        }
        Ok(())
    }

    #[test]
    fn without_a_packaged_loader_the_broker_is_asked() {
        let nobody = || Err(Error::NoBroker(vec![("a", None), ("b", None)]));
        // SAFETY: nothing is opened.
        let found = unsafe { find(Path::new("/no/such/loader.so"), &(), nobody) };
        assert_eq!(
            found.err().expect("there is none").to_string(),
            "no OpenXR runtime: no broker names one; a: no answer; b: no answer"
        );
    }
}
