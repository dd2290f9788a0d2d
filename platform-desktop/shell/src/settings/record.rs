//! The file of a trace, which is tried before there is anything to record.

use std::path::{Path, PathBuf};

use super::{FILE_NAME, LoadedSettings};
use crate::durable::WriteTarget;

impl LoadedSettings {
    /// Puts the trace's file into a folder, unless its path is absolute, and tries whether it can be written: now, not
    /// after the sculpting. Nothing is recorded where it can't; the file of settings isn't overwritten.
    pub fn resolve_record(&mut self, folder: &Path) {
        let Some(record) = self.settings.record.take() else { return };
        let path = folder.join(record);
        match check_record(folder, &path) {
            Ok(()) => self.settings.record = Some(path),
            Err(why) => self.faults.push(format!("record: {why}; nothing is recorded")),
        }
    }
}

fn check_record(folder: &Path, record: &Path) -> Result<(), String> {
    let own: Option<PathBuf> = folder.join(FILE_NAME).canonicalize().ok();
    if own.is_some() && record.canonicalize().ok() == own {
        return Err(format!("{}: it is the file of settings, expected another", record.display()));
    }
    WriteTarget::resolve_and_check_writable(record).map(drop).map_err(|error| error.to_string())
}
