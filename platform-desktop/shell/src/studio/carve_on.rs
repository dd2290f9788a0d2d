//! Carving on after the end: a finished sculpture becomes what it was before, with its figure and its strokes to undo.

use paros_core::TickInput;
use paros_core::limits::INTERVALS;
use paros_core::session::{SessionMode, SessionState, commands};
use paros_core::volume::{Grid, Size};

use super::session::LiveSession;
use super::{SessionToStart, Studio};
use crate::statics::Resident;

/// How a finished sculpture is carved on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum CarvingOn {
    /// The session goes on as it was before its end.
    GoesOn,
    /// It was finished in an earlier run: a session starts from its stone.
    Starts(SessionToStart),
}

impl<const N: usize> Studio<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Goes on with a finished sculpture. What was made of it, its print and picture, stays.
    pub fn carve_on(&mut self) -> CarvingOn {
        let before = self.before_finish.take();
        if before.is_some_and(|save| self.session.world.load(&save).is_ok()) {
            self.recorder.discard_recording();
            self.export.set_session_stl_path(None);
            self.autosave.restart_save_interval();
            self.save_session();
            return CarvingOn::GoesOn;
        }
        let LiveSession { world, volumes, .. } = &mut self.session;
        volumes.offer_visitor_volume().copy_from(world.volume().maps());
        CarvingOn::Starts(SessionToStart { mode: SessionMode::Own })
    }

    /// Keeps the save of a sculpture that a tick's input finishes, and none of one that it leaves.
    pub(super) fn keep_before_finish(&mut self, input: &TickInput) {
        if input.start != SessionMode::None {
            self.before_finish = None;
        } else if input.commands & commands::FINISH != 0
            && self.world().session_state() == SessionState::Sculpting
        {
            let mut save = Vec::new();
            self.session.encode_into(&mut save);
            self.before_finish = Some(save);
        }
    }
}
