//! The life of a session: what the runtime tells of it, and what is to be done then.

/// A state that the runtime tells of; OpenXR's `XrSessionState`.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Told {
    /// Nothing to do but wait.
    Idle,
    /// The runtime wants the session begun.
    Ready,
    /// Frames are wanted, and seen by no one.
    Synchronized,
    /// Frames are seen; the hands are another application's.
    Visible,
    /// Frames are seen, and the hands are ours.
    Focused,
    /// The runtime wants the session ended.
    Stopping,
    /// The session is about to be lost.
    LossPending,
    /// The visitor, or we, wanted it over.
    Exiting,
}

/// Where a session stands.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Life {
    /// Before it begins, and after it was ended.
    #[default]
    Idle,
    /// Begun; what is drawn is not seen.
    Unseen,
    /// Seen, while another application has the hands.
    Seen,
    /// Seen, and the hands are ours.
    Focused,
    /// To be made anew.
    Lost,
    /// To be left for good.
    Over,
}

/// What has to be done at once.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Duty {
    /// Begin the session.
    Begin,
    /// Save, as nobody can say when it will go on.
    Save,
    /// Save, and end the session.
    End,
}

impl Life {
    /// Where it stands after the runtime told something, and what is to be done.
    #[must_use]
    pub fn told(self, told: Told) -> (Life, Option<Duty>) {
        match told {
            Told::Idle => (Life::Idle, None),
            Told::Ready => (Life::Unseen, Some(Duty::Begin)),
            Told::Synchronized => (Life::Unseen, self.is_seen().then_some(Duty::Save)),
            Told::Visible => (Life::Seen, self.listens().then_some(Duty::Save)),
            Told::Focused => (Life::Focused, None),
            Told::Stopping => (Life::Idle, self.runs().then_some(Duty::End)),
            Told::LossPending => (Life::Lost, Some(Duty::Save)),
            Told::Exiting => (Life::Over, Some(Duty::Save)),
        }
    }

    /// Whether frames are to be made.
    #[must_use]
    pub const fn runs(self) -> bool {
        matches!(self, Life::Unseen | Life::Seen | Life::Focused)
    }

    /// Whether hands and buttons are ours: without that they are neither drawn nor heeded.
    #[must_use]
    pub const fn listens(self) -> bool {
        matches!(self, Life::Focused)
    }

    const fn is_seen(self) -> bool {
        matches!(self, Life::Seen | Life::Focused)
    }
}

#[cfg(test)]
mod tests {
    use super::{Duty, Life, Told};

    /// What is done on the way, and where it ends.
    fn live(told: &[Told]) -> (Life, Vec<Duty>) {
        let mut duties = Vec::new();
        let life = told.iter().fold(Life::default(), |life, told| {
            let (life, duty) = life.told(*told);
            duties.extend(duty);
            life
        });
        (life, duties)
    }

    const UP: [Told; 5] =
        [Told::Idle, Told::Ready, Told::Synchronized, Told::Visible, Told::Focused];

    #[test]
    fn a_session_from_idle_to_exiting_is_begun_saved_and_ended_once() {
        let down = [Told::Visible, Told::Synchronized, Told::Stopping, Told::Idle, Told::Exiting];
        let (life, duties) = live(&[&UP[..], &down].concat());
        assert_eq!(life, Life::Over);
        assert_eq!(duties, [Duty::Begin, Duty::Save, Duty::Save, Duty::End, Duty::Save]);
    }

    #[test]
    fn without_focus_frames_go_on_and_hands_are_ignored() {
        let (life, duties) = live(&[&UP[..], &[Told::Visible]].concat());
        assert!(life.runs() && !life.listens());
        assert_eq!(duties, [Duty::Begin, Duty::Save]);
        let (life, _) = life.told(Told::Focused);
        assert!(life.runs() && life.listens());
    }

    #[test]
    fn a_headset_put_off_and_on_begins_again() {
        let off = [Told::Synchronized, Told::Stopping, Told::Idle, Told::Ready];
        let (life, duties) = live(&[&UP[..], &off].concat());
        assert_eq!(life, Life::Unseen);
        assert_eq!(duties, [Duty::Begin, Duty::Save, Duty::End, Duty::Begin]);
    }

    #[test]
    fn a_loss_is_saved_and_ends_the_frames() {
        let (life, duties) = live(&[&UP[..], &[Told::LossPending]].concat());
        assert_eq!((life, life.runs()), (Life::Lost, false));
        assert_eq!(duties.last(), Some(&Duty::Save));
    }

    /// A session that was never begun must not be ended.
    #[test]
    fn stopping_before_beginning_ends_nothing() {
        assert_eq!(live(&[Told::Idle, Told::Stopping]), (Life::Idle, vec![]));
    }
}
