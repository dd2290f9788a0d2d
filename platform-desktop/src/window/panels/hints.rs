//! Hints for a visitor's first gestures, until they were done once.

use paros_core::edit::UndoCounts;

/// The gestures that the visitor has shown to know.
#[derive(Clone, Copy, Default, Debug)]
pub(super) struct Hints {
    has_cut: bool,
    has_undone: bool,
}

impl Hints {
    /// Notes what the strokes to undo and to redo tell: a stroke was made, or taken back.
    pub(super) const fn note_strokes(&mut self, strokes: UndoCounts) {
        self.has_cut |= strokes.undoable > 0 || strokes.redoable > 0;
        self.has_undone |= strokes.redoable > 0;
    }

    /// The hint to show; once there was a cut and an undo, of what is to be done with a figure that `hides` in the stone.
    #[must_use]
    pub(super) const fn text(self, hides: bool) -> Option<&'static str> {
        match (self.has_cut, self.has_undone) {
            (false, _) => Some(
                "Hold the left button and drag over the stone  ·  drag with the right one to look around",
            ),
            (true, false) => Some("Z takes it back  ·  drag with the right button to look around"),
            (true, true) if hides => Some(
                "Stroke the stone off all around the figure  ·  smaller bits reach its hollows",
            ),
            (true, true) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hints_stay_until_the_first_cut_and_the_first_undo() {
        let mut hints = Hints::default();
        let mut after = |undoable, redoable| {
            hints.note_strokes(UndoCounts { undoable, redoable });
            hints.text(false)
        };
        let drag = after(0, 0).expect("nothing is known yet");
        assert!(drag.contains("Hold the left button and drag") && drag.contains("right"));
        let undo = after(1, 0).expect("undo isn't known yet");
        assert!(undo.contains("Z takes it back") && undo.contains("right"));
        assert_eq!(after(2, 0), Some(undo));
        assert_eq!(after(1, 1), None);
        assert_eq!(after(0, 0), None, "nor with the next stone");
        let aim = hints.text(true).expect("what hides is to be found");
        assert!(aim.contains("all around") && aim.contains("smaller bits"));
    }
}
