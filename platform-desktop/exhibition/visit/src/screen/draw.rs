//! The layout of the panels.

use std::mem;

use paros_core::badge::BadgeNumber;
use paros_core::visit::{PanelAction, StaffCommand, VisitPhase};
use paros_protocol::UploadStatus;
use paros_shaders::panel::layout::{self, Clock, HandoverTold, PanelNotice, palette};
use paros_shaders::panel::{
    ButtonState, FillingValue, Icon, Language, Message, Panel, PanelButton,
};

use super::{ButtonAction, MAX_PANELS, Question, Screen, ScreenState, is_at_work};
use crate::cards::card_of_start;
use crate::options::{Controls, VisitOptions};
use crate::pointing::{POINTERS, ShownButton};
use crate::previews::cell_of_card;
use crate::standing::PanelSpot;

impl Screen {
    /// Lays the panels out again if their state has changed. Returns `true` if the buttons or their places
    /// have changed, as visitors haven't aimed at the new ones.
    pub(crate) fn draw(
        &mut self,
        state: &ScreenState,
        hot: [Option<u16>; POINTERS],
        options: &VisitOptions,
    ) -> bool {
        if self.drawn == Some((*state, hot)) {
            return false;
        }
        self.drawn = Some((*state, hot));
        (self.count, self.ray_panels) = (0, 0);
        let (buttons, actions) = (mem::take(&mut self.buttons), mem::take(&mut self.actions));
        let seconds = state.seconds_to_gone.filter(|_| state.is_asked_to_stay());
        match (state.question, seconds) {
            (Question::None, _) if state.is_glowing => self.draw_identify(state),
            (Question::Pin, _) => self.draw_pin(state),
            (Question::Staff, _) => self.draw_staff(state),
            (_, Some(seconds)) => self.draw_countdown(state, seconds),
            (Question::Finish, None) => self.draw_finish_question(state),
            (Question::None, None) => self.draw_phase(state, options),
        }
        // Beside a question these buttons would be pressed by mistake, and partly covered in a window.
        if is_at_work(state.phase)
            && state.question == Question::None
            && seconds.is_none()
            && !state.is_glowing
        {
            self.draw_clock(state);
            if let Some(end) = state.guide_end {
                self.draw_guide_end(state, end);
            }
        }
        for shown in &self.buttons {
            if hot.contains(&Some(shown.button.id)) && shown.button.state == ButtonState::Idle {
                let button = shown.button.in_state(ButtonState::Hot);
                self.panels[shown.panel].add_button(state.language, &button);
            }
        }
        let place = |shown: &ShownButton| (shown.panel, shown.button.rect);
        self.actions != actions || !self.buttons.iter().map(place).eq(buttons.iter().map(place))
    }

    fn draw_phase(&mut self, state: &ScreenState, options: &VisitOptions) {
        match state.phase {
            VisitPhase::Closed | VisitPhase::Sculpting => {}
            VisitPhase::Attract => {
                let (icon, body) = match state.controls {
                    Controls::Mouse => (Icon::Stone, Message::AttractBodyMouse),
                    Controls::Controllers | Controls::BareHands => {
                        (Icon::Headset, Message::AttractBody)
                    }
                };
                self.add(PanelSpot::Caption, &[], |panel, _| {
                    layout::draw_attract(panel, icon, body);
                });
            }
            VisitPhase::Welcome => self.draw_welcome(state, options),
            VisitPhase::Choice => self.draw_choice(state, options),
            VisitPhase::Guided => self.draw_guide(state),
            VisitPhase::HandsOff => {
                let what = match state.is_time_up {
                    true => (Icon::HandsOff, Message::HandsOffTitle, Message::HandsOffBody),
                    false => (Icon::Tick, Message::HandsOffReadyTitle, Message::HandsOffReadyBody),
                };
                self.draw_notice(state, PanelSpot::Beside, what, None);
            }
            VisitPhase::Export => {
                let (title, body) = (Message::ExportingTitle, Message::ExportingBody);
                let progress = Some(state.percent as f32 * 0.01);
                self.draw_notice(state, PanelSpot::Beside, (Icon::Printer, title, body), progress);
            }
            VisitPhase::Badge => self.draw_badge(state),
            VisitPhase::Thanks => self.draw_thanks(state),
            VisitPhase::Handover => {
                let button = match state.controls {
                    // A window needs no cleaning.
                    Controls::Mouse => new_visit_button(),
                    Controls::Controllers | Controls::BareHands => {
                        let cleaned = layout::notice_button(0, Message::HandoverCleaned, 0, 1);
                        (cleaned.primary(), ButtonAction::Cleaned)
                    }
                };
                self.add(PanelSpot::Main, &[button], |panel, buttons| {
                    layout::draw_handover(panel, state.language, handover_of(state), buttons);
                });
            }
        }
    }

