//! The life cycle of an OpenXR session: its phase after each session state, and the resulting duties. Nothing
//! here calls OpenXR.

/// A change of the session's state, as the runtime reports it (`XrSessionState`).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SessionEvent {
    /// IDLE: there is nothing to do but wait.
    Idle,
    /// READY: the session should begin.
    Ready,
    /// SYNCHRONIZED: frames must be submitted, but are not visible.
    Synchronized,
    /// VISIBLE: frames are visible; input goes to another application.
    Visible,
    /// FOCUSED: frames are visible, and input is ours.
    Focused,
    /// STOPPING: the session should end.
    Stopping,
    /// LOSS_PENDING: the session is about to be lost.
    LossPending,
    /// EXITING: the user or the application wants to quit.
    Exiting,
}

/// The phase of a session.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum SessionPhase {
    /// Not running: before it begins, and after it has ended.
    #[default]
    Idle,
    /// Running, and not visible.
    Hidden,
    /// Running and visible; input goes to another application.
    Visible,
    /// Running and visible, with input focus.
    Focused,
    /// Lost; another session must be created.
    Lost,
    /// Over for good.
    Exited,
}

/// The duty of the application that a session event requires at once.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum SessionDuty {
    /// Begin the session.
    Begin,
    /// Save, as the time of the session's resumption is unknown.
    Save,
    /// Save, and end the session.
    SaveAndEnd,
}

/// The result of a session event.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct PhaseChange {
    /// The phase after the event.
    pub phase: SessionPhase,
    /// The duty to fulfil in that phase, if any.
    pub duty: Option<SessionDuty>,
}

impl SessionPhase {
    /// Returns the phase after an event, and the resulting duty.
    #[must_use]
    pub fn after_event(self, event: SessionEvent) -> PhaseChange {
        use SessionDuty::{Begin, Save, SaveAndEnd};
        let (phase, duty) = match event {
            SessionEvent::Idle => (SessionPhase::Idle, None),
            SessionEvent::Ready => (SessionPhase::Hidden, Some(Begin)),
            SessionEvent::Synchronized => (SessionPhase::Hidden, self.is_visible().then_some(Save)),
            SessionEvent::Visible => (SessionPhase::Visible, self.has_focus().then_some(Save)),
            SessionEvent::Focused => (SessionPhase::Focused, None),
            SessionEvent::Stopping => (SessionPhase::Idle, self.is_running().then_some(SaveAndEnd)),
            SessionEvent::LossPending => (SessionPhase::Lost, Some(Save)),
            SessionEvent::Exiting => (SessionPhase::Exited, Some(Save)),
        };
        PhaseChange { phase, duty }
    }

    /// Returns `true` if the session is running: frames must be waited for, begun and ended.
    #[must_use]
    pub const fn is_running(self) -> bool {
        matches!(self, SessionPhase::Hidden | SessionPhase::Visible | SessionPhase::Focused)
    }

    /// Returns `true` if the application has input focus. Without focus hands are neither drawn nor read.
    #[must_use]
    pub const fn has_focus(self) -> bool {
        matches!(self, SessionPhase::Focused)
    }

    const fn is_visible(self) -> bool {
        matches!(self, SessionPhase::Visible | SessionPhase::Focused)
    }
}

#[cfg(test)]
mod tests {
    use super::{PhaseChange, SessionDuty, SessionEvent, SessionPhase};

    /// Returns the phase after a sequence of events, and the duties on the way.
    fn run_events(events: &[SessionEvent]) -> (SessionPhase, Vec<SessionDuty>) {
        let mut duties = Vec::new();
        let phase = events.iter().fold(SessionPhase::default(), |phase, event| {
            let PhaseChange { phase, duty } = phase.after_event(*event);
            duties.extend(duty);
            phase
        });
        (phase, duties)
    }

    const TO_FOCUS: [SessionEvent; 5] = [
        SessionEvent::Idle,
        SessionEvent::Ready,
        SessionEvent::Synchronized,
        SessionEvent::Visible,
        SessionEvent::Focused,
    ];

    #[test]
    fn a_session_from_idle_to_exiting_is_begun_saved_and_ended_once() {
        let to_exit = [
            SessionEvent::Visible,
            SessionEvent::Synchronized,
            SessionEvent::Stopping,
            SessionEvent::Idle,
            SessionEvent::Exiting,
        ];
        let (phase, duties) = run_events(&[&TO_FOCUS[..], &to_exit].concat());
        assert_eq!(phase, SessionPhase::Exited);
        let expected = [
            SessionDuty::Begin,
            SessionDuty::Save,
            SessionDuty::Save,
            SessionDuty::SaveAndEnd,
            SessionDuty::Save,
        ];
        assert_eq!(duties, expected);
    }

    #[test]
    fn without_focus_frames_go_on_and_hands_are_ignored() {
        let (phase, duties) = run_events(&[&TO_FOCUS[..], &[SessionEvent::Visible]].concat());
        assert!(phase.is_running() && !phase.has_focus());
        assert_eq!(duties, [SessionDuty::Begin, SessionDuty::Save]);
        let phase = phase.after_event(SessionEvent::Focused).phase;
        assert!(phase.is_running() && phase.has_focus());
    }

    #[test]
    fn a_headset_put_off_and_on_begins_again() {
        let off_and_on = [
            SessionEvent::Synchronized,
            SessionEvent::Stopping,
            SessionEvent::Idle,
            SessionEvent::Ready,
        ];
        let (phase, duties) = run_events(&[&TO_FOCUS[..], &off_and_on].concat());
        assert_eq!(phase, SessionPhase::Hidden);
        let expected =
            [SessionDuty::Begin, SessionDuty::Save, SessionDuty::SaveAndEnd, SessionDuty::Begin];
        assert_eq!(duties, expected);
    }

    #[test]
    fn a_loss_is_saved_and_ends_the_frames() {
        let (phase, duties) = run_events(&[&TO_FOCUS[..], &[SessionEvent::LossPending]].concat());
        assert_eq!((phase, phase.is_running()), (SessionPhase::Lost, false));
        assert_eq!(duties.last(), Some(&SessionDuty::Save));
    }

    /// A session that was never begun must not be ended.
    #[test]
    fn stopping_before_beginning_ends_nothing() {
        let stopped = run_events(&[SessionEvent::Idle, SessionEvent::Stopping]);
        assert_eq!(stopped, (SessionPhase::Idle, vec![]));
    }
}
