//! What a loader and a runtime tell each other before the first call.

use std::fmt;

use openxr::sys::pfn::{GetInstanceProcAddr, NegotiateLoaderRuntimeInterface};
use openxr::sys::{NegotiateLoaderInfo, NegotiateRuntimeRequest, Result as XrResult, Version};

/// The one interface between loader and runtime that there is so far.
const INTERFACE: u32 = 1;

/// Why a library is no runtime for this shell.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Refusal {
    /// It wants another interface or version.
    Said(XrResult),
    /// It speaks another interface than it was offered.
    Interface(u32),
    /// It is made for another OpenXR than 1.
    Version(Version),
    /// It gave no functions.
    NoFunctions,
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Refusal::Said(result) => write!(f, "refused OpenXR 1: {result}"),
            Refusal::Interface(number) => {
                write!(f, "speaks loader interface {number}, expected {INTERFACE}")
            }
            Refusal::Version(version) => write!(f, "is made for OpenXR {version}, expected 1"),
            Refusal::NoFunctions => f.write_str("gave no functions"),
        }
    }
}

/// Asks a runtime for its functions: OpenXR 1 of any minor version, by loader interface 1.
///
/// # Errors
/// [`Refusal`].
///
/// # Safety
/// The function is a runtime's `xrNegotiateLoaderRuntimeInterface`.
pub unsafe fn negotiate(
    function: NegotiateLoaderRuntimeInterface,
) -> Result<GetInstanceProcAddr, Refusal> {
    let loader = NegotiateLoaderInfo {
        struct_type: NegotiateLoaderInfo::TYPE,
        struct_version: NegotiateLoaderInfo::VERSION,
        struct_size: size_of::<NegotiateLoaderInfo>(),
        min_interface_version: INTERFACE,
        max_interface_version: INTERFACE,
        min_api_version: Version::new(1, 0, 0),
        max_api_version: Version::new(1, 0x3ff, 0xfff),
    };
    let mut runtime = NegotiateRuntimeRequest {
        struct_type: NegotiateRuntimeRequest::TYPE,
        struct_version: NegotiateRuntimeRequest::VERSION,
        struct_size: size_of::<NegotiateRuntimeRequest>(),
        runtime_interface_version: 0,
        runtime_api_version: Version::new(0, 0, 0),
        get_instance_proc_addr: None,
    };
    // SAFETY: the caller says what it is; both structures are as its pages have them.
    let result = unsafe { function(&raw const loader, &raw mut runtime) };
    if result != XrResult::SUCCESS {
        return Err(Refusal::Said(result));
    }
    if runtime.runtime_interface_version != INTERFACE {
        return Err(Refusal::Interface(runtime.runtime_interface_version));
    }
    if runtime.runtime_api_version.major() != 1 {
        return Err(Refusal::Version(runtime.runtime_api_version));
    }
    runtime.get_instance_proc_addr.ok_or(Refusal::NoFunctions)
}

#[cfg(test)]
mod tests {
    use std::ffi::c_char;
    use std::sync::Mutex;

    use openxr::sys::pfn::VoidFunction;
    use openxr::sys::{Instance, NegotiateLoaderInfo, NegotiateRuntimeRequest, Result as XrResult};
    use openxr::sys::{LoaderInterfaceStructs, Version};

    use super::{Refusal, negotiate};

    /// What the runtime below answers: a result, its interface, its version, whether it has
    /// functions.
    static ANSWER: Mutex<(XrResult, u32, u16, bool)> = Mutex::new((XrResult::SUCCESS, 1, 1, true));

    unsafe extern "system" fn runtime(
        loader: *const NegotiateLoaderInfo,
        request: *mut NegotiateRuntimeRequest,
    ) -> XrResult {
        // SAFETY: the test hands over both.
        let (loader, request) = unsafe { (&*loader, &mut *request) };
        assert_eq!(loader.struct_type, LoaderInterfaceStructs::LOADER_INFO);
        assert_eq!(request.struct_type, LoaderInterfaceStructs::RUNTIME_REQUEST);
        assert_eq!((loader.struct_version, request.struct_version), (1, 1));
        assert_eq!((loader.struct_size, request.struct_size), (40, 40));
        assert_eq!((loader.min_interface_version, loader.max_interface_version), (1, 1));
        assert_eq!(loader.min_api_version, Version::new(1, 0, 0));
        assert!(loader.max_api_version > Version::new(1, 1, 9999));
        let (result, interface, major, functions) = *ANSWER.lock().expect("one test");
        request.runtime_interface_version = interface;
        request.runtime_api_version = Version::new(major, 0, 34);
        request.get_instance_proc_addr = functions.then_some(nothing);
        result
    }

    unsafe extern "system" fn nothing(
        _: Instance,
        _: *const c_char,
        _: *mut Option<VoidFunction>,
    ) -> XrResult {
        XrResult::ERROR_FUNCTION_UNSUPPORTED
    }

    #[test]
    fn a_runtime_of_another_kind_is_refused() {
        let answers = [
            ((XrResult::SUCCESS, 1, 1, true), None),
            (
                (XrResult::ERROR_INITIALIZATION_FAILED, 1, 1, true),
                Some(Refusal::Said(XrResult::ERROR_INITIALIZATION_FAILED)),
            ),
            ((XrResult::SUCCESS, 2, 1, true), Some(Refusal::Interface(2))),
            ((XrResult::SUCCESS, 1, 2, true), Some(Refusal::Version(Version::new(2, 0, 34)))),
            ((XrResult::SUCCESS, 1, 1, false), Some(Refusal::NoFunctions)),
        ];
        for (answer, refusal) in answers {
            *ANSWER.lock().expect("one test") = answer;
            // SAFETY: it does what a runtime's does.
            assert_eq!(unsafe { negotiate(runtime) }.err(), refusal);
        }
        assert_eq!(Refusal::Interface(2).to_string(), "speaks loader interface 2, expected 1");
    }
}