    /// Draws the thanks beside the sculpture. A window can't detect that its visitor leaves: the next visitor
    /// presses a button.
    fn draw_thanks(&mut self, state: &ScreenState) {
        let is_mouse = state.controls == Controls::Mouse;
        let body = match state.seconds_to_gone {
            Some(_) => Message::ThanksNextMouse,
            None if is_mouse => Message::ThanksBodyMouse,
            None => Message::ThanksBody,
        };
        let notice = PanelNotice {
            icon: Icon::Badge,
            color: palette::CLAY,
            title: Message::ThanksTitle,
            body,
            fillings: &[("seconds", FillingValue::Number(state.seconds_to_gone.unwrap_or(0)))],
            progress: None,
        };
        let new_visit = [new_visit_button()];
        let buttons = if is_mouse { &new_visit[..] } else { &[] };
        self.add(PanelSpot::Caption, buttons, |panel, buttons| {
            layout::draw_notice(panel, state.language, &notice, buttons);
        });
    }

    fn draw_welcome(&mut self, state: &ScreenState, options: &VisitOptions) {
        let numbers = Language::ALL.map(|language| {
            options.languages.iter().position(|offered| *offered == language).map(|k| k as u8)
        });
        let [english, greek] = numbers;
        let press = |action| Some(ButtonAction::Press(action));
        let language = |number: Option<u8>| press(PanelAction::Language(number?));
        let actions = [
            language(english),
            language(greek),
            press(PanelAction::WorkingHand(0)),
            press(PanelAction::WorkingHand(1)),
            press(PanelAction::Seated(true)),
            press(PanelAction::Seated(false)),
            press(PanelAction::Confirm),
        ];
        let chosen = [
            english == Some(state.language_number),
            greek == Some(state.language_number),
            state.working_hand == 0,
            state.working_hand == 1,
            state.is_seated,
            !state.is_seated,
            false,
        ];
        // A mouse has no left or right hand, and its visitor needs no height setting.
        let is_mouse = state.controls == Controls::Mouse;
        let questions = if is_mouse { 1 } else { 3 };
        let mut buttons = Vec::with_capacity(actions.len());
        let all = layout::welcome_buttons(0, questions).into_iter().zip(actions).zip(chosen);
        for (k, ((button, action), chosen)) in all.enumerate() {
            if is_mouse && (2..6).contains(&k) {
                continue;
            }
            let look = match action {
                None => ButtonState::Off,
                Some(_) if chosen => ButtonState::Chosen,
                Some(_) => ButtonState::Idle,
            };
            let nothing = ButtonAction::Ask(Question::None);
            buttons.push((button.in_state(look), action.unwrap_or(nothing)));
        }
        self.add(PanelSpot::Main, &buttons, |panel, buttons| {
            layout::draw_welcome(panel, state.language, questions, buttons);
        });
    }

