//! Hints for a visitor's first gestures, until each was done once, and for problems that stop a tool from
//! working.

use paros_core::edit::UndoCounts;
use paros_core::internals::BitAction;
use paros_core::session::{BitSize, FOUND_PERCENT, SessionMode, TICK_RATE, ToolBit};
use paros_shaders::panel::Message;
use paros_shell::figures::{HiddenStart, StoneThickness};

use super::StudioStatus;

/// The gestures that the visitor has already made, and the state of other hints.
#[derive(Clone, Copy, Default, Debug)]
pub(in crate::window) struct Hints {
    has_cut: bool,
    has_undone: bool,
    /// Time at which paste was last laid beyond the volume, in seconds.
    pasted_beyond_at: Option<f64>,
    baring: Baring,
}

/// The hint of the tool bar in a frame.
#[derive(Clone, Copy, Debug)]
pub(in crate::window) struct Hint {
    pub(super) text: Option<Message>,
    /// The bit that the text names.
    pub(super) bit: Option<ToolBit>,
}

/// Seconds for which the hint about paste beyond the volume stays: a visitor who lays paste looks at the
/// stone.
const BEYOND_SECONDS: f64 = 6.0;

impl Hints {
    /// Notes from the undo counts that a stroke was made or undone.
    pub(in crate::window) const fn note_strokes(&mut self, strokes: UndoCounts) {
        self.has_cut |= strokes.undoable > 0 || strokes.redoable > 0;
        self.has_undone |= strokes.redoable > 0;
    }

    /// Updates the hints from the studio's status at a time in seconds. Returns the work that hints are
    /// about.
    pub(in crate::window) fn note_work(
        &mut self,
        status: &StudioStatus<'_>,
        now: f64,
    ) -> HintedWork {
        self.baring.note(status);
        if status.pastes_beyond_box {
            self.pasted_beyond_at = Some(now);
        }
        match self.pasted_beyond_at {
            Some(at) if now - at < BEYOND_SECONDS => HintedWork::PasteBeyondBox,
            _ => HintedWork::of_status(status, &self.baring),
        }
    }

    /// Returns the hint to show: first problems that stop the tool, then the first gestures, then advice
    /// about the hidden figure.
    #[must_use]
    pub(in crate::window) const fn text(self, work: HintedWork) -> Option<Message> {
        match (work, self.has_cut, self.has_undone) {
            (HintedWork::PasteBeyondBox, ..) => Some(Message::HintBeyond),
            (_, false, _) => Some(Message::HintDrag),
            (HintedWork::FigureUnderLargeBall, true, _) => Some(Message::HintLargeBall),
            (HintedWork::FigureUnderMuchStone, true, _) => Some(Message::HintMuchStone),
            (HintedWork::FigureBeyondBit, true, _) => Some(Message::HintBeyondBit),
            (_, true, false) => Some(Message::HintUndo),
            (HintedWork::HiddenFigure, true, true) => Some(Message::HintAllAround),
            (HintedWork::LastStone, true, true) => Some(Message::HintLastStone),
            (HintedWork::FigureFound, true, true) => Some(Message::HintFound),
            (HintedWork::Other, true, true) => None,
        }
    }

    /// Returns the bit that the hint names.
    #[must_use]
    pub(in crate::window) const fn bit(self, work: HintedWork) -> Option<ToolBit> {
        match work {
            HintedWork::FigureUnderLargeBall if self.has_cut => Some(ToolBit::MediumBall),
            HintedWork::FigureUnderMuchStone if self.has_cut => Some(ToolBit::RoughingBall),
            _ => None,
        }
    }
}

/// Progress of the bit in hand at baring a hidden figure.
#[derive(Clone, Copy, Default, Debug)]
struct Baring {
    with: Option<(SessionMode, ToolBit, BitSize)>,
    from_percent: u32,
    last_tick: u64,
    /// Ticks that the bit has run since it last bared [`STEP_PERCENT`]; the next field counts those on the
    /// figure.
    ticks: u64,
    ticks_on_figure: u64,
}

/// Progress in percent below which, in [`STALLED_TICKS`], a bit has done what it can: a newcomer's rows bare
/// twice as much, or half.
const STEP_PERCENT: u32 = 3;

/// Ticks of running after which a bit can count as stalled: ten seconds.
const STALLED_TICKS: u64 = 10 * TICK_RATE as u64;

/// Ticks of running after which a bit counts as too small for the stone: four seconds, during which the undo
/// hint shows.
const DEEP_TICKS: u64 = 4 * TICK_RATE as u64;

