//! Visits: a session starts when there is none, is finished by the menu button, and is handed over to
//! the next visitor after the headset was off for long.

use std::time::Duration;

use paros_core::TickInput;
use paros_core::session::{SessionMode, SessionState, TICK_RATE, commands};

/// The default of how long the headset must be off for whoever puts it on next to be another visitor.
pub const DEFAULT_HANDOVER: Duration = Duration::from_secs(45);

/// Ticks for which the menu button is held to finish: a second and a half.
const FINISH_HOLD_TICKS: u32 = TICK_RATE * 3 / 2;

/// Whether another visitor has put the headset on.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum VisitorChange {
    /// It is off, or the same visitor wears it.
    None,
    /// It was off for long: another visitor wears it.
    NextVisitor,
}

/// Decides when sessions start and finish: from user presence and the menu button.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct VisitPolicy {
    /// How sessions start.
    start_mode: SessionMode,
    /// How long the headset must be off for whoever puts it on next to be another visitor.
    absence_before_handover: Duration,
    away_since: Option<Duration>,
    /// The session is to be finished and another started: another visitor has come.
    handing_over: bool,
    /// Ticks for which the menu button has been down.
    menu_held_ticks: u32,
}

impl VisitPolicy {
    /// A policy by which sessions start in a mode, and are handed over once the headset was off for
    /// `absence_before_handover`.
    #[must_use]
    pub const fn new(start_mode: SessionMode, absence_before_handover: Duration) -> Self {
        VisitPolicy {
            start_mode,
            absence_before_handover,
            away_since: None,
            handing_over: false,
            menu_held_ticks: 0,
        }
    }

    /// Takes in a change of user presence: the headset was put on or taken off. `now` is the time
    /// since any fixed moment.
    pub fn observe_presence(&mut self, is_worn: bool, now: Duration) -> VisitorChange {
        if !is_worn {
            self.away_since = self.away_since.or(Some(now));
            return VisitorChange::None;
        }
        let away = self.away_since.take().map(|since| now.saturating_sub(since));
        let another = away.is_some_and(|away| away >= self.absence_before_handover);
        self.handing_over |= another;
        if another { VisitorChange::NextVisitor } else { VisitorChange::None }
    }

    /// Adds to a tick's input: a start where there is no session; the finish where the menu button was
    /// held long enough, or another visitor has come.
    pub fn add_session_start_or_finish(
        &mut self,
        world_session: SessionState,
        is_menu_down: bool,
        input: &mut TickInput,
    ) {
        let pressed = is_menu_down && self.menu_held_ticks == 0;
        self.menu_held_ticks =
            if is_menu_down { self.menu_held_ticks.saturating_add(1) } else { 0 };
        match world_session {
            SessionState::Waiting => input.start = self.start_mode,
            SessionState::Sculpting
                if self.handing_over || self.menu_held_ticks == FINISH_HOLD_TICKS =>
            {
                input.commands |= commands::FINISH;
            }
            SessionState::Finished if self.handing_over || pressed => {
                input.start = self.start_mode;
                self.handing_over = false;
            }
            SessionState::Sculpting | SessionState::Finished => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use paros_core::TickInput;
    use paros_core::session::{SessionMode, SessionState, commands};

    use super::{DEFAULT_HANDOVER, FINISH_HOLD_TICKS, VisitPolicy, VisitorChange};

    fn apply(
        policy: &mut VisitPolicy,
        session: SessionState,
        is_menu_down: bool,
    ) -> (SessionMode, u8) {
        let mut input = TickInput::default();
        policy.add_session_start_or_finish(session, is_menu_down, &mut input);
        (input.start, input.commands)
    }

    const NOTHING: (SessionMode, u8) = (SessionMode::None, 0);

    #[test]
    fn a_session_starts_where_there_is_none() {
        let mut policy = VisitPolicy::new(SessionMode::Creative, DEFAULT_HANDOVER);
        assert_eq!(apply(&mut policy, SessionState::Waiting, false), (SessionMode::Creative, 0));
        assert_eq!(apply(&mut policy, SessionState::Sculpting, false), NOTHING);
    }

    #[test]
    fn the_menu_button_held_finishes_once_and_pressed_again_starts_anew() {
        let mut policy = VisitPolicy::new(SessionMode::FreeForm, DEFAULT_HANDOVER);
        for _ in 1..FINISH_HOLD_TICKS {
            assert_eq!(apply(&mut policy, SessionState::Sculpting, true), NOTHING);
        }
        assert_eq!(
            apply(&mut policy, SessionState::Sculpting, true),
            (SessionMode::None, commands::FINISH)
        );
        assert_eq!(apply(&mut policy, SessionState::Finished, true), NOTHING, "it is still held");
        assert_eq!(apply(&mut policy, SessionState::Finished, false), NOTHING);
        assert_eq!(apply(&mut policy, SessionState::Finished, true), (SessionMode::FreeForm, 0));
        assert_eq!(apply(&mut policy, SessionState::Sculpting, true), NOTHING);
        // A short press does nothing to a session under way.
        assert_eq!(apply(&mut policy, SessionState::Sculpting, false), NOTHING);
    }

    #[test]
    fn a_headset_off_for_long_is_handed_over_and_off_for_short_is_not() {
        let mut policy = VisitPolicy::new(SessionMode::FreeForm, DEFAULT_HANDOVER);
        let soon = DEFAULT_HANDOVER - Duration::from_millis(1);
        policy.observe_presence(false, Duration::ZERO);
        policy.observe_presence(false, soon);
        assert_eq!(policy.observe_presence(true, soon), VisitorChange::None);
        assert_eq!(apply(&mut policy, SessionState::Sculpting, false), NOTHING);
        policy.observe_presence(false, soon);
        assert_eq!(
            policy.observe_presence(true, soon + DEFAULT_HANDOVER),
            VisitorChange::NextVisitor
        );
        assert_eq!(
            apply(&mut policy, SessionState::Sculpting, false),
            (SessionMode::None, commands::FINISH)
        );
        assert_eq!(apply(&mut policy, SessionState::Finished, false), (SessionMode::FreeForm, 0));
        assert_eq!(apply(&mut policy, SessionState::Sculpting, false), NOTHING);
    }
}
