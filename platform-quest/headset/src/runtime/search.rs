//! The search for a runtime, as Khronos' loader does it: the order in which libraries are tried and their
//! functions called, at most once in a process, and the report of failures. The calls themselves are
//! [`RuntimeCalls`].

use std::fmt;
use std::path::PathBuf;

use super::RuntimeLibrary;

/// A runtime that a source names: a broker, a manifest file, or the package.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Candidate {
    /// The source's name, for messages.
    pub source: String,
    /// The library that the source names, or the reason why there is none.
    pub library: Result<RuntimeLibrary, String>,
}

/// The calls into a library that are needed to find a runtime.
pub trait RuntimeCalls {
    /// An opened library. Two values are equal if they are the same library, whatever their names.
    type Library: PartialEq;
    /// The functions of a runtime, as returned by a negotiation.
    type Functions: Copy;
    /// The entry point for the application.
    type Entry: Clone;
    /// The reason why a library is unusable.
    type Error: Clone + fmt::Debug + fmt::Display;

    /// Opens a library without calling its functions.
    ///
    /// # Errors
    /// The library can't be opened, or is neither a runtime nor a loader.
    fn open(&mut self, library: &RuntimeLibrary) -> Result<Self::Library, Self::Error>;

    /// Calls the library's exported `xrInitializeLoaderKHR`. Returns `false` if it exports none.
    ///
    /// # Errors
    /// The error of the call.
    fn initialize_by_export(&mut self, library: &Self::Library) -> Result<bool, Self::Error>;

    /// Negotiates with a runtime. A loader's functions need no negotiation.
    ///
    /// # Errors
    /// The error of the negotiation.
    fn negotiate(&mut self, library: &Self::Library) -> Result<Self::Functions, Self::Error>;

    /// Calls `xrInitializeLoaderKHR` if the negotiated `xrGetInstanceProcAddr` has it.
    ///
    /// # Errors
    /// The error of the call.
    fn initialize_by_functions(&mut self, functions: Self::Functions) -> Result<(), Self::Error>;

    /// Makes the entry point from the functions.
    ///
    /// # Errors
    /// A function is missing that every runtime must have.
    fn make_entry(&mut self, functions: Self::Functions) -> Result<Self::Entry, Self::Error>;
}

/// A process's search for a runtime. A runtime may refuse a second initialisation or negotiation in a
/// process. So the first entry point serves every later session, and a library whose functions failed isn't
/// called again. A library that could not be opened is tried again.
#[derive(Debug)]
pub struct RuntimeSearch<C: RuntimeCalls> {
    entry: Option<C::Entry>,
    /// The libraries whose functions failed, with their errors.
    failed: Vec<(C::Library, C::Error)>,
}

/// A runtime that was found.
#[derive(Clone, Debug)]
pub struct FoundRuntime<E> {
    /// The runtime's entry point.
    pub entry: E,
    /// The candidates that failed before it; empty if the runtime was found earlier.
    pub tried: Vec<Tried>,
}

/// A candidate that failed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Tried {
    /// The source of the candidate.
    pub source: String,
    /// The library, if the source named one.
    pub library: Option<PathBuf>,
    /// The reason for the failure.
    pub why: String,
}

/// The error if no candidate is a runtime.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NoRuntime {
    /// All candidates that were tried, in order.
    pub tried: Vec<Tried>,
}

impl<C: RuntimeCalls> RuntimeSearch<C> {
    /// Creates a search that has not begun.
    #[must_use]
    pub const fn new() -> Self {
        RuntimeSearch { entry: None, failed: Vec::new() }
    }

    /// Returns the entry point that was found earlier, or else that of the first candidate that succeeds.
    /// Later candidates are not requested.
    ///
    /// # Errors
    /// [`NoRuntime`], with the failure of each candidate.
    pub fn find_once(
        &mut self,
        calls: &mut C,
        candidates: impl IntoIterator<Item = Candidate>,
    ) -> Result<FoundRuntime<C::Entry>, NoRuntime> {
        let mut tried = Vec::new();
        if let Some(entry) = self.entry.clone() {
            return Ok(FoundRuntime { entry, tried });
        }
        for Candidate { source, library } in candidates {
            let (library, why) = match library {
                Err(why) => (None, why),
                Ok(library) => match self.try_library(calls, &library) {
                    Err(error) => (Some(library.path), error.to_string()),
                    Ok(entry) => {
                        self.entry = Some(entry.clone());
                        return Ok(FoundRuntime { entry, tried });
                    }
                },
            };
            tried.push(Tried { source, library, why });
        }
        Err(NoRuntime { tried })
    }

    fn try_library(
        &mut self,
        calls: &mut C,
        library: &RuntimeLibrary,
    ) -> Result<C::Entry, C::Error> {
        let opened = calls.open(library)?;
        if let Some((_, error)) = self.failed.iter().find(|(failed, _)| *failed == opened) {
            return Err(error.clone());
        }
        let entry = start_runtime(calls, &opened);
        if let Err(error) = &entry {
            self.failed.push((opened, error.clone()));
        }
        entry
    }
}

impl<C: RuntimeCalls> Default for RuntimeSearch<C> {
    fn default() -> Self {
        Self::new()
    }
}

/// Initialises a library and negotiates with it. A library that exports the initialisation may require it
/// before the negotiation, and need not offer it among its functions: some abort if asked for it there.
fn start_runtime<C: RuntimeCalls>(
    calls: &mut C,
    library: &C::Library,
) -> Result<C::Entry, C::Error> {
    let is_initialized = calls.initialize_by_export(library)?;
    let functions = calls.negotiate(library)?;
    if !is_initialized {
        calls.initialize_by_functions(functions)?;
    }
    calls.make_entry(functions)
}

impl fmt::Display for Tried {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Tried { source, library, why } = self;
        match library {
            Some(library) => write!(f, "tried {}, named by {source}: {why}", library.display()),
            None => write!(f, "tried {source}: {why}"),
        }
    }
}

impl fmt::Display for NoRuntime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("no OpenXR runtime")?;
        self.tried.iter().try_for_each(|tried| write!(f, "; {tried}"))
    }
}

impl std::error::Error for NoRuntime {}

#[cfg(test)]
mod tests;
