//! The phases of a visit, and the steps of its guided part.

/// The phase of a visit. [`Visit`](crate::visit::Visit) has the table of transitions.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum VisitPhase {
    /// There are no visits: only the shell's inputs start and end sessions.
    Closed = 0,
    /// The headset isn't worn: a stone is carved as a demonstration for onlookers.
    Attract = 1,
    /// The visitor selects language, working hand, and standing or seated.
    Welcome = 2,
    /// The visitor selects how to start.
    Choice = 3,
    /// The guided first cut.
    Guided = 4,
    /// Sculpting, with a clock unless the plan has none.
    Sculpting = 5,
    /// The time is up, or the visitor has finished: editing is disabled, and unsupported stone falls.
    HandsOff = 6,
    /// The sculpture is final and is being stored.
    Export = 7,
    /// The badge is shown.
    Badge = 8,
    /// The sculpture is shown alone, so that the visitor can walk round it.
    Thanks = 9,
    /// The staff is notified that the headset is ready for the next visitor.
    Handover = 10,
}

/// A step of the guided first cut. Each step ends when its action is done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum GuideStep {
    /// Take a tool.
    TakeTool = 0,
    /// Touch the stone with its bit.
    Touch = 1,
    /// Cut the stone.
    Cut = 2,
    /// Smooth with the rasp.
    Smooth = 3,
    /// Undo a stroke.
    Undo = 4,
    /// Turn the stool.
    TurnStool = 5,
    /// All steps are done.
    Done = 6,
}

impl VisitPhase {
    /// All phases, in the order of their numbers.
    pub const ALL: [VisitPhase; 11] = [
        VisitPhase::Closed,
        VisitPhase::Attract,
        VisitPhase::Welcome,
        VisitPhase::Choice,
        VisitPhase::Guided,
        VisitPhase::Sculpting,
        VisitPhase::HandsOff,
        VisitPhase::Export,
        VisitPhase::Badge,
        VisitPhase::Thanks,
        VisitPhase::Handover,
    ];

    pub(super) fn from_number(number: u8) -> Option<Self> {
        VisitPhase::ALL.get(usize::from(number)).copied()
    }

    /// Returns `true` if hands may take tools and edit.
    #[must_use]
    pub const fn lets_hands_work(self) -> bool {
        matches!(
            self,
            VisitPhase::Closed | VisitPhase::Attract | VisitPhase::Guided | VisitPhase::Sculpting
        )
    }
}

impl GuideStep {
    /// All steps, in the order of their numbers.
    pub const ALL: [GuideStep; 7] = [
        GuideStep::TakeTool,
        GuideStep::Touch,
        GuideStep::Cut,
        GuideStep::Smooth,
        GuideStep::Undo,
        GuideStep::TurnStool,
        GuideStep::Done,
    ];

    pub(super) fn from_number(number: u8) -> Option<Self> {
        GuideStep::ALL.get(usize::from(number)).copied()
    }

    /// Returns the next step, or the last step again at the end.
    #[must_use]
    pub const fn next(self) -> Self {
        let next = self as usize + 1;
        GuideStep::ALL[if next < GuideStep::ALL.len() { next } else { self as usize }]
    }
}

#[cfg(test)]
mod tests {
    use super::{GuideStep, VisitPhase};

    #[test]
    fn phases_and_steps_are_numbered_in_their_order() {
        for (number, phase) in VisitPhase::ALL.into_iter().enumerate() {
            assert_eq!(phase as usize, number);
            assert_eq!(VisitPhase::from_number(number as u8), Some(phase));
        }
        for (number, step) in GuideStep::ALL.into_iter().enumerate() {
            assert_eq!(step as usize, number);
            assert_eq!(GuideStep::from_number(number as u8), Some(step));
        }
        assert_eq!(VisitPhase::from_number(11), None);
        assert_eq!(GuideStep::from_number(7), None);
        assert_eq!(GuideStep::TurnStool.next(), GuideStep::Done);
        assert_eq!(GuideStep::Done.next(), GuideStep::Done);
    }
}