/// Maximum number of ticks counted for a frame: runs of the tool are sampled once a frame.
const FRAME_TICKS: u64 = 36;

impl Baring {
    fn note(&mut self, status: &StudioStatus<'_>) {
        let with = status.held.map(|(_, bit)| (status.mode, bit, status.size));
        let ticks = status.tick.saturating_sub(self.last_tick).min(FRAME_TICKS);
        self.last_tick = status.tick;
        let percent = status.bared_percent;
        if with != self.with || percent < self.from_percent {
            *self =
                Baring { with, from_percent: percent, last_tick: status.tick, ..Self::default() };
        } else if percent >= self.from_percent + STEP_PERCENT {
            (self.from_percent, self.ticks, self.ticks_on_figure) = (percent, 0, 0);
        } else if status.runs {
            self.ticks += ticks;
            self.ticks_on_figure += if status.is_on_figure { ticks } else { 0 };
        }
    }

    /// Returns `true` if the bit bares hardly more, though at least a twentieth of its time is on the figure.
    /// The share is a fiftieth for a ball in bare stone, and a tenth for one that rounds a bared figure.
    const fn is_stalled(&self) -> bool {
        self.ticks >= STALLED_TICKS && 20 * self.ticks_on_figure >= self.ticks
    }
}

/// Returns the bared percentage of a hidden figure from which a ball for roughing out is no longer needed:
/// changing to the medium ball then finds the owl soonest.
const fn roughed_out_percent(thickness: StoneThickness) -> u32 {
    match thickness {
        StoneThickness::Near => 12,
        StoneThickness::Half => 40,
        StoneThickness::Whole => 50,
    }
}

/// Bared percentage up to which much stone lies over the figure.
const MUCH_STONE_PERCENT: u32 = 12;

/// Bared percentage from which the remaining stone is in creases and at the back.
const LAST_STONE_PERCENT: u32 = 80;

/// The work in hand, as far as hints depend on it.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(in crate::window) enum HintedWork {
    /// No work with a hint.
    Other,
    /// A figure hides in the stone.
    HiddenFigure,
    /// The figure is under more stone than the ball in hand can soon remove.
    FigureUnderMuchStone,
    /// A good part of the figure is bared, and the ball in hand is too large for the rest.
    FigureUnderLargeBall,
    /// The bit in hand bares hardly more of the figure.
    FigureBeyondBit,
    /// Little of the figure is still in the stone, and most of that is out of sight.
    LastStone,
    /// The figure is found.
    FigureFound,
    /// Paste is being laid where the volume ends.
    PasteBeyondBox,
}

impl HintedWork {
    /// Returns the work by the studio's status and the progress at baring the figure.
    #[must_use]
    fn of_status(status: &StudioStatus<'_>, baring: &Baring) -> Self {
        let percent = status.bared_percent;
        let SessionMode::Constrained { figure } = status.mode else { return HintedWork::Other };
        if percent >= FOUND_PERCENT {
            return HintedWork::FigureFound;
        }
        let thickness =
            HiddenStart::from_number(figure).map_or(StoneThickness::Near, |start| start.thickness);
        let is_deep = thickness != StoneThickness::Near && percent < MUCH_STONE_PERCENT;
        match status.held.map(|(_, bit)| bit) {
            Some(ToolBit::RoughingBall) if percent >= roughed_out_percent(thickness) => {
                HintedWork::FigureUnderLargeBall
            }
            Some(ToolBit::LargeBall)
                if thickness == StoneThickness::Near
                    && percent >= roughed_out_percent(thickness) =>
            {
                HintedWork::FigureUnderLargeBall
            }
            Some(ToolBit::SmallBall | ToolBit::MediumBall)
                if is_deep && baring.ticks >= DEEP_TICKS =>
            {
                HintedWork::FigureUnderMuchStone
            }
            // There is still stone to remove elsewhere, with any bit.
            _ if is_deep => HintedWork::HiddenFigure,
            Some(ToolBit::RoughingBall | ToolBit::LargeBall) if baring.is_stalled() => {
                HintedWork::FigureUnderLargeBall
            }
            Some(bit) if bit.spec().action == BitAction::Carve && baring.is_stalled() => {
                HintedWork::FigureBeyondBit
            }
            _ if percent >= LAST_STONE_PERCENT => HintedWork::LastStone,
            _ => HintedWork::HiddenFigure,
        }
    }
}

#[cfg(test)]
mod tests {
    use paros_core::session::Tool;
    use paros_shaders::panel::Language;
    use paros_shell::figures::Figure;

    use super::*;
    use crate::window::hands::tool_bits_of;
    use crate::window::panels::tests::sculpting_status;

