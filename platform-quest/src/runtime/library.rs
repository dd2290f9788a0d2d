//! The calls into the libraries of runtimes and loaders.

use std::ffi::c_void;

use libloading::Library;
use openxr as xr;
use openxr::sys::pfn::{
    GetInstanceProcAddr, InitializeLoaderKHR, NegotiateLoaderRuntimeInterface, VoidFunction,
};
use openxr::sys::{Handle as _, Result as XrResult, StructureType};
use paros_headset::runtime::{INITIALIZE_FUNCTION, RuntimeCalls, RuntimeLibrary};

use super::functions::make_runtime_entry;
use super::negotiation::{NegotiationError, negotiate_interface};

/// The function through which a loader provides all others.
const PROC_ADDR_FUNCTION: &str = "xrGetInstanceProcAddr";

/// The reason why a library is unusable.
#[derive(Clone, PartialEq, Eq, Debug, thiserror::Error)]
pub enum LibraryError {
    /// The linker could not open the library, for this reason.
    #[error("can't be opened: {0}")]
    Open(String),
    /// The library lacks this function, and so is neither a runtime nor a loader.
    #[error("is no OpenXR runtime: it has no {0}")]
    NoFunction(String),
    /// [`INITIALIZE_FUNCTION`] failed.
    #[error("{name} failed: {0:?}", name = INITIALIZE_FUNCTION)]
    Initialization(XrResult),
    /// The negotiation failed.
    #[error("{0}")]
    Refused(NegotiationError),
    /// The library lacks a function that every runtime must have.
    #[error("lacks a function of OpenXR: {0:?}")]
    Call(XrResult),
}

/// The arguments of [`INITIALIZE_FUNCTION`].
#[derive(Clone, Copy, Debug)]
pub struct AndroidContext {
    /// The `JavaVM`.
    pub vm: *mut c_void,
    /// A reference to the activity.
    pub activity: *mut c_void,
}

/// Calls into libraries through the system's linker.
#[derive(Clone, Copy, Debug)]
pub struct LinkedCalls {
    context: Option<AndroidContext>,
}

impl LinkedCalls {
    /// Creates calls that initialise libraries for a context. Without a context, as on Linux, no library is
    /// initialised.
    ///
    /// # Safety
    /// The context is valid while this value is used. Every opened library may run in this process, and its
    /// functions have OpenXR's types.
    #[must_use]
    pub const unsafe fn new(context: Option<AndroidContext>) -> Self {
        LinkedCalls { context }
    }

    /// Calls a library's initialisation function, if there is a context.
    fn initialize(&self, function: InitializeLoaderKHR) -> Result<(), LibraryError> {
        let Some(AndroidContext { vm, activity }) = self.context else { return Ok(()) };
        let info = LoaderInitInfo {
            ty: StructureType::LOADER_INIT_INFO_ANDROID_KHR,
            next: std::ptr::null(),
            application_vm: vm,
            application_context: activity,
        };
        // SAFETY: the function is OpenXR's, and its argument begins as every such structure does.
        match unsafe { function((&raw const info).cast()) } {
            result if result.into_raw() >= 0 => Ok(()),
            result => Err(LibraryError::Initialization(result)),
        }
    }
}

/// The struct `XrLoaderInitInfoAndroidKHR`, which the `openxr` crate only defines on Android.
#[repr(C)]
struct LoaderInitInfo {
    ty: StructureType,
    next: *const c_void,
    application_vm: *mut c_void,
    application_context: *mut c_void,
}

/// An opened library. It is never closed: a runtime has threads of its own, and isn't designed to be
/// unloaded.
#[derive(Clone, Copy, Debug)]
pub struct OpenedLibrary {
    initialize: Option<InitializeLoaderKHR>,
    source: FunctionSource,
}

/// The exported function through which a library's functions are found.
#[derive(Clone, Copy, Debug)]
enum FunctionSource {
    Negotiation(NegotiateLoaderRuntimeInterface),
    Export(GetInstanceProcAddr),
}

impl FunctionSource {
    fn address(self) -> usize {
        match self {
            FunctionSource::Negotiation(function) => function as usize,
            FunctionSource::Export(function) => function as usize,
        }
    }
}

