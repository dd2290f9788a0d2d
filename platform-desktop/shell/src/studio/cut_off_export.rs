//! A visit's sculpture whose files the program's end cut off: they are made again at the next start.

use std::path::{Path, PathBuf};

use paros_core::limits::INTERVALS;
use paros_core::session::SessionState;
use paros_core::visit::VisitPhase;
use paros_core::volume::{Grid, Size};

use super::Studio;
use super::files::SCULPTURE_STEM;
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
    /// its save is all that there is of it on the disk, and no other takes its place. So it is until its receiver has kept it.
    pub(super) fn is_printing_another(&self) -> bool {
        (self.export.is_making_files() || self.is_receiver_keeping())
            && self.world().session_state() != SessionState::Finished
    }
}

/// The print beside the volume of these bytes, among a folder's newest: those of the highest numbers. What else a user
/// keeps there doesn't count.
fn find_print_of(folder: &Path, volume: &[u8]) -> Option<PathBuf> {
    let entries = folder.read_dir().ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    let mut volumes: Vec<_> =
        entries.filter_map(|path| Some((numbered_volume(&path)?, path))).collect();
    volumes.sort_by_key(|(number, _)| std::cmp::Reverse(*number));
    let same = volumes
        .into_iter()
        .map(|(_, path)| path)
        .take(NEWEST)
        .find(|path| durable::read_regular_file(path).is_ok_and(|bytes| bytes == volume));
    same.map(|path| path.with_extension("stl")).filter(|print| print.exists())
}

/// The number of a sculpture's volume, as `sculpture-1000.rmap` has it.
fn numbered_volume(path: &Path) -> Option<u32> {
    let name = path.file_name()?.to_str()?;
    let number = name.strip_prefix(SCULPTURE_STEM)?.strip_prefix('-')?.strip_suffix(".rmap")?;
    let is_digits = number.bytes().all(|byte| byte.is_ascii_digit());
    number.parse().ok().filter(|_| is_digits)
}

#[cfg(test)]
mod tests;