    fn english(hint: Option<Message>) -> Option<&'static str> {
        hint.map(|hint| hint.text(Language::English))
    }

    /// Returns the status of an owl under stone, with nothing bared yet.
    fn hidden_owl(thickness: StoneThickness) -> StudioStatus<'static> {
        let mode = HiddenStart { figure: Figure::Owl, thickness }.mode();
        StudioStatus { mode, ..sculpting_status() }
    }

    /// Simulates a running ball for `seconds`. It is on the figure for `on_figure` of a hundred ticks, and
    /// bares the figure evenly between two percentages. Returns the work and the hints.
    fn after_strokes(
        status: &mut StudioStatus<'_>,
        bit: ToolBit,
        seconds: u64,
        on_figure: u64,
        percents: [u32; 2],
    ) -> (HintedWork, Hints) {
        let mut hints = Hints { has_cut: true, ..Hints::default() };
        status.held = Some((Tool::Rotary, bit));
        status.runs = true;
        let mut work = HintedWork::Other;
        let ticks = seconds * u64::from(TICK_RATE);
        for tick in 0..=ticks {
            status.tick = tick;
            status.is_on_figure = tick % 100 < on_figure;
            let more = u64::from(percents[1] - percents[0]) * tick / ticks;
            status.bared_percent = percents[0] + more as u32;
            work = hints.note_work(status, tick as f64 / f64::from(TICK_RATE));
        }
        (work, hints)
    }

    /// Measured with a newcomer's rows and these balls (`window::hands::tests::newcomer`), and the hint for
    /// each.
    #[test]
    fn a_ball_that_bares_no_more_is_told_to_be_too_large_and_one_that_gets_on_is_not() {
        let work = |thickness, bit, seconds, on_figure, percents| {
            after_strokes(&mut hidden_owl(thickness), bit, seconds, on_figure, percents).0
        };
        use StoneThickness::{Half, Whole};
        use ToolBit::{LargeBall, MediumBall, RoughingBall};
        assert_eq!(work(Whole, RoughingBall, 11, 30, [13, 17]), HintedWork::HiddenFigure);
        assert_eq!(work(Whole, RoughingBall, 11, 40, [30, 31]), HintedWork::FigureUnderLargeBall);
        assert_eq!(work(Whole, RoughingBall, 11, 40, [4, 5]), HintedWork::HiddenFigure, "deep");
        assert_eq!(work(Half, LargeBall, 22, 15, [45, 66]), HintedWork::HiddenFigure);
        assert_eq!(work(Half, LargeBall, 22, 15, [88, 90]), HintedWork::FigureUnderLargeBall);
        assert_eq!(work(Half, MediumBall, 22, 12, [92, 93]), HintedWork::FigureBeyondBit);
        assert_eq!(work(Half, MediumBall, 22, 12, [40, 62]), HintedWork::HiddenFigure);
        assert_eq!(work(Half, RoughingBall, 9, 40, [5, 5]), HintedWork::HiddenFigure, "as yet");
        assert_eq!(work(Whole, LargeBall, 30, 2, [0, 0]), HintedWork::HiddenFigure, "deep yet");
    }

    #[test]
    fn a_small_ball_under_much_stone_is_told_after_seconds_of_work() {
        let work = |thickness, bit, seconds, percents| {
            let mut status = hidden_owl(thickness);
            let (work, hints) = after_strokes(&mut status, bit, seconds, 0, percents);
            (work, hints.bit(work))
        };
        let told = (HintedWork::FigureUnderMuchStone, Some(ToolBit::RoughingBall));
        let untold = (HintedWork::HiddenFigure, None);
        assert_eq!(
            work(StoneThickness::Half, ToolBit::MediumBall, 3, [0, 0]),
            untold,
            "the undo is"
        );
        assert_eq!(work(StoneThickness::Half, ToolBit::MediumBall, 5, [0, 0]), told);
        assert_eq!(work(StoneThickness::Whole, ToolBit::SmallBall, 5, [0, 1]), told);
        assert_eq!(work(StoneThickness::Near, ToolBit::MediumBall, 5, [0, 0]), untold);
        assert_eq!(work(StoneThickness::Half, ToolBit::MediumBall, 5, [20, 21]), untold);
        let sixth = tool_bits_of(Tool::Rotary).nth(5);
        assert_eq!(sixth, Some(ToolBit::RoughingBall), "which the key of the hint takes");
        let text = english(Hints { has_cut: true, ..Hints::default() }.text(told.0));
        assert!(text.is_some_and(|text| text.contains("Shift + 6")));
    }

    /// Measured with a player: the large ball bared the owl under its thin coat a quarter more slowly than
    /// the medium one, and left ribs.
    #[test]
    fn what_is_left_of_a_thin_coat_is_told_by_the_ball_and_by_what_is_bared() {
        let work = |bit, percent| {
            let mut status = hidden_owl(StoneThickness::Near);
            after_strokes(&mut status, bit, 4, 20, [percent, percent]).0
        };
        assert_eq!(work(ToolBit::LargeBall, 11), HintedWork::HiddenFigure);
        assert_eq!(work(ToolBit::LargeBall, 12), HintedWork::FigureUnderLargeBall);
        assert_eq!(work(ToolBit::MediumBall, 79), HintedWork::HiddenFigure);
        assert_eq!(work(ToolBit::MediumBall, 80), HintedWork::LastStone);
        assert_eq!(work(ToolBit::MediumBall, FOUND_PERCENT), HintedWork::FigureFound);
    }

    #[test]
    fn another_bit_is_given_its_own_time_and_so_is_one_that_is_put_to_rest() {
        let mut status = hidden_owl(StoneThickness::Near);
        let (work, mut hints) = after_strokes(&mut status, ToolBit::LargeBall, 12, 20, [85, 86]);
        assert_eq!(work, HintedWork::FigureUnderLargeBall);
        assert_eq!(hints.bit(work), Some(ToolBit::MediumBall));
        status.held = Some((Tool::Rotary, ToolBit::MediumBall));
        assert_eq!(hints.note_work(&status, 13.0), HintedWork::LastStone);
        status.runs = false;
        for _ in 0..100 {
            status.tick += 20;
            assert_eq!(hints.note_work(&status, 20.0), HintedWork::LastStone, "it rests");
        }
    }

    #[test]
    fn hints_stay_until_the_first_cut_and_the_first_undo() {
        let mut hints = Hints::default();
        let mut after = |undoable, redoable| {
            hints.note_strokes(UndoCounts { undoable, redoable });
            english(hints.text(HintedWork::Other))
        };
        let drag = after(0, 0).expect("nothing is known yet");
        assert!(drag.contains("Hold the left button and drag") && drag.contains("right"));
        let undo = after(1, 0).expect("undo isn't known yet");
        assert!(undo.contains("Z takes it back") && undo.contains("right"));
        assert_eq!(after(2, 0), Some(undo));
        assert_eq!(after(1, 1), None);
        assert_eq!(after(0, 0), None, "nor with the next stone");
        let aim = english(hints.text(HintedWork::HiddenFigure)).expect("what hides is to be found");
        assert!(aim.contains("all around") && aim.contains("smaller bits"));
    }

    #[test]
    fn what_keeps_a_tool_from_its_work_is_told_before_what_is_known() {
        let mut status = hidden_owl(StoneThickness::Half);
        let work = |status: &StudioStatus<'_>| HintedWork::of_status(status, &Baring::default());
        assert_eq!(work(&status), HintedWork::HiddenFigure);
        status.held = Some((Tool::Rotary, ToolBit::RoughingBall));
        assert_eq!(work(&status), HintedWork::HiddenFigure, "it has just begun");
        status.bared_percent = 39;
        assert_eq!(work(&status), HintedWork::HiddenFigure, "it gets on well");
        status.bared_percent = 40;
        assert_eq!(work(&status), HintedWork::FigureUnderLargeBall);
        status.bared_percent = FOUND_PERCENT;
        assert_eq!(work(&status), HintedWork::FigureFound);
        let mut hints = Hints { has_cut: true, ..Hints::default() };
        assert_eq!(hints.note_work(&status, 1.0), HintedWork::FigureFound);
        status.pastes_beyond_box = true;
        assert_eq!(hints.note_work(&status, 2.0), HintedWork::PasteBeyondBox);
        status.pastes_beyond_box = false;
        assert_eq!(hints.note_work(&status, 7.0), HintedWork::PasteBeyondBox, "it can be read");
        assert_eq!(hints.note_work(&status, 9.0), HintedWork::FigureFound);
        let paste = english(hints.text(HintedWork::PasteBeyondBox));
        assert!(paste.is_some_and(|text| text.contains("Paste")));
        let ball = english(hints.text(HintedWork::FigureUnderLargeBall));
        assert!(ball.is_some_and(|text| text.contains("Shift + 2")));
        let second = tool_bits_of(Tool::Rotary).nth(1);
        assert_eq!(second, Some(ToolBit::MediumBall), "which that key takes");
    }
}
