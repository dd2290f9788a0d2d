//! A visit's sculpture whose files the program's end cut off: they are made again at the next start.

use std::path::{Path, PathBuf};

use paros_core::limits::INTERVALS;
use paros_core::session::SessionState;
use paros_core::visit::VisitPhase;
use paros_core::volume::{Grid, Size};

use super::Studio;
use crate::statics::Resident;
use crate::{durable, rmap};

/// How many of a folder's newest sculptures are looked through for the one in the world: a visit's is the last.
const NEWEST: usize = 3;

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Makes the files of a visit's finished sculpture, unless they are there. In a session that is no visit's the
    /// visitor has it carved on, or finished again.
    pub(super) fn export_what_was_cut_off(&mut self) {
        let world = &*self.session.world;
        if world.visit().phase() == VisitPhase::Closed
            || world.session_state() != SessionState::Finished
        {
            return;
        }
        let volume = rmap::encode(world.volume().maps());
        let folders = [&self.paths.sculptures, &self.paths.sessions];
        let print = folders.into_iter().find_map(|folder| find_print_of(folder, &volume));
        match print {
            Some(print) => self.export.set_session_stl_path(Some(print)),
            None => self.export.begin_anew(world),
        }
    }

    /// Whether the files of a sculpture are still being made that isn't in the world any more: until the writer has them
    /// its save is all that there is of it on the disk, and no other takes its place.
    pub(super) fn is_printing_another(&self) -> bool {
        self.export.is_making_files() && self.world().session_state() != SessionState::Finished
    }
}

/// The print beside the volume of these bytes, among a folder's newest.
fn find_print_of(folder: &Path, volume: &[u8]) -> Option<PathBuf> {
    let is_volume = |path: &PathBuf| path.extension().is_some_and(|end| end == "rmap");
    let entries = folder.read_dir().ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut volumes: Vec<_> = entries.filter(is_volume).collect();
    // By length first: 1000 comes after 999.
    volumes.sort_by_key(|path| std::cmp::Reverse((path.as_os_str().len(), path.clone())));
    let same = volumes
        .into_iter()
        .take(NEWEST)
        .find(|path| durable::read_regular_file(path).is_ok_and(|bytes| bytes == volume));
    same.map(|path| path.with_extension("stl")).filter(|print| print.exists())
}

#[cfg(test)]
mod tests;
