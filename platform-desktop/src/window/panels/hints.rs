//! Hints for a visitor's first gestures, until they were done once.

use paros_core::edit::UndoCounts;
use paros_core::session::{FOUND_PERCENT, SessionMode, ToolBit};

use super::StudioStatus;

/// The gestures that the visitor has shown to know.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct Hints {
    has_cut: bool,
    has_undone: bool,
    /// When paste was last laid beyond the volume.
    pasted_beyond_at: Option<f64>,
}

/// For how long that is told, in seconds: whoever lays paste looks at the stone.
const BEYOND_SECONDS: f64 = 6.0;

impl Hints {
    /// Notes what the strokes to undo and to redo tell: a stroke was made, or taken back.
    pub(super) const fn note_strokes(&mut self, strokes: UndoCounts) {
        self.has_cut |= strokes.undoable > 0 || strokes.redoable > 0;
        self.has_undone |= strokes.redoable > 0;
    }

    /// Notes what the studio's status tells at a time in seconds. Returns the work that hints are about.
    pub(super) const fn note_work(&mut self, status: &StudioStatus<'_>, now: f64) -> HintedWork {
        if status.pastes_beyond_box {
            self.pasted_beyond_at = Some(now);
        }
        match self.pasted_beyond_at {
            Some(at) if now - at < BEYOND_SECONDS => HintedWork::PasteBeyondBox,
            _ => HintedWork::of_status(status),
        }
    }

    /// The hint to show: what keeps the tool from its work first, then the first gestures, then what is to be done with a
    /// figure that hides in the stone.
    #[must_use]
    pub(super) const fn text(self, work: HintedWork) -> Option<&'static str> {
        match (work, self.has_cut, self.has_undone) {
            (HintedWork::PasteBeyondBox, ..) => {
                Some("Paste holds over the stool only, as wide and as high as a block of stone")
            }
            (_, false, _) => Some(
                "Hold the left button and drag over the stone  ·  drag with the right one to look around",
            ),
            (HintedWork::FigureUnderLargeBall, true, _) => Some(
                "So large a ball reaches no hollows: take the medium one, by Shift + 2 or in the bar",
            ),
            (_, true, false) => {
                Some("Z takes it back  ·  drag with the right button to look around")
            }
            (HintedWork::HiddenFigure, true, true) => Some(
                "Stroke the stone off all around the figure  ·  smaller bits reach its hollows",
            ),
            (HintedWork::Other, true, true) => None,
        }
    }
}

/// From how much of a hidden figure on a ball for roughing out has done its work, in percent.
const ROUGHED_OUT_PERCENT: u32 = 12;

/// The work in hand, as far as hints are about it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum HintedWork {
    /// Nothing that a hint is about.
    Other,
    /// A figure hides in the stone.
    HiddenFigure,
    /// A good part of it is bared, and the largest ball is in hand.
    FigureUnderLargeBall,
    /// Paste is being laid where the volume ends.
    PasteBeyondBox,
}

impl HintedWork {
    /// The work that the studio's status tells.
    #[must_use]
    pub(super) const fn of_status(status: &StudioStatus<'_>) -> Self {
        let hides = matches!(status.mode, SessionMode::Constrained { .. })
            && status.bared_percent < FOUND_PERCENT;
        match status.held {
            Some((_, ToolBit::RoughingBall))
                if hides && status.bared_percent >= ROUGHED_OUT_PERCENT =>
            {
                HintedWork::FigureUnderLargeBall
            }
            _ if hides => HintedWork::HiddenFigure,
            _ => HintedWork::Other,
        }
    }
}

#[cfg(test)]
mod tests {
    use paros_core::session::Tool;

    use super::*;
    use crate::window::hands::tool_bits_of;
    use crate::window::panels::tests::sculpting_status;

    #[test]
    fn hints_stay_until_the_first_cut_and_the_first_undo() {
        let mut hints = Hints::default();
        let mut after = |undoable, redoable| {
            hints.note_strokes(UndoCounts { undoable, redoable });
            hints.text(HintedWork::Other)
        };
        let drag = after(0, 0).expect("nothing is known yet");
        assert!(drag.contains("Hold the left button and drag") && drag.contains("right"));
        let undo = after(1, 0).expect("undo isn't known yet");
        assert!(undo.contains("Z takes it back") && undo.contains("right"));
        assert_eq!(after(2, 0), Some(undo));
        assert_eq!(after(1, 1), None);
        assert_eq!(after(0, 0), None, "nor with the next stone");
        let aim = hints.text(HintedWork::HiddenFigure).expect("what hides is to be found");
        assert!(aim.contains("all around") && aim.contains("smaller bits"));
    }

    #[test]
    fn what_keeps_a_tool_from_its_work_is_told_before_what_is_known() {
        let hidden = SessionMode::Constrained { figure: 0 };
        let mut status = StudioStatus { mode: hidden, ..sculpting_status() };
        let work = |status: &StudioStatus<'_>| HintedWork::of_status(status);
        assert_eq!(work(&status), HintedWork::HiddenFigure);
        status.held = Some((Tool::Rotary, ToolBit::RoughingBall));
        assert_eq!(work(&status), HintedWork::HiddenFigure, "it has just begun");
        status.bared_percent = 30;
        assert_eq!(work(&status), HintedWork::FigureUnderLargeBall);
        status.bared_percent = FOUND_PERCENT;
        assert_eq!(work(&status), HintedWork::Other, "it is found");
        let mut hints = Hints { has_cut: true, ..Hints::default() };
        assert_eq!(hints.note_work(&status, 1.0), HintedWork::Other);
        status.pastes_beyond_box = true;
        assert_eq!(hints.note_work(&status, 2.0), HintedWork::PasteBeyondBox);
        status.pastes_beyond_box = false;
        assert_eq!(hints.note_work(&status, 7.0), HintedWork::PasteBeyondBox, "it can be read");
        assert_eq!(hints.note_work(&status, 9.0), HintedWork::Other);
        assert!(hints.text(HintedWork::PasteBeyondBox).is_some_and(|text| text.contains("Paste")));
        let ball = hints.text(HintedWork::FigureUnderLargeBall);
        assert!(ball.is_some_and(|text| text.contains("Shift + 2")));
        let second = tool_bits_of(Tool::Rotary).nth(1);
        assert_eq!(second, Some(ToolBit::MediumBall), "which that key takes");
    }
}
