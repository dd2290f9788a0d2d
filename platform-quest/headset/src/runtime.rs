//! The search for Android's OpenXR runtime where the system has no loader, as Khronos' loader does it (OpenXR
//! loader specification, "Runtime Interaction"): the libraries that brokers and manifest files name are
//! tried in turn, and the first that can be opened, initialised and negotiated with is the runtime.
//! A package that holds Khronos' own loader has that tried first. The calls themselves are [`RuntimeCalls`].

mod broker;
mod manifest;
mod search;

use std::path::{Path, PathBuf};

pub use broker::{
    BROKERS, ContentRow, FUNCTION_COLUMNS, QueryResult, RUNTIME_COLUMNS, query_broker,
};
pub use manifest::{PARTITIONS, parse_manifest, read_manifests};
pub use search::{Candidate, FoundRuntime, NoRuntime, RuntimeCalls, RuntimeSearch, Tried};

/// The function by which a runtime's library is negotiated with.
pub const NEGOTIATE_FUNCTION: &str = "xrNegotiateLoaderRuntimeInterface";

/// The function that tells a runtime of the Java VM and the activity (`XR_KHR_loader_init_android`).
pub const INITIALIZE_FUNCTION: &str = "xrInitializeLoaderKHR";

/// A library that gives OpenXR's functions.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct RuntimeLibrary {
    /// Its file; within a package, as Android's linker has it: `base.apk!/lib/arm64-v8a/libx.so`.
    pub path: PathBuf,
    /// The symbol of [`INITIALIZE_FUNCTION`].
    pub initialize_symbol: String,
    /// The symbol of [`NEGOTIATE_FUNCTION`]; none for a loader, which exports `xrGetInstanceProcAddr`.
    pub negotiate_symbol: Option<String>,
}

impl RuntimeLibrary {
    /// A runtime's library whose symbols are OpenXR's names.
    #[must_use]
    pub fn runtime(path: PathBuf) -> Self {
        let negotiate_symbol = Some(NEGOTIATE_FUNCTION.into());
        RuntimeLibrary { negotiate_symbol, ..Self::loader(path) }
    }

    /// A loader's library.
    #[must_use]
    pub fn loader(path: PathBuf) -> Self {
        let initialize_symbol = INITIALIZE_FUNCTION.into();
        RuntimeLibrary { path, initialize_symbol, negotiate_symbol: None }
    }

    /// Renames a function as its source says. Other functions than those of the search keep their names.
    pub fn rename_function(&mut self, function: &str, symbol: &str) {
        match function {
            NEGOTIATE_FUNCTION => self.negotiate_symbol = Some(symbol.into()),
            INITIALIZE_FUNCTION => self.initialize_symbol = symbol.into(),
            _ => {}
        }
    }
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
