//! A window that many visitors use, one after the other: who comes finds a start, not what somebody left.

use std::time::Duration;

use paros_core::limits::INTERVALS;
use paros_core::session::{SessionState, commands};
use paros_core::volume::{Grid, Size};
use paros_shell::statics::Resident;
use winit::event::WindowEvent;
use winit::window::Fullscreen;

use super::App;
use crate::window::keys::KeyCommand;

/// Time without input after which a visitor has gone.
const GONE_AFTER: Duration = Duration::from_secs(90);

/// Time after that in which the finished sculpture is shown.
const SHOWN_FOR: Duration = Duration::from_secs(20);

/// For how long there was no input. Without a kiosk it isn't looked at.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct KioskWatch {
    /// Whether the window is one of a kiosk.
    pub(super) is_on: bool,
    idle: Duration,
}

/// What becomes of a sculpture whose visitor has gone.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Handover {
    /// Nothing yet, or nothing more.
    Nothing,
    /// It is finished, and so printed and kept.
    Finish,
    /// The next visitor's start is shown.
    ShowStart,
}

impl KioskWatch {
    pub(super) const fn new(is_on: bool) -> Self {
        KioskWatch { is_on, idle: Duration::ZERO }
    }

    /// The whole of the monitor that the window is on, in a kiosk.
    pub(super) fn full_screen(&self) -> Option<Fullscreen> {
        self.is_on.then_some(Fullscreen::Borderless(None))
    }

    /// Notes an event of the window.
    pub(super) const fn note_event(&mut self, event: &WindowEvent) {
        if matches!(
            event,
            WindowEvent::CursorMoved { .. }
                | WindowEvent::MouseInput { .. }
                | WindowEvent::MouseWheel { .. }
                | WindowEvent::KeyboardInput { .. }
                | WindowEvent::Touch(_)
        ) {
            self.idle = Duration::ZERO;
        }
    }

    /// Whether a key's command is for visitors: no developer's tools in a kiosk.
    pub(super) const fn allows(&self, command: KeyCommand) -> bool {
        !self.is_on || !matches!(command, KeyCommand::Graph | KeyCommand::Path | KeyCommand::Record)
    }

    /// Takes the time since the last frame in, and says what is due in a session of this phase, in which something
    /// was sculpted or nothing.
    fn advance(&mut self, elapsed: Duration, session: SessionState, is_sculpted: bool) -> Handover {
        self.idle = self.idle.saturating_add(elapsed);
        if !self.is_on || self.idle < GONE_AFTER {
            return Handover::Nothing;
        }
        match session {
            SessionState::Sculpting if is_sculpted => Handover::Finish,
            SessionState::Finished if self.idle < GONE_AFTER + SHOWN_FOR => Handover::Nothing,
            _ => Handover::ShowStart,
        }
    }
}

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Hands the window over to the next visitor once this one has gone.
    pub(super) fn hand_over_if_gone(&mut self, elapsed: Duration) {
        let world = self.studio.world();
        let is_sculpted = world.undo_counts().undoable > 0;
        match self.kiosk.advance(elapsed, world.session_state(), is_sculpted) {
            Handover::Nothing => {}
            Handover::Finish => self.hands.queue_commands(commands::FINISH),
            Handover::ShowStart => self.panels.show_start_alone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use paros_core::session::SessionState::{Finished, Sculpting, Waiting};

    use super::{Handover, KioskWatch};
    use crate::window::keys::KeyCommand;

    #[test]
    fn what_a_visitor_left_is_finished_and_shown_before_the_next_start() {
        let second = Duration::from_secs(1);
        let mut watch = KioskWatch::new(true);
        for _ in 0..89 {
            assert_eq!(watch.advance(second, Sculpting, true), Handover::Nothing);
        }
        assert_eq!(watch.advance(second, Sculpting, true), Handover::Finish);
        assert_eq!(watch.advance(19 * second, Finished, true), Handover::Nothing);
        assert_eq!(watch.advance(second, Finished, true), Handover::ShowStart);
        let mut watch = KioskWatch::new(true);
        assert_eq!(watch.advance(90 * second, Sculpting, false), Handover::ShowStart);
        assert_eq!(watch.advance(second, Waiting, false), Handover::ShowStart);
        let mut watch = KioskWatch::new(false);
        assert_eq!(watch.advance(900 * second, Sculpting, true), Handover::Nothing);
    }

    #[test]
    fn developers_keys_are_for_developers() {
        let keys = [KeyCommand::Record, KeyCommand::Graph, KeyCommand::Path, KeyCommand::Help];
        assert_eq!(keys.map(|key| KioskWatch::new(true).allows(key)), [false, false, false, true]);
        assert!(keys.into_iter().all(|key| KioskWatch::new(false).allows(key)));
    }
}
