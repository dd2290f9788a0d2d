//! The actions of pressed buttons.

use paros_core::visit::{PanelAction, StaffCommand, VisitCommand};
use paros_shaders::panel::Message;

use super::{BUTTON_TURN, VisitHost, WARNING_TICKS};
use crate::pin_pad::PinPad;
use crate::screen::{ButtonAction, Question};

impl VisitHost {
    pub(super) fn ask(&mut self, question: Question) {
        self.question = question;
        if let Some(pad) = &mut self.pin_pad {
            pad.forget();
        }
    }

    pub(super) fn perform(&mut self, action: ButtonAction) {
        match action {
            ButtonAction::Press(pressed) => {
                self.queue.push(VisitCommand::Press(pressed));
                if pressed == PanelAction::Finish {
                    self.ask(Question::None);
                }
            }
            ButtonAction::Choose(start) => {
                self.queue.push(VisitCommand::Press(PanelAction::Start(start)));
                self.queue.push(VisitCommand::Press(PanelAction::Confirm));
            }
            ButtonAction::Staff(command) => {
                self.queue.push(VisitCommand::Staff(command));
                if command == StaffCommand::Extend {
                    self.told = Some((Message::Extended, WARNING_TICKS));
                }
                self.ask(Question::None);
            }
            ButtonAction::Recentre => {
                self.recentres = true;
                self.ask(Question::None);
            }
            ButtonAction::Ask(question) => self.ask(question),
            ButtonAction::Digit(digit) => {
                if self.pin_pad.as_mut().is_some_and(|pad| pad.press_digit(digit)) {
                    self.ask(Question::Staff);
                }
            }
            ButtonAction::Erase => self.pin_pad.iter_mut().for_each(PinPad::erase),
            ButtonAction::Undo => self.undoes = true,
            ButtonAction::Turn => self.turn_left = self.turn_left.saturating_add(BUTTON_TURN),
            ButtonAction::Cleaned | ButtonAction::NewVisit => self.begin_anew(),
        }
    }
}
