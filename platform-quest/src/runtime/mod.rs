//! Android's OpenXR runtime on systems without a loader: the calls into the libraries that
//! [`paros_headset::runtime`] searches, and the process's only search.

mod functions;
mod library;
mod negotiation;

use std::sync::{Mutex, PoisonError};

use openxr as xr;
use paros_headset::runtime::{Candidate, FoundRuntime, NoRuntime, RuntimeSearch};

pub use library::{AndroidContext, LibraryError, LibraryFunctions, LinkedCalls, OpenedLibrary};
pub use negotiation::{NegotiationError, negotiate_interface};

/// The process's search.
static SEARCH: Mutex<RuntimeSearch<LinkedCalls>> = Mutex::new(RuntimeSearch::new());

/// Finds the runtime once in this process: see [`RuntimeSearch::find_once`].
///
/// # Errors
/// [`NoRuntime`], with all candidates that were tried.
pub fn find_runtime_once(
    calls: &mut LinkedCalls,
    candidates: impl IntoIterator<Item = Candidate>,
) -> Result<FoundRuntime<xr::Entry>, NoRuntime> {
    // A search that ended in a panic has found nothing yet.
    SEARCH.lock().unwrap_or_else(PoisonError::into_inner).find_once(calls, candidates)
}
