//! The sculpture before: what was left unfinished for another start, and can be had back.

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

/// Reads the save of the session before, as an earlier run left it.
pub(super) fn read_save_before<const N: usize>(paths: &StudioPaths) -> Option<Vec<u8>> {
    durable::read_regular_file(&paths.left_unfinished_session_file(N)).ok()
}

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Whether another start would leave a sculpture: one that is unfinished, and was worked on.
    #[must_use]
    pub fn has_unfinished_sculpture(&self) -> bool {
        let world = self.world();
        // What nobody carves, for those who look, is nobody's.
        world.session_state() == SessionState::Sculpting
            && world.visit().phase() != VisitPhase::Attract
            && world.undo_counts() != UndoCounts::default()
    }

    /// Whether there is a sculpture before this one to be had back.
    #[must_use]
    pub const fn has_one_before(&self) -> bool {
        self.one_before.is_some()
    }

    /// Exchanges the sculpture before this one for this one, which becomes the one before if it is
    /// unfinished. Returns whether the world is another now.
    pub fn bring_back_the_one_before(&mut self) -> bool {
        let Some(before) = self.one_before.take() else { return false };
        let leaves_a_sculpture = self.has_unfinished_sculpture();
        // Its buffer is back then, and the save of what comes back is written before the other's is
        // replaced: at no time is either in no file.
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

    /// Keeps the save of a session that is left, here and in its file.
    pub(super) fn keep_as_the_one_before(&mut self, save: Vec<u8>) {
        self.file_writer.submit_file_or_wait(
            FileKind::PreviousSession,
            self.paths.left_unfinished_session_file(N),
            save.clone(),
        );
        self.one_before = Some(save);
    }
}
