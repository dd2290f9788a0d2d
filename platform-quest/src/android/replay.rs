//! A C interface to [`paros_shell::replay`], for a program that has loaded this library.

use std::ffi::{CStr, OsStr, c_char, c_int};
use std::os::unix::ffi::OsStrExt;
use std::path::Path;

use paros_shell::replay::write_replay_digests;

/// Replays the trace at the first path and writes its digests to the second. Returns 0, or 1 after an error
/// message on standard error.
///
/// # Safety
/// Both are C strings.
#[unsafe(no_mangle)]
unsafe extern "C" fn paros_replay(
    trace_path: *const c_char,
    digests_out_path: *const c_char,
) -> c_int {
    // SAFETY: the caller hands over two C strings, which outlive this call.
    let [trace_path, digests_out_path] = [trace_path, digests_out_path]
        .map(|path| unsafe { CStr::from_ptr(path) }.to_bytes())
        .map(OsStr::from_bytes);
    match write_replay_digests(Path::new(trace_path), Path::new(digests_out_path)) {
        Ok(()) => 0,
        Err(error) => {
            eprintln!("{error}");
            1
        }
    }
}
