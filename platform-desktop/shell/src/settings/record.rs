//! The file of a trace, which is tried before there is anything to record.

use std::path::{Path, PathBuf};

use super::{FILE_NAME, LoadedSettings, Settings};
use crate::durable::WriteTarget;

impl Settings {
    /// What of the settings contradicts the figures of a package: a trace holds no figures, so none with figures of
    /// the operator's own could be played.
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
    /// Puts the trace's file into a folder, unless its path is absolute, and tries whether it can be written: now, not
    /// after the sculpting. Nothing is recorded where it can't; the file of settings isn't overwritten, and
    /// what [`Settings::find_contradiction`] tells is no trace.
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
