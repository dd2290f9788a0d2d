//! The path of the trace file, checked for writing before recording begins.

use std::path::{Path, PathBuf};

use super::{FILE_NAME, LoadedSettings, Settings};
use crate::durable::WriteTarget;

impl Settings {
    /// Returns an error text if a trace is set and the package has figures of the operator's own: a trace
    /// holds no figures, so it could not be replayed.
    #[must_use]
    pub fn find_contradiction(&self, own_figures: &[String]) -> Option<String> {
        let record = self.record.as_ref().filter(|_| !own_figures.is_empty())?;
        let (record, names) = (record.display(), own_figures.join(", "));
        Some(format!(
            "{record}: a trace beside figures of one's own ({names}) can't be played, expected one or the other"
        ))
    }
}

impl LoadedSettings {
    /// Resolves the trace's path against a folder, and checks at once, not after the session, that the file
    /// can be written. Recording is disabled, with a fault, if the file can't be written, is the settings
    /// file, or if [`Settings::find_contradiction`] returns an error.
    pub fn resolve_record(&mut self, folder: &Path, own_figures: &[String]) {
        let contradiction = self.settings.find_contradiction(own_figures);
        let Some(record) = self.settings.record.take() else { return };
        let path = folder.join(record);
        match contradiction.map_or_else(|| check_record(folder, &path), Err) {
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
