//! Finds Android's OpenXR runtime where the system has no loader, as Khronos' loader does it (OpenXR
//! loader specification, "Runtime Interaction"): the libraries that brokers and manifest files name are
//! tried in turn, and the first that can be opened, initialised and negotiated with is the runtime.
//! A package that holds Khronos' own loader has that tried first.

mod broker;
mod functions;
mod library;
mod manifest;
mod negotiation;
mod search;

use std::path::Path;
use std::sync::{Mutex, PoisonError};

use openxr as xr;

pub use broker::{BROKERS, FUNCTION_COLUMNS, QueryResult, RUNTIME_COLUMNS, query_broker};
pub use library::{
    AndroidContext, INITIALIZE_FUNCTION, LibraryError, LibraryFunctions, LinkedCalls,
    NEGOTIATE_FUNCTION, OpenedLibrary, RuntimeLibrary,
};
pub use manifest::{PARTITIONS, parse_manifest, read_manifests};
pub use negotiation::{NegotiationError, negotiate_interface};
pub use search::{Candidate, FoundRuntime, NoRuntime, RuntimeCalls, RuntimeSearch, Tried};

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

/// The candidates in the order in which they are tried: a loader in the package, what the brokers name,
/// what the manifest files of Android's partitions name. None is asked before it is its turn.
pub fn list_candidates(
    packaged_loader: &Path,
    mut query: impl FnMut(&str, &[&str]) -> QueryResult,
    partitions: &[impl AsRef<Path>],
) -> impl Iterator<Item = Candidate> {
    let loader = RuntimeLibrary::loader(packaged_loader.into());
    let loader = Candidate { source: "the package".into(), library: Ok(loader) };
    let brokers = BROKERS.into_iter().flat_map(move |broker| query_broker(broker, &mut query));
    let manifests = std::iter::once_with(|| read_manifests(partitions)).flatten();
    std::iter::once(loader).chain(brokers).chain(manifests)
}

#[cfg(test)]
mod tests {
    use super::{BROKERS, list_candidates};

    #[test]
    fn each_source_is_asked_when_it_is_its_turn() {
        let mut asked = Vec::new();
        let query = |table: &str, _: &[&str]| {
            asked.push(table.split('/').nth(2).expect("an authority").to_owned());
            Ok(vec![])
        };
        let mut candidates =
            list_candidates("libopenxr_loader.so".as_ref(), query, &["/no/such/partition"]);
        let mut next = || candidates.next().map(|candidate| candidate.source);
        assert_eq!(next().as_deref(), Some("the package"));
        assert_eq!(next().as_deref(), Some(BROKERS[0]));
        assert_eq!(next().as_deref(), Some(BROKERS[1]));
        assert!(next().is_some_and(|source| source.ends_with(" of /no/such/partition")));
        assert_eq!(next(), None);
        drop(candidates);
        // For each of its tables.
        asked.dedup();
        assert_eq!(asked, BROKERS);
    }
}
