//! The phases of a visit, and the steps of its guided part.

/// Where a visit stands. [`Visit`](crate::visit::Visit) has the table of what follows what.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum VisitPhase {
    /// There are no visits: sessions start and end by the shell's inputs alone.
    Closed = 0,
    /// Nobody wears the headset: a stone is carved for those who look.
    Attract = 1,
    /// Language, hand, standing or seated.
    Welcome = 2,
    /// The choice of a start.
    Choice = 3,
    /// The guided first cut.
    Guided = 4,
    /// Sculpting, with a clock unless there is none.
    Sculpting = 5,
    /// The time is up, or the visitor is ready: nothing is edited any more, and what floats falls.
    HandsOff = 6,
    /// The sculpture is final, and is being kept.
    Export = 7,
    /// The badge is shown.
    Badge = 8,
    /// The sculpture on its own, to be walked round.
    Thanks = 9,
    /// The staff is told that the headset is ready for the next visitor.
    Handover = 10,
}

/// A step of the guided first cut. Each ends when it is done.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum GuideStep {
    /// A tool is taken.
    TakeTool = 0,
    /// Its bit touches the stone.
    Touch = 1,
    /// It cuts.
    Cut = 2,
    /// The rasp smooths.
    Smooth = 3,
    /// A stroke is undone.
    Undo = 4,
    /// The stool is turned.
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

    /// Whether hands take tools and edit.
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

    /// The step after it; the last one stays.
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
