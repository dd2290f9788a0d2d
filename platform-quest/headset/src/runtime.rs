//! The search for Android's OpenXR runtime on systems without a loader, as Khronos' loader does it (OpenXR
//! loader specification, "Runtime Interaction"): the libraries named by brokers and manifest files are tried
//! in order. The first library that can be opened, initialised and negotiated with is the runtime. If the
//! package holds Khronos' own loader, that is tried first. The calls themselves are [`RuntimeCalls`].

mod broker;
mod manifest;
mod search;

use std::path::{Path, PathBuf};

pub use broker::{
    BROKERS, ContentRow, FUNCTION_COLUMNS, QueryResult, RUNTIME_COLUMNS, query_broker,
};
pub use manifest::{PARTITIONS, parse_manifest, read_manifests};
pub use search::{Candidate, FoundRuntime, NoRuntime, RuntimeCalls, RuntimeSearch, Tried};

/// The function that negotiates with a runtime's library.
pub const NEGOTIATE_FUNCTION: &str = "xrNegotiateLoaderRuntimeInterface";

/// The function that passes the Java VM and the activity to a runtime (`XR_KHR_loader_init_android`).
pub const INITIALIZE_FUNCTION: &str = "xrInitializeLoaderKHR";

/// A library that provides OpenXR's functions.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RuntimeLibrary {
    /// The library's file; within a package, in the form of Android's linker:
    /// `base.apk!/lib/arm64-v8a/libx.so`.
    pub path: PathBuf,
    /// The symbol of [`INITIALIZE_FUNCTION`].
    pub initialize_symbol: String,
    /// The symbol of [`NEGOTIATE_FUNCTION`]; `None` for a loader, which exports `xrGetInstanceProcAddr`.
    pub negotiate_symbol: Option<String>,
}

impl RuntimeLibrary {
    /// Creates a runtime's library whose symbols have OpenXR's names.
    #[must_use]
    pub fn runtime(path: PathBuf) -> Self {
        let negotiate_symbol = Some(NEGOTIATE_FUNCTION.into());
        RuntimeLibrary { negotiate_symbol, ..Self::loader(path) }
    }

    /// Creates a loader's library.
    #[must_use]
    pub fn loader(path: PathBuf) -> Self {
        let initialize_symbol = INITIALIZE_FUNCTION.into();
        RuntimeLibrary { path, initialize_symbol, negotiate_symbol: None }
    }

    /// Sets the symbol of a function, as its source requests. Functions that the search doesn't call are
    /// ignored.
    pub fn rename_function(&mut self, function: &str, symbol: &str) {
        match function {
            NEGOTIATE_FUNCTION => self.negotiate_symbol = Some(symbol.into()),
            INITIALIZE_FUNCTION => self.initialize_symbol = symbol.into(),
            _ => {}
        }
    }
}

/// Lists the candidates in the order in which they are tried: a loader in the package, the brokers' runtimes,
/// the runtimes of the manifest files on Android's partitions. Each source is queried lazily.
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
        // Each broker is queried for each of its tables.
        asked.dedup();
        assert_eq!(asked, BROKERS);
    }
}