    fn draw_choice(&mut self, state: &ScreenState, options: &VisitOptions) {
        let cards: Vec<_> = options.starts.iter().map(|start| card_of_start(*start)).collect();
        let buttons = layout::choice_buttons(0, &cards).into_iter().zip(&options.starts);
        let buttons: Vec<_> = buttons
            .enumerate()
            .map(|(place, (button, start))| {
                let cell = cell_of_card(place, *start);
                let card = cell.map_or(button, |cell| button.with_cell(cell));
                (card, ButtonAction::Choose(*start))
            })
            .collect();
        self.add(PanelSpot::Main, &buttons, |panel, buttons| {
            layout::draw_choice(panel, state.language, Message::ChoiceTitle, buttons);
        });
    }

    /// Draws the clock and its buttons beside the stone.
    fn draw_clock(&mut self, state: &ScreenState) {
        let clock = Clock { seconds: state.seconds, warning: state.warning };
        let labels = [
            (Message::UndoStroke, Icon::Undo),
            (Message::TurnStone, Icon::Turn),
            (Message::PutBack, Icon::PutBack),
            (Message::Ready, Icon::Tick),
        ];
        let actions = [
            ButtonAction::Undo,
            ButtonAction::Turn,
            ButtonAction::Press(PanelAction::PutBack),
            ButtonAction::Ask(Question::Finish),
        ];
        let rows: Vec<_> = clock.buttons(0, labels).into_iter().zip(actions).collect();
        self.add(PanelSpot::Side, &rows, |panel, buttons| {
            layout::draw_clock(panel, state.language, &clock, buttons);
        });
    }

    fn draw_finish_question(&mut self, state: &ScreenState) {
        let [yes, no] = [
            layout::notice_button(0, Message::Yes, 0, 2),
            layout::notice_button(0, Message::No, 1, 2),
        ];
        let buttons = [
            (yes, ButtonAction::Press(PanelAction::Finish)),
            (no, ButtonAction::Ask(Question::None)),
        ];
        let notice = PanelNotice {
            icon: Icon::Tick,
            color: palette::OLIVE,
            title: Message::FinishTitle,
            body: Message::FinishBody,
            fillings: &[],
            progress: None,
        };
        self.add(PanelSpot::Beside, &buttons, |panel, buttons| {
            layout::draw_notice(panel, state.language, &notice, buttons);
        });
    }

    /// Draws the warning of an idle visitor: the visit ends in `seconds` seconds.
    fn draw_countdown(&mut self, state: &ScreenState, seconds: u32) {
        let is_kept = is_at_work(state.phase) && state.is_sculpted;
        let body = if is_kept { Message::StillHereKept } else { Message::StillHereNext };
        let notice = PanelNotice {
            icon: Icon::Hourglass,
            color: palette::AMBER,
            title: Message::StillHereTitle,
            body,
            fillings: &[("seconds", FillingValue::Number(seconds))],
            progress: None,
        };
        let is_begun = !matches!(state.phase, VisitPhase::Welcome | VisitPhase::Choice);
        let spot = if is_begun { PanelSpot::Beside } else { PanelSpot::Main };
        self.add(spot, &[], |panel, _| {
            layout::draw_notice(panel, state.language, &notice, &[]);
        });
    }

    fn draw_notice(
        &mut self,
        state: &ScreenState,
        spot: PanelSpot,
        (icon, title, body): (Icon, Message, Message),
        progress: Option<f32>,
    ) {
        let fillings = [("percent", FillingValue::Number(state.percent))];
        let color = palette::CLAY;
        let notice = PanelNotice { icon, color, title, body, fillings: &fillings, progress };
        self.add(spot, &[], |panel, _| layout::draw_notice(panel, state.language, &notice, &[]));
    }

    fn draw_badge(&mut self, state: &ScreenState) {
        let Some(number) = state.badge.and_then(BadgeNumber::new) else { return };
        let next = ButtonAction::Press(PanelAction::Confirm);
        let buttons = layout::badge_buttons(0).map(|button| (button.primary(), next));
        let buttons = if state.may_leave_badge { &buttons[..] } else { &[] };
        self.add(PanelSpot::Beside, buttons, |panel, buttons| {
            let told = (&number.badge(), badge_body(state));
            layout::draw_badge(panel, state.language, told, buttons);
        });
    }

