//! The negotiation of interface versions between loader and runtime, before the first call.

use openxr::sys::pfn::{GetInstanceProcAddr, NegotiateLoaderRuntimeInterface};
use openxr::sys::{NegotiateLoaderInfo, NegotiateRuntimeRequest, Result as XrResult, Version};

/// The only version of the interface between loader and runtime that exists so far.
const INTERFACE_VERSION: u32 = 1;

/// The reason why a negotiation failed.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
pub enum NegotiationError {
    /// The runtime returned this result: it needs another interface or version.
    #[error("refused OpenXR 1: {0}")]
    Result(XrResult),
    /// The runtime chose an interface version that it was not offered.
    #[error("speaks loader interface {0}, expected {expected}", expected = INTERFACE_VERSION)]
    Interface(u32),
    /// The runtime implements another major version of OpenXR.
    #[error("is made for OpenXR {0}, expected 1")]
    Version(Version),
    /// The runtime returned no functions.
    #[error("gave no functions")]
    NoFunctions,
}

/// Negotiates with a runtime for OpenXR 1 of any minor version. Returns its `xrGetInstanceProcAddr`.
///
/// # Errors
/// [`NegotiationError`].
///
/// # Safety
/// `function` is a runtime's `xrNegotiateLoaderRuntimeInterface`.
pub unsafe fn negotiate_interface(
    function: NegotiateLoaderRuntimeInterface,
) -> Result<GetInstanceProcAddr, NegotiationError> {
    let loader = NegotiateLoaderInfo {
        struct_type: NegotiateLoaderInfo::TYPE,
        struct_version: NegotiateLoaderInfo::VERSION,
        struct_size: size_of::<NegotiateLoaderInfo>(),
        min_interface_version: INTERFACE_VERSION,
        max_interface_version: INTERFACE_VERSION,
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
        return Err(NegotiationError::Result(result));
    }
    if runtime.runtime_interface_version != INTERFACE_VERSION {
        return Err(NegotiationError::Interface(runtime.runtime_interface_version));
    }
    if runtime.runtime_api_version.major() != 1 {
        return Err(NegotiationError::Version(runtime.runtime_api_version));
    }
    runtime.get_instance_proc_addr.ok_or(NegotiationError::NoFunctions)
}

#[cfg(test)]
mod tests {
    use std::ffi::c_char;
    use std::sync::Mutex;

    use openxr::sys::pfn::VoidFunction;
    use openxr::sys::{Instance, NegotiateLoaderInfo, NegotiateRuntimeRequest, Result as XrResult};
    use openxr::sys::{LoaderInterfaceStructs, Version};

    use super::{NegotiationError, negotiate_interface};

    /// The answer of the runtime below: its result, interface version and major version of OpenXR, and `true`
    /// if it returns functions.
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
                Some(NegotiationError::Result(XrResult::ERROR_INITIALIZATION_FAILED)),
            ),
            ((XrResult::SUCCESS, 2, 1, true), Some(NegotiationError::Interface(2))),
            (
                (XrResult::SUCCESS, 1, 2, true),
                Some(NegotiationError::Version(Version::new(2, 0, 34))),
            ),
            ((XrResult::SUCCESS, 1, 1, false), Some(NegotiationError::NoFunctions)),
        ];
        for (answer, refusal) in answers {
            *ANSWER.lock().expect("one test") = answer;
            // SAFETY: it does what a runtime's does.
            assert_eq!(unsafe { negotiate_interface(runtime) }.err(), refusal);
        }
        assert_eq!(
            NegotiationError::Interface(2).to_string(),
            "speaks loader interface 2, expected 1"
        );
    }
}
