//! Runtime manifest files: the result is an error of one line, or a library path and the negotiation
//! function's name.

use std::path::Path;

use paros_headset::runtime::{NEGOTIATE_FUNCTION, parse_manifest};

use crate::engine::FuzzTarget;

/// A file that doesn't exist; a relative library path is resolved against its folder.
const FILE: &str = "/no/such/folder/active_runtime.json";

pub(super) const MANIFEST: FuzzTarget = FuzzTarget {
    name: "manifest",
    seeds,
    words: &[
        b"\"file_format_version\"",
        b"\"1.0.0\"",
        b"\"runtime\"",
        b"\"library_path\"",
        b"\"functions\"",
        b"\"xrNegotiateLoaderRuntimeInterface\"",
        b"\"xrInitializeLoaderKHR\"",
        b"\\u0000",
        b"../",
        b"{",
        b"}",
        b"[",
        b"null",
    ],
    longest: 1024,
    runs: 8000,
    run: |bytes| match parse_manifest(Path::new(FILE), bytes) {
        Err(why) => {
            assert_eq!(why.lines().count(), 1, "{why:?}");
            why.split(|letter: char| letter.is_ascii_digit()).next().unwrap_or_default().into()
        }
        Ok(library) => {
            let text = library.path.to_str().expect("JSON is text");
            assert!(library.path.is_absolute() || !text.contains('/'), "{text:?}");
            let negotiate = library.negotiate_symbol.expect("it is no loader");
            format!("a library; renamed: {}", negotiate != NEGOTIATE_FUNCTION)
        }
    },
};

fn seeds() -> Vec<Vec<u8>> {
    let texts = [
        r#"{"file_format_version": "1.0.0", "runtime": {"library_path": "libopenxr_maker.so"}}"#,
        r#"{"file_format_version": "1.0.0", "runtime": {"name": "Maker's", "library_path":
            "../../../lib64/libmaker.so", "functions": {"xrNegotiateLoaderRuntimeInterface":
            "maker_negotiate", "xrInitializeLoaderKHR": "maker_initialize"}}}"#,
        r#"{"file_format_version": "2.0.0", "runtime": {}}"#,
        "[[[[]]]]",
    ];
    texts.map(|text| text.as_bytes().to_vec()).into()
}
