//! Who wears the headset, and what that means for the session.

use std::time::Duration;

use paros_core::input::{Input, Mode, commands};
use paros_core::world::Session;

/// How long the headset must have been off for the next one to be another visitor, where nothing
/// else is said.
pub const HANDOVER: Duration = Duration::from_secs(45);

/// Ticks for which the menu button is held to finish: a second and a half.
const HOLD: u32 = 108;

/// The visitor's comings and goings.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Visitor {
    /// How sessions start.
    mode: Mode,
    /// How long the headset must have been off for the next one to be another visitor.
    handover: Duration,
    away_since: Option<Duration>,
    /// The session is to be finished, as its visitor has left.
    gone: bool,
    /// Ticks for which the menu button has been down.
    held: u32,
}

impl Visitor {
    /// A visitor whose sessions start like this, and who is another one after so long.
    #[must_use]
    pub const fn new(mode: Mode, handover: Duration) -> Self {
        Visitor { mode, handover, away_since: None, gone: false, held: 0 }
    }

    /// The headset was put on or off; `now` is the time since any moment. Whether it is another
    /// visitor who puts it on.
    pub fn presence(&mut self, present: bool, now: Duration) -> bool {
        if !present {
            self.away_since = self.away_since.or(Some(now));
            return false;
        }
        let away = self.away_since.take().map(|since| now.saturating_sub(since));
        let another = away.is_some_and(|away| away >= self.handover);
        self.gone |= another;
        another
    }

    /// What the visitor's coming, going and menu button add to a tick's input: a start where there
    /// is no session; its end where the button was held long, or another visitor has come.
    pub fn act(&mut self, session: Session, menu: bool, input: &mut Input) {
        let pressed = menu && self.held == 0;
        self.held = if menu { self.held.saturating_add(1) } else { 0 };
        match session {
            Session::Waiting => input.start = self.mode,
            Session::Sculpting if self.gone || self.held == HOLD => {
                input.commands |= commands::FINISH;
            }
            Session::Finished if self.gone || pressed => {
                input.start = self.mode;
                self.gone = false;
            }
            Session::Sculpting | Session::Finished => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use paros_core::input::{Input, Mode, commands};
    use paros_core::world::Session;

    use super::{HANDOVER, HOLD, Visitor};

    fn act(visitor: &mut Visitor, session: Session, menu: bool) -> (Mode, u8) {
        let mut input = Input::default();
        visitor.act(session, menu, &mut input);
        (input.start, input.commands)
    }

    const NOTHING: (Mode, u8) = (Mode::None, 0);

    #[test]
    fn a_session_starts_where_there_is_none() {
        let mut visitor = Visitor::new(Mode::Creative, HANDOVER);
        assert_eq!(act(&mut visitor, Session::Waiting, false), (Mode::Creative, 0));
        assert_eq!(act(&mut visitor, Session::Sculpting, false), NOTHING);
    }

    #[test]
    fn the_menu_button_held_finishes_once_and_pressed_again_starts_anew() {
        let mut visitor = Visitor::new(Mode::FreeForm, HANDOVER);
        for _ in 1..HOLD {
            assert_eq!(act(&mut visitor, Session::Sculpting, true), NOTHING);
        }
        assert_eq!(act(&mut visitor, Session::Sculpting, true), (Mode::None, commands::FINISH));
        assert_eq!(act(&mut visitor, Session::Finished, true), NOTHING, "it is still held");
        assert_eq!(act(&mut visitor, Session::Finished, false), NOTHING);
        assert_eq!(act(&mut visitor, Session::Finished, true), (Mode::FreeForm, 0));
        assert_eq!(act(&mut visitor, Session::Sculpting, true), NOTHING);
        // A short press does nothing to a session under way.
        assert_eq!(act(&mut visitor, Session::Sculpting, false), NOTHING);
    }

    #[test]
    fn a_headset_off_for_long_is_handed_over_and_off_for_short_is_not() {
        let mut visitor = Visitor::new(Mode::FreeForm, HANDOVER);
        let soon = HANDOVER - Duration::from_millis(1);
        visitor.presence(false, Duration::ZERO);
        visitor.presence(false, soon);
        assert!(!visitor.presence(true, soon));
        assert_eq!(act(&mut visitor, Session::Sculpting, false), NOTHING);
        visitor.presence(false, soon);
        assert!(visitor.presence(true, soon + HANDOVER));
        assert_eq!(act(&mut visitor, Session::Sculpting, false), (Mode::None, commands::FINISH));
        assert_eq!(act(&mut visitor, Session::Finished, false), (Mode::FreeForm, 0));
        assert_eq!(act(&mut visitor, Session::Sculpting, false), NOTHING);
    }
}
