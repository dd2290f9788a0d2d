//! The search for a runtime, as Khronos' loader does it: in which order libraries are tried and their
//! functions called, that each is called once in a process, and what is told of failures. The calls
//! themselves are [`RuntimeCalls`].

use std::fmt;
use std::path::PathBuf;

use super::RuntimeLibrary;

/// What a source says of the runtime: a broker, a manifest file, the package.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Candidate {
    /// The source's name, for messages.
    pub source: String,
    /// The library that it names, or why it names none.
    pub library: Result<RuntimeLibrary, String>,
}

/// The calls into a library that find a runtime.
pub trait RuntimeCalls {
    /// An opened library. Two of them are equal if they are one library, however it was named.
    type Library: PartialEq;
    /// The functions of a runtime, which a negotiation returns.
    type Functions: Copy;
    /// The entry point for the application.
    type Entry: Clone;
    /// Why a library is no use.
    type Error: Clone + fmt::Debug + fmt::Display;

    /// Opens a library, without a call of its functions.
    ///
    /// # Errors
    /// It can't be opened, or is neither runtime nor loader.
    fn open(&mut self, library: &RuntimeLibrary) -> Result<Self::Library, Self::Error>;

    /// Calls the library's exported `xrInitializeLoaderKHR`. False if it exports none.
    ///
    /// # Errors
    /// The call's.
    fn initialize_by_export(&mut self, library: &Self::Library) -> Result<bool, Self::Error>;

    /// Negotiates with a runtime; a loader has its functions without.
    ///
    /// # Errors
    /// The negotiation's.
    fn negotiate(&mut self, library: &Self::Library) -> Result<Self::Functions, Self::Error>;

    /// Calls `xrInitializeLoaderKHR` where the negotiated `xrGetInstanceProcAddr` has it.
    ///
    /// # Errors
    /// The call's.
    fn initialize_by_functions(&mut self, functions: Self::Functions) -> Result<(), Self::Error>;

    /// The entry point to the functions.
    ///
    /// # Errors
    /// One is missing that every runtime has.
    fn make_entry(&mut self, functions: Self::Functions) -> Result<Self::Entry, Self::Error>;
}

/// A process's search for a runtime. A runtime may refuse a second initialisation or negotiation in a
/// process: so the first entry point serves every later session, and no library is called again that
/// failed. What could not be opened is tried again.
#[derive(Debug)]
pub struct RuntimeSearch<C: RuntimeCalls> {
    entry: Option<C::Entry>,
    /// The libraries whose functions were called in vain.
    failed: Vec<(C::Library, C::Error)>,
}

/// A runtime that was found.
#[derive(Clone, Debug)]
pub struct FoundRuntime<E> {
    /// Its entry point.
    pub entry: E,
    /// What was tried before it; nothing if it was found earlier.
    pub tried: Vec<Tried>,
}

/// A candidate that failed.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Tried {
    /// The source of the candidate.
    pub source: String,
    /// The library, if it named one.
    pub library: Option<PathBuf>,
    /// Why it failed.
    pub why: String,
}

/// No candidate is a runtime.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct NoRuntime {
    /// All that was tried, in order.
    pub tried: Vec<Tried>,
}

impl<C: RuntimeCalls> RuntimeSearch<C> {
    /// A search that has not begun.
    #[must_use]
    pub const fn new() -> Self {
        RuntimeSearch { entry: None, failed: Vec::new() }
    }

    /// The entry point that was found earlier, or else that of the first candidate to succeed. Candidates
    /// after it are not asked for.
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

/// Initialises a library and negotiates with it. Who exports the initialisation may want it before the
/// negotiation, and need not have it among its functions: some break off when asked for it there.
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
