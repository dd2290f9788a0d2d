//! The previous sculpture, which was left unfinished when another session started, and can be restored.

use paros_core::edit::UndoCounts;
use paros_core::limits::INTERVALS;
use paros_core::session::SessionState;
use paros_core::visit::VisitPhase;
use paros_core::volume::{Grid, Size};

use super::{Notice, Studio};
use crate::durable;
use crate::file_writer::FileKind;
use crate::statics::Resident;
use crate::studio_paths::StudioPaths;

/// Reads the save of the previous session that an earlier run left.
pub(super) fn read_save_before<const N: usize>(paths: &StudioPaths) -> Option<Vec<u8>> {
    durable::read_regular_file(&paths.left_unfinished_session_file(N)).ok()
}

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Returns `true` if a new session would leave the current sculpture unfinished: it is not finished, and
    /// was worked on.
    #[must_use]
    pub fn has_unfinished_sculpture(&self) -> bool {
        let world = self.world();
        // The attract screen's sculpture belongs to no visitor.
        world.session_state() == SessionState::Sculpting
            && world.visit().phase() != VisitPhase::Attract
            && world.undo_counts() != UndoCounts::default()
    }

    /// Returns `true` if a previous sculpture can be restored.
    #[must_use]
    pub const fn has_one_before(&self) -> bool {
        self.one_before.is_some()
    }

    /// Restores the previous sculpture. The current one, if it is unfinished, becomes the previous one.
    /// Returns `true` if the world was reloaded.
    pub fn bring_back_the_one_before(&mut self) -> bool {
        let Some(before) = self.one_before.take() else { return false };
        let leaves_a_sculpture = self.has_unfinished_sculpture();
        // Then the save's buffer is back, and the restored sculpture's save is written before the file of the
        // other one is replaced: each sculpture is in a file at all times.
        let _ = self.wait_for_writes();
        let current = match self.session.load_or_keep(&before) {
            Ok(current) => current,
            Err(bad) => {
                let text = format!("the sculpture before can't be read: {bad}");
                self.push_notice(Notice::Bad(text));
                return true;
            }
        };
        self.forget_session_before();
        self.save_session();
        if leaves_a_sculpture {
            self.keep_as_the_one_before(current);
        }
        true
    }

    /// Keeps the save of a session as the previous one, in memory and in its file.
    pub(super) fn keep_as_the_one_before(&mut self, save: Vec<u8>) {
        self.file_writer.submit_file_or_wait(
            FileKind::PreviousSession,
            self.paths.left_unfinished_session_file(N),
            save.clone(),
        );
        self.one_before = Some(save);
    }
}
