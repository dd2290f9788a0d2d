//! Kiosk mode: many visitors use the window in turn. Each finds the start panel, not the last visitor's
//! sculpture.

use std::time::Duration;

use paros_core::limits::INTERVALS;
use paros_core::session::{SessionState, commands};
use paros_core::volume::{Grid, Size};
use paros_shell::statics::Resident;
use winit::window::Fullscreen;

use super::App;
use crate::window::keys::KeyCommand;

/// Length of the countdown before an abandoned sculpture is finished.
const TOLD_FOR: Duration = Duration::from_secs(20);

/// Length of the countdown before the start panel replaces a finished sculpture.
const START_TOLD_FOR: Duration = Duration::from_secs(10);

/// Additional time for which a finished sculpture is shown after its visitor has left.
const SHOWN_FOR: Duration = Duration::from_secs(20);

/// Rules of the kiosk: which keys are refused, and when the window is handed over. Without a kiosk there are
/// no restrictions.
#[derive(Clone, Copy, PartialEq, Debug)]
pub(super) struct Kiosk {
    /// `true` in kiosk mode.
    pub(super) is_on: bool,
    /// Idle time after which a visitor counts as gone; `None` without a kiosk, or if visits do the handover.
    gone_after: Option<Duration>,
}

impl Kiosk {
    /// Returns the rules of a window. `gone_after` is `None` without a kiosk.
    pub(super) fn new(gone_after: Option<Duration>, has_visits: bool) -> Self {
        Kiosk { is_on: gone_after.is_some(), gone_after: gone_after.filter(|_| !has_visits) }
    }

    /// Returns borderless full screen on the window's monitor in a kiosk, else `None`.
    pub(super) fn full_screen(&self) -> Option<Fullscreen> {
        self.is_on.then_some(Fullscreen::Borderless(None))
    }

    /// Returns `true` if a key's command is allowed. A kiosk refuses developer tools.
    pub(super) const fn allows(&self, command: KeyCommand) -> bool {
        !self.is_on || !matches!(command, KeyCommand::Graph | KeyCommand::Path | KeyCommand::Record)
    }

    /// Returns the seconds until an abandoned sculpture is finished or the start panel replaces a finished
    /// one; `None` before the countdown starts.
    pub(super) fn seconds_to_handover(&self, session: SessionState, idle: Duration) -> Option<u32> {
        let told_for = match session {
            SessionState::Waiting => return None,
            SessionState::Sculpting => TOLD_FOR,
            SessionState::Finished => START_TOLD_FOR,
        };
        let left = self.handover_after(session)?.checked_sub(idle)?;
        (left <= told_for).then(|| left.as_secs_f32().ceil() as u32)
    }

    /// Returns the idle time after which an abandoned sculpture is finished, or the start panel shown.
    fn handover_after(&self, session: SessionState) -> Option<Duration> {
        let shown_for = if session == SessionState::Finished { SHOWN_FOR } else { Duration::ZERO };
        self.gone_after.map(|gone_after| gone_after + shown_for)
    }
}

impl<const N: usize> App<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Hands the window over to the next visitor once the present one has left.
    pub(super) fn hand_over_if_gone(&mut self) {
        let world = self.studio.world();
        let session = world.session_state();
        let after = self.kiosk.handover_after(session);
        if after.is_none_or(|after| self.idle.time() < after) {
            return;
        }
        let is_sculpted = world.undo_counts().undoable > 0;
        if session == SessionState::Sculpting && is_sculpted {
            self.hands.queue_commands(commands::FINISH);
        } else {
            self.panels.show_start_alone();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use paros_core::session::SessionState::{Finished, Sculpting, Waiting};

    use super::Kiosk;
    use crate::window::keys::KeyCommand;

    const GONE_AFTER: Option<Duration> = Some(Duration::from_secs(90));

    const fn seconds(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    #[test]
    fn a_sculpture_is_left_after_the_settings_time_and_shown_for_20_seconds_more() {
        for gone_after in [30, 90] {
            let kiosk = Kiosk::new(Some(seconds(gone_after)), false);
            let after = [Waiting, Sculpting, Finished].map(|session| kiosk.handover_after(session));
            let expected = [gone_after, gone_after, gone_after + 20];
            assert_eq!(after, expected.map(|after| Some(seconds(after))));
        }
    }

    #[test]
    fn a_visitor_is_told_before_the_sculpture_is_finished_and_before_the_next_start() {
        let kiosk = Kiosk::new(GONE_AFTER, false);
        let told =
            |session, millis| kiosk.seconds_to_handover(session, Duration::from_millis(millis));
        assert_eq!(
            [69_000, 70_000, 89_500].map(|at| told(Sculpting, at)),
            [None, Some(20), Some(1)]
        );
        let finished = [99_000, 100_000, 110_000, 111_000].map(|at| told(Finished, at));
        assert_eq!(finished, [None, Some(10), Some(0), None], "shown, told, the next one's turn");
        assert_eq!(told(Waiting, 89_500), None, "there is nothing to lose");
    }

    #[test]
    fn a_window_at_home_and_one_with_visits_count_nothing_down() {
        for kiosk in [Kiosk::new(None, false), Kiosk::new(GONE_AFTER, true)] {
            assert_eq!(kiosk.seconds_to_handover(Sculpting, seconds(80)), None);
            assert_eq!(kiosk.handover_after(Sculpting), None);
        }
    }

    #[test]
    fn developers_keys_are_for_developers() {
        let keys = [KeyCommand::Record, KeyCommand::Graph, KeyCommand::Path, KeyCommand::Help];
        for has_visits in [false, true] {
            let kiosk = Kiosk::new(GONE_AFTER, has_visits);
            assert_eq!(keys.map(|key| kiosk.allows(key)), [false, false, false, true]);
        }
        assert!(keys.into_iter().all(|key| Kiosk::new(None, false).allows(key)));
    }
}