    /// Draws the bright panel by which staff identify the device, even from outside.
    fn draw_identify(&mut self, state: &ScreenState) {
        let notice = PanelNotice {
            icon: Icon::Warning,
            color: palette::AMBER,
            title: Message::IdentifyTitle,
            body: Message::IdentifyBody,
            fillings: &[],
            progress: None,
        };
        let spot = if is_at_work(state.phase) { PanelSpot::Caption } else { PanelSpot::Main };
        self.add(spot, &[], |panel, _| {
            layout::draw_notice(panel, state.language, &notice, &[]);
        });
    }

    fn draw_pin(&mut self, state: &ScreenState) {
        let actions = (1..=9).map(ButtonAction::Digit).chain([
            ButtonAction::Erase,
            ButtonAction::Digit(0),
            ButtonAction::Ask(Question::None),
        ]);
        let buttons: Vec<_> = layout::pin_buttons(0).into_iter().zip(actions).collect();
        self.add(PanelSpot::Main, &buttons, |panel, buttons| {
            layout::draw_staff_pin(panel, state.language, state.pin, buttons);
        });
    }

    fn draw_staff(&mut self, state: &ScreenState) {
        let actions = [
            ButtonAction::Staff(StaffCommand::Extend),
            ButtonAction::Staff(StaffCommand::End),
            ButtonAction::Staff(StaffCommand::Reset),
            ButtonAction::Recentre,
            ButtonAction::Ask(Question::None),
        ];
        let buttons: Vec<_> = layout::staff_buttons(0).into_iter().zip(actions).collect();
        self.add(PanelSpot::Main, &buttons, |panel, buttons| {
            layout::draw_staff(panel, state.language, buttons);
        });
    }

    /// Adds a panel and its buttons, which get new numbers among all buttons.
    pub(super) fn add(
        &mut self,
        spot: PanelSpot,
        buttons: &[(PanelButton<'static>, ButtonAction)],
        draw: impl FnOnce(&mut Panel, &[PanelButton<'static>]),
    ) {
        debug_assert!(self.count < MAX_PANELS, "a panel too many");
        let (first, panel) = (self.actions.len(), self.count);
        let drawn: Vec<_> = (first..)
            .zip(buttons)
            .map(|(id, (button, _))| PanelButton { id: id as u16, ..*button })
            .collect();
        self.actions.extend(buttons.iter().map(|(_, action)| *action));
        draw(&mut self.panels[panel], &drawn);
        self.buttons.extend(drawn.into_iter().map(|button| ShownButton { panel, button }));
        self.spots[panel] = spot;
        self.count += 1;
    }
}

/// Returns the button with which a window's next visitor starts.
fn new_visit_button() -> (PanelButton<'static>, ButtonAction) {
    (layout::notice_button(0, Message::NewVisit, 0, 1).primary(), ButtonAction::NewVisit)
}

/// Returns the text below a badge: where the sculpture is stored.
fn badge_body(state: &ScreenState) -> Message {
    match state.booth.and_then(|booth| booth.status) {
        Some(UploadStatus::Kept) => Message::BadgeOnItsWay,
        Some(UploadStatus::Refused) => Message::BadgeKeptHere,
        Some(UploadStatus::Sent) => Message::BadgeKeptAtBooth,
        Some(UploadStatus::Lost) => Message::BadgeLost,
        None | Some(UploadStatus::Making | UploadStatus::Waiting) => Message::BadgeBody,
    }
}

fn handover_of(state: &ScreenState) -> HandoverTold {
    HandoverTold {
        pending: state.pending,
        owed: state.booth.map(|booth| booth.owed),
        is_nearly_full: state.booth.is_some_and(|booth| booth.is_nearly_full),
    }
}