/// Equal addresses mean the same library.
impl PartialEq for OpenedLibrary {
    fn eq(&self, other: &Self) -> bool {
        self.source.address() == other.source.address()
    }
}

/// The functions of a library.
#[derive(Clone, Copy, Debug)]
pub enum LibraryFunctions {
    /// A runtime's functions, from the negotiation.
    Runtime(GetInstanceProcAddr),
    /// A loader's functions, from its export.
    Loader(GetInstanceProcAddr),
}

impl RuntimeCalls for LinkedCalls {
    type Library = OpenedLibrary;
    type Functions = LibraryFunctions;
    type Entry = xr::Entry;
    type Error = LibraryError;

    fn open(&mut self, library: &RuntimeLibrary) -> Result<OpenedLibrary, LibraryError> {
        // SAFETY: who made this says that its initialisers may run.
        let opened = unsafe { Library::new(&library.path) };
        let opened = opened.map_err(|error| LibraryError::Open(error.to_string()))?;
        let symbol = library.negotiate_symbol.as_deref();
        let lacks = |name: &str| LibraryError::NoFunction(name.into());
        let source = match symbol {
            // SAFETY: the name stands for this type in every runtime, and another in this.
            Some(name) => unsafe { find_symbol(&opened, name) }
                .map(FunctionSource::Negotiation)
                .ok_or_else(|| lacks(name))?,
            // SAFETY: the name stands for this type in every loader.
            None => unsafe { find_symbol(&opened, PROC_ADDR_FUNCTION) }
                .map(FunctionSource::Export)
                .ok_or_else(|| lacks(PROC_ADDR_FUNCTION))?,
        };
        // SAFETY: the name stands for this type too.
        let initialize = unsafe { find_symbol(&opened, &library.initialize_symbol) };
        std::mem::forget(opened);
        Ok(OpenedLibrary { initialize, source })
    }

    fn initialize_by_export(&mut self, library: &OpenedLibrary) -> Result<bool, LibraryError> {
        let Some(function) = library.initialize else { return Ok(false) };
        self.initialize(function).map(|()| true)
    }

    fn negotiate(&mut self, library: &OpenedLibrary) -> Result<LibraryFunctions, LibraryError> {
        match library.source {
            FunctionSource::Export(function) => Ok(LibraryFunctions::Loader(function)),
            FunctionSource::Negotiation(function) => {
                // SAFETY: it was found in a runtime.
                let functions = unsafe { negotiate_interface(function) };
                functions.map(LibraryFunctions::Runtime).map_err(LibraryError::Refused)
            }
        }
    }

    fn initialize_by_functions(&mut self, functions: LibraryFunctions) -> Result<(), LibraryError> {
        if self.context.is_none() {
            return Ok(());
        }
        let (LibraryFunctions::Runtime(find) | LibraryFunctions::Loader(find)) = functions;
        let (name, mut found) = (c"xrInitializeLoaderKHR", None);
        // SAFETY: no instance is needed for this name, which is a C string; there is room for a function.
        let result = unsafe { find(xr::sys::Instance::NULL, name.as_ptr(), &mut found) };
        if result.into_raw() < 0 {
            // The function is optional: not every runtime needs the activity before an instance is created.
            return Ok(());
        }
        let function = found.ok_or_else(|| LibraryError::NoFunction(INITIALIZE_FUNCTION.into()))?;
        // SAFETY: this is the type that goes with the name.
        let function =
            unsafe { std::mem::transmute::<VoidFunction, InitializeLoaderKHR>(function) };
        self.initialize(function)
    }

    fn make_entry(&mut self, functions: LibraryFunctions) -> Result<xr::Entry, LibraryError> {
        let entry = match functions {
            // SAFETY: its library stays open.
            LibraryFunctions::Runtime(find) => unsafe { make_runtime_entry(find) },
            // SAFETY: its library stays open.
            LibraryFunctions::Loader(find) => unsafe {
                xr::Entry::from_get_instance_proc_addr(find, &())
            },
        };
        entry.map_err(LibraryError::Call)
    }
}

/// # Safety
/// In this library the name stands for a function of type `F`.
unsafe fn find_symbol<F: Copy>(library: &Library, name: &str) -> Option<F> {
    // SAFETY: as the caller says.
    unsafe { library.get::<F>(name.as_bytes()) }.ok().map(|symbol| *symbol)
}
