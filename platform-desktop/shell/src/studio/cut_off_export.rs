//! Recovery of an interrupted export: if the program ended before the files of a visit's sculpture were
//! written, they are made again at the next start.

use std::path::{Path, PathBuf};

use paros_core::limits::INTERVALS;
use paros_core::session::SessionState;
use paros_core::visit::VisitPhase;
use paros_core::volume::{Grid, Size};

use super::Studio;
use super::files::SCULPTURE_STEM;
use crate::statics::Resident;
use crate::{durable, rmap};

/// The number of a folder's newest sculptures that are compared with the one in the world: a visit's
/// sculpture is the last one.
const NEWEST: usize = 3;

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Makes the files of a visit's finished sculpture, unless they exist. Outside visits the visitor can
    /// continue the sculpture, or finish it again.
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

    /// Returns `true` if the files of a sculpture that has left the world are still being made, or its
    /// receiver hasn't kept it yet. Until then its save is its only copy on the disk, and must not be
    /// replaced.
    pub(super) fn is_printing_another(&self) -> bool {
        (self.export.is_making_files() || self.is_receiver_keeping())
            && self.world().session_state() != SessionState::Finished
    }
}

/// Returns the print beside the volume with these bytes, if it is among a folder's newest sculptures, those
/// with the highest numbers. Other files of the user are ignored.
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

/// Returns the number of a sculpture's volume file, such as `sculpture-1000.rmap`.
fn numbered_volume(path: &Path) -> Option<u32> {
    let name = path.file_name()?.to_str()?;
    let number = name.strip_prefix(SCULPTURE_STEM)?.strip_prefix('-')?.strip_suffix(".rmap")?;
    let is_digits = number.bytes().all(|byte| byte.is_ascii_digit());
    number.parse().ok().filter(|_| is_digits)
}

#[cfg(test)]
mod tests;
