//! The folder for the communication between a test and the layer: the layer appends to `log`, and reads
//! requests from other files.

use std::fs;
use std::io::Write;
use std::path::PathBuf;

/// Returns the folder that `PAROS_LAYER` names.
pub(crate) fn layer_folder() -> PathBuf {
    std::env::var_os("PAROS_LAYER").unwrap_or_default().into()
}

/// Appends a line to the log.
pub(crate) fn log_line(text: &str) {
    let path = layer_folder().join("log");
    if let Ok(mut log) = fs::OpenOptions::new().append(true).create(true).open(path) {
        // If the write fails, the test notices the missing line.
        let _ = writeln!(log, "{text}");
    }
}
