//! The folder through which a test and the layer talk: the layer appends to `log`, and reads what other
//! files ask for.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

/// The folder that `PAROS_LAYER` names.
pub(crate) fn layer_folder() -> PathBuf {
    std::env::var_os("PAROS_LAYER").unwrap_or_default().into()
}

/// Appends a line to the log.
pub(crate) fn log_line(text: &str) {
    let path = layer_folder().join("log");
    if let Ok(mut log) = fs::OpenOptions::new().append(true).create(true).open(path) {
        // The test misses the line.
        let _ = writeln!(log, "{text}");
    }
}
