//! Android's OpenXR runtime where the system has no loader: the calls into the libraries among which
//! [`paros_headset::runtime`] searches, and the process's one search.

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
/// [`NoRuntime`], with all that was tried.
pub fn find_runtime_once(
    calls: &mut LinkedCalls,
    candidates: impl IntoIterator<Item = Candidate>,
) -> Result<FoundRuntime<xr::Entry>, NoRuntime> {
    // A search that was broken off by a panic has found nothing yet.
    SEARCH.lock().unwrap_or_else(PoisonError::into_inner).find_once(calls, candidates)
}
