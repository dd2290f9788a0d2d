//! The guided first cut: its steps, and the message at its end.

use paros_core::session::TICK_RATE;
use paros_core::visit::{GuideStep, PanelAction, Visit};
use paros_shaders::panel::layout::{self, Guide};
use paros_shaders::panel::{Icon, Language, Message};

use super::{ButtonAction, Screen, ScreenState};
use crate::options::Controls;
use crate::standing::PanelSpot;

/// Ticks until a visitor who looks at the stone has noticed a text.
const NOTICED_TICKS: u32 = 2 * TICK_RATE;

/// Reading speed in letters a second, as for children's subtitles.
const LETTERS_A_SECOND: u32 = 12;

/// The end of the guided first cut.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum GuideEnd {
    /// All steps are done.
    Done,
    /// The time of the first cut is over.
    TimeOver,
}

impl GuideEnd {
    /// Returns the end of a visit's first cut, which has just ended.
    pub(crate) fn of_visit(visit: &Visit) -> Self {
        match visit.guide_step() {
            GuideStep::Done => GuideEnd::Done,
            _ => GuideEnd::TimeOver,
        }
    }

    /// Returns the ticks for which the message is shown, so that it can be read.
    pub(crate) fn reading_ticks(self, language: Language) -> u32 {
        let (message, _) = self.text();
        let letters = message.text(language).chars().count() as u32;
        NOTICED_TICKS + letters * TICK_RATE / LETTERS_A_SECOND
    }

    const fn text(self) -> (Message, Icon) {
        match self {
            GuideEnd::Done => (Message::GuideDone, Icon::Tick),
            GuideEnd::TimeOver => (Message::GuideOver, Icon::Stone),
        }
    }
}

impl Screen {
    /// Draws the instruction of the current step.
    pub(super) fn draw_guide(&mut self, state: &ScreenState) {
        let skip = ButtonAction::Press(PanelAction::Skip { all: false });
        let buttons = layout::guide_buttons(0).map(|button| (button, skip));
        let guide = guide_of(state, guide_text(state.step, state.controls));
        self.add(PanelSpot::Guide, &buttons, |panel, buttons| {
            layout::draw_guide(panel, state.language, &guide, buttons);
        });
    }

    /// Draws the message at the end of the first cut, in place of an instruction.
    pub(super) fn draw_guide_end(&mut self, state: &ScreenState, end: GuideEnd) {
        let guide = guide_of(state, end.text());
        self.add(PanelSpot::Guide, &[], |panel, _| {
            layout::draw_guide(panel, state.language, &guide, &[]);
        });
    }
}

fn guide_of(state: &ScreenState, (instruction, icon): (Message, Icon)) -> Guide {
    let steps = GuideStep::Done as u32;
    let step = (state.step as u32 + 1).min(steps);
    let progress = if state.step == GuideStep::Done { 1.0 } else { 0.0 };
    Guide { instruction, icon, step, steps, progress }
}

/// Returns the instruction of a step for the visitor's controls.
const fn guide_text(step: GuideStep, controls: Controls) -> (Message, Icon) {
    match (step, controls) {
        (GuideStep::TakeTool, Controls::Controllers) => (Message::GuideTake, Icon::Tool),
        (GuideStep::TakeTool, Controls::BareHands) => (Message::GuideTakeBare, Icon::Tool),
        (GuideStep::TakeTool, Controls::Mouse) => (Message::GuideTakeMouse, Icon::Tool),
        (GuideStep::Touch, Controls::Mouse) => (Message::GuideTouchMouse, Icon::Stone),
        (GuideStep::Touch, _) => (Message::GuideTouch, Icon::Stone),
        (GuideStep::Cut, Controls::Controllers) => (Message::GuideCut, Icon::Trigger),
        (GuideStep::Cut, Controls::BareHands) => (Message::GuideCutBare, Icon::RightHand),
        (GuideStep::Cut, Controls::Mouse) => (Message::GuideCutMouse, Icon::Tool),
        (GuideStep::Smooth, _) => (Message::GuideSmooth, Icon::Smooth),
        (GuideStep::Undo, Controls::Controllers) => (Message::GuideUndo, Icon::Undo),
        (GuideStep::Undo, _) => (Message::GuideUndoButton, Icon::Undo),
        (GuideStep::TurnStool, Controls::Controllers) => (Message::GuideTurn, Icon::Turn),
        (GuideStep::TurnStool, Controls::BareHands) => (Message::GuideTurnBare, Icon::Turn),
        (GuideStep::TurnStool, Controls::Mouse) => (Message::GuideTurnMouse, Icon::Turn),
        (GuideStep::Done, _) => GuideEnd::Done.text(),
    }
}
