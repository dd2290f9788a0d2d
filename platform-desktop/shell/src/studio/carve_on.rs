//! Continuation of a finished sculpture: it returns to its state before the finish, with its figure and its
//! undo history.

use paros_core::TickInput;
use paros_core::limits::INTERVALS;
use paros_core::session::{SessionMode, SessionState, commands};
use paros_core::volume::{Grid, Size};

use super::session::LiveSession;
use super::{SessionToStart, Studio};
use crate::statics::Resident;

/// The way in which a finished sculpture is continued.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CarvingOn {
    /// The session continues from its state before the finish.
    GoesOn,
    /// The sculpture was finished in an earlier run, without such a state: a new session starts from its
    /// stone.
    Starts(SessionToStart),
}

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Continues a finished sculpture. Its print and picture are kept.
    pub fn carve_on(&mut self) -> CarvingOn {
        let before = self.before_finish.take();
        if before.is_some_and(|save| self.session.load_or_keep(&save).is_ok()) {
            self.forget_session_before();
            self.save_session();
            return CarvingOn::GoesOn;
        }
        let LiveSession { world, volumes, .. } = &mut self.session;
        volumes.offer_visitor_volume().copy_from(world.volume().maps());
        CarvingOn::Starts(SessionToStart { mode: SessionMode::Own })
    }

    /// Keeps the save of a sculpture if a tick's input is about to finish it.
    pub(super) fn keep_before_finish(&mut self, input: &TickInput) {
        if input.commands & commands::FINISH != 0
            && self.world().session_state() == SessionState::Sculpting
        {
            self.before_finish = Some(self.session.encode());
        }
    }
}
