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

/// For how long before that a visitor is told.
const TOLD_FOR: Duration = Duration::from_secs(20);

/// The same, of the start that takes a finished sculpture's place.
const START_TOLD_FOR: Duration = Duration::from_secs(10);

/// Time after a visitor has gone in which the finished sculpture is shown.
const SHOWN_FOR: Duration = Duration::from_secs(20);

/// For how long there was no input. Without a kiosk it isn't looked at.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct KioskWatch {
    /// Whether the window is one of a kiosk.
    pub(super) is_on: bool,
    /// Time without input after which a visitor has gone.
    gone_after: Duration,
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
    /// A watch; without a kiosk `gone_after` is none.
    pub(super) fn new(gone_after: Option<Duration>) -> Self {
        let is_on = gone_after.is_some();
        KioskWatch { is_on, gone_after: gone_after.unwrap_or_default(), idle: Duration::ZERO }
    }

    /// The whole of the monitor that the window is on, in a kiosk.
    pub(super) fn full_screen(&self) -> Option<Fullscreen> {
        self.is_on.then_some(Fullscreen::Borderless(None))
    }

    /// Notes an event of the window. Whether somebody uses it.
    pub(super) const fn note_event(&mut self, event: &WindowEvent) -> bool {
        let is_use = matches!(
            event,
            WindowEvent::CursorMoved { .. }
                | WindowEvent::MouseInput { .. }
                | WindowEvent::MouseWheel { .. }
                | WindowEvent::KeyboardInput { .. }
                | WindowEvent::Touch(_)
        );
        if is_use {
            self.idle = Duration::ZERO;
        }
        is_use
    }

    /// Whether a key's command is for visitors: no developer's tools in a kiosk.
    pub(super) const fn allows(&self, command: KeyCommand) -> bool {
        !self.is_on || !matches!(command, KeyCommand::Graph | KeyCommand::Path | KeyCommand::Record)
    }

    /// Seconds until a sculpture is finished for whoever left it, or a finished one makes room for the start, once the
    /// visitor is to be told.
    pub(super) fn seconds_to_handover(&self, session: SessionState) -> Option<u32> {
        let (due_after, told_for) = match session {
            SessionState::Waiting => return None,
            SessionState::Sculpting => (self.gone_after, TOLD_FOR),
            SessionState::Finished => (self.gone_after + SHOWN_FOR, START_TOLD_FOR),
        };
        let left = due_after.checked_sub(self.idle)?;
        let is_told = self.is_on && left <= told_for;
        is_told.then_some(left.as_secs_f32().ceil() as u32)
    }

    /// Takes the time since the last frame in, and says what is due in a session of this phase, in which something
    /// was sculpted or nothing.
    fn advance(&mut self, elapsed: Duration, session: SessionState, is_sculpted: bool) -> Handover {
        self.idle = self.idle.saturating_add(elapsed);
        if !self.is_on || self.idle < self.gone_after {
            return Handover::Nothing;
        }
        match session {
            SessionState::Sculpting if is_sculpted => Handover::Finish,
            SessionState::Finished if self.idle < self.gone_after + SHOWN_FOR => Handover::Nothing,
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
        if self.visits.is_some() {
            // Visits have a clock of their own.
            return;
        }
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

    const KIOSK: Option<Duration> = Some(Duration::from_secs(90));

    #[test]
    fn what_a_visitor_left_is_finished_and_shown_before_the_next_start() {
        let second = Duration::from_secs(1);
        let mut watch = KioskWatch::new(KIOSK);
        for _ in 0..89 {
            assert_eq!(watch.advance(second, Sculpting, true), Handover::Nothing);
        }
        assert_eq!(watch.advance(second, Sculpting, true), Handover::Finish);
        assert_eq!(watch.advance(19 * second, Finished, true), Handover::Nothing);
        assert_eq!(watch.advance(second, Finished, true), Handover::ShowStart);
        let mut watch = KioskWatch::new(KIOSK);
        assert_eq!(watch.advance(90 * second, Sculpting, false), Handover::ShowStart);
        assert_eq!(watch.advance(second, Waiting, false), Handover::ShowStart);
        let mut watch = KioskWatch::new(None);
        assert_eq!(watch.advance(900 * second, Sculpting, true), Handover::Nothing);
    }

    #[test]
    fn a_visitor_is_told_before_the_sculpture_is_finished_and_before_the_next_start() {
        let second = Duration::from_secs(1);
        let mut watch = KioskWatch::new(KIOSK);
        watch.advance(69 * second, Sculpting, true);
        assert_eq!(watch.seconds_to_handover(Sculpting), None);
        watch.advance(second, Sculpting, true);
        assert_eq!(watch.seconds_to_handover(Sculpting), Some(20));
        assert_eq!(watch.seconds_to_handover(Finished), None, "it is shown for a while");
        watch.advance(Duration::from_millis(19_500), Sculpting, true);
        assert_eq!(watch.seconds_to_handover(Sculpting), Some(1));
        assert_eq!(watch.seconds_to_handover(Waiting), None, "there is nothing to lose");
        watch.advance(Duration::from_millis(10_500), Finished, true);
        assert_eq!(watch.seconds_to_handover(Finished), Some(10), "before the start");
        watch.advance(10 * second, Finished, true);
        assert_eq!(watch.seconds_to_handover(Finished), Some(0));
        watch.advance(second, Finished, true);
        assert_eq!(watch.seconds_to_handover(Finished), None, "it is the next one's turn");
        let mut window = KioskWatch::new(None);
        window.advance(80 * second, Sculpting, true);
        assert_eq!(
            window.seconds_to_handover(Sculpting),
            None,
            "nobody waits for a window at home"
        );
    }

    #[test]
    fn a_kiosk_waits_as_long_as_its_settings_say() {
        let second = Duration::from_secs(1);
        let mut watch = KioskWatch::new(Some(30 * second));
        assert_eq!(watch.advance(29 * second, Sculpting, true), Handover::Nothing);
        assert_eq!(watch.seconds_to_handover(Sculpting), Some(1));
        assert_eq!(watch.advance(second, Sculpting, true), Handover::Finish);
        assert_eq!(watch.advance(20 * second, Finished, true), Handover::ShowStart);
    }

    #[test]
    fn developers_keys_are_for_developers() {
        let keys = [KeyCommand::Record, KeyCommand::Graph, KeyCommand::Path, KeyCommand::Help];
        assert_eq!(keys.map(|key| KioskWatch::new(KIOSK).allows(key)), [false, false, false, true]);
        assert!(keys.into_iter().all(|key| KioskWatch::new(None).allows(key)));
    }
}
