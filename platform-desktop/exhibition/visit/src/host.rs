//! The host of visits in a shell.

mod keeping;
mod pressing;
mod remote;

use glam::Vec3;
use paros_core::session::{PointerCommand, SessionMode, TICK_RATE, commands};
use paros_core::visit::{
    GuideStep, PanelAction, PlanSetting, Presence, Visit, VisitCommand, VisitInput, VisitPhase,
};
use paros_core::volume::{Grid, Size};
use paros_core::{TickInput, World, WorldEvent};
use paros_shaders::panel::{Language, Message, Panel, PanelPose};
use paros_shell::settings::plan_changes;

use crate::export_state::ExportState;
use crate::headset::HeadsetWatch;
use crate::lathe::LatheHand;
use crate::options::{Controls, VisitOptions};
use crate::pin_pad::PinPad;
use crate::pointing::{POINTERS, Pointer, Pointing};
use crate::previews::LivingPreviews;
use crate::queue::VisitQueue;
use crate::screen::{
    BoothTold, ButtonAction, GuideEnd, Question, Screen, ScreenState, is_at_work, point_in_room,
};
use crate::standing::PanelSpot;
use remote::RemoteWatch;
pub use remote::{DeviceStatus, answer_without_visits};

/// Ticks for which a warning of the remaining time is shown.
const WARNING_TICKS: u32 = 6 * TICK_RATE;

/// Turn of the stool by the button, and in a tick, in 65,536ths of a turn: an eighth in half a second.
const BUTTON_TURN: i16 = 8192;
const BUTTON_TURN_SPEED: i16 = 228;

/// The host of visits, between the core, which decides, and a shell.
#[derive(Debug)]
pub struct VisitHost {
    pub(crate) options: VisitOptions,
    queue: VisitQueue,
    pin_pad: Option<PinPad>,
    /// The source of random bits for provisional badges.
    random_bits: fn() -> u32,
    question: Question,
    lathe: LatheHand,
    pub(crate) previews: LivingPreviews,
    pub(crate) pointing: Pointing,
    pub(crate) screen: Screen,
    pub(crate) headset: HeadsetWatch,
    /// The shown message about the remaining time, and the number of ticks for which it stays.
    told: Option<(Message, u32)>,
    /// `true` in the guided phase.
    is_guided: bool,
    /// The end of the guided first cut, and the number of ticks for which its message stays.
    guide_end: Option<(GuideEnd, u32)>,
    /// The rest of the stool's turn that a button requested, not yet sent in a tick.
    turn_left: i16,
    undoes: bool,
    recentres: bool,
    /// `true` once the badge of this visit was sent. `has_sent_export` is the same for the end of the export.
    has_sent_badge: bool,
    has_sent_export: bool,
    remote: RemoteWatch,
    /// Seconds for which the program slept or didn't run, not yet sent to the visit.
    away_seconds: u16,
}

impl VisitHost {
    /// Makes the host of a world. Starts visits there, or resumes the world's visit.
    #[must_use]
    pub fn new(options: VisitOptions, visit: &Visit) -> Self {
        let mut queue = VisitQueue::default();
        if visit.phase() == VisitPhase::Closed {
            queue.open(&options.plan);
        } else {
            plan_changes(visit.plan(), &options.plan).for_each(|command| queue.push(command));
        }
        VisitHost {
            pin_pad: options.staff_pin.map(PinPad::new),
            random_bits: keeping::random_bits_of_system,
            options,
            queue,
            question: Question::None,
            lathe: LatheHand::default(),
            previews: LivingPreviews::default(),
            pointing: Pointing::default(),
            screen: Screen::new(),
            headset: HeadsetWatch::default(),
            told: None,
            is_guided: visit.phase() == VisitPhase::Guided,
            guide_end: None,
            turn_left: 0,
            undoes: false,
            recentres: false,
            has_sent_badge: false,
            has_sent_export: false,
            remote: RemoteWatch::of_visit(visit.phase()),
            away_seconds: 0,
        }
    }

    /// Restarts visits in an empty world, whatever visit was found there.
    pub fn begin_anew(&mut self) {
        self.queue.open(&self.options.plan);
    }

    /// Sets the controls that visitors use now.
    pub(crate) const fn set_controls(&mut self, controls: Controls) {
        self.options.controls = controls;
    }

    /// Adds seconds for which the program slept, or didn't run, without use.
    pub(crate) const fn note_away(&mut self, seconds: u16) {
        self.away_seconds = self.away_seconds.saturating_add(seconds);
    }

    /// Processes the poses of hands, rays and cursor, and performs what they press. Call this before each
    /// tick, after the panels were placed.
    pub fn follow_pointers(&mut self, visit: &Visit, pointers: &[Option<Pointer>; POINTERS]) {
        // While a question is open, the visitor looks at it.
        let is_at_work = visit.phase().lets_hands_work() && self.question == Question::None;
        let is_stone_between = is_at_work && self.options.controls != Controls::Mouse;
        let (panels, buttons) = (self.screen.panels(), self.screen.buttons());
        let pressed = self.pointing.follow(pointers, panels, buttons, is_stone_between);
        if let Some(action) = pressed.and_then(|id| self.screen.action(id)) {
            self.perform(action);
        }
    }

    /// Returns `true` if a ray meets a panel. A press along the ray is then not for anything behind it.
    #[must_use]
    pub fn covers_ray(&self, origin: Vec3, direction: Vec3) -> bool {
        self.panels().iter().any(|panel| panel.intersect_ray(origin, direction).is_some())
    }

    /// Adds the visit's messages and the requests of buttons to a tick's input. In the attract phase, the
    /// host moves the hands.
    pub fn fill_input<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        (presence, is_used): (Presence, bool),
        input: &mut TickInput,
    ) where
        Grid<N>: Size,
    {
        let phase = world.visit().phase();
        for (hand, state) in input.hands.iter_mut().enumerate() {
            let known = world.hand_state(hand);
            // A hand that pulls, or waits for its release, isn't released by a glance at a button.
            let is_pulled = known.trigger || known.awaits_release;
            if self.pointing.is_on_button(hand) && !is_pulled {
                state.trigger = 0;
            }
        }
        if phase == VisitPhase::Attract {
            self.lathe.fill_input(world, input);
        }
        if core::mem::take(&mut self.undoes) {
            input.commands |= commands::UNDO;
        }
        if self.turn_left != 0 && input.pointer == PointerCommand::None {
            let by = self.turn_left.clamp(-BUTTON_TURN_SPEED, BUTTON_TURN_SPEED);
            self.turn_left -= by;
            input.pointer = PointerCommand::Turn { by };
        }
        let command = match core::mem::take(&mut self.away_seconds) {
            0 => self.queue.take(),
            seconds => VisitCommand::Away { seconds },
        };
        self.remote.note_tick(phase, presence, is_used);
        input.visit = VisitInput { presence, is_used, command };
        // The visit decides how a session starts.
        input.start = SessionMode::None;
    }

    /// Applies the results of a tick, and lays out the panels.
    pub fn follow_tick<const N: usize, const K: usize>(
        &mut self,
        world: &World<N, K>,
        export: &ExportState,
    ) where
        Grid<N>: Size,
    {
        let visit = world.visit();
        for event in world.events() {
            match event {
                WorldEvent::Visit(phase) => self.enter_phase(*phase, visit),
                WorldEvent::TimeLeft { seconds } => {
                    self.told = warning_of(*seconds).map(|message| (message, WARNING_TICKS));
                }
                _ => {}
            }
        }
        self.told = self.told.and_then(|(message, left)| Some((message, left.checked_sub(1)?)));
        if self.question == Question::None {
            // The timeout pauses while a question hides the message.
            self.guide_end =
                self.guide_end.and_then(|(end, left)| Some((end, left.checked_sub(1)?)));
        }
        let is_staffs = matches!(self.question, Question::Pin | Question::Staff);
        if self.pin_pad.as_mut().is_some_and(PinPad::is_left_after_tick) && is_staffs {
            self.ask(Question::None);
        }
        match visit.phase() {
            VisitPhase::Attract if self.lathe.is_done() => {
                self.lathe = LatheHand::default();
                self.begin_anew();
            }
            VisitPhase::Choice if self.options.starts.len() < 2 => {
                // There is no choice with fewer than two starts.
                let confirm = VisitCommand::Press(PanelAction::Confirm);
                if !self.queue.contains(&confirm) {
                    self.queue.push(confirm);
                }
            }
            VisitPhase::Export => self.follow_export(visit, export),
            _ => {}
        }
        self.previews.follow_tick(visit.phase(), &self.options.starts);
        self.draw(visit, export);
    }

    /// Returns the panels to draw: the shown panels, and the rays of hands on them.
    #[must_use]
    pub fn panels(&self) -> &[Panel] {
        self.screen.drawn_panels()
    }

    /// Returns the shown buttons: their actions as text, for tests and logs, and their centres in the room.
    pub fn buttons(&self) -> impl Iterator<Item = (String, Vec3)> {
        self.screen.buttons().iter().filter_map(|shown| {
            let action = self.screen.action(shown.button.id)?;
            let panel = &self.screen.panels()[shown.panel];
            Some((format!("{action:?}"), point_in_room(panel, shown.button.rect.middle())))
        })
    }

    /// Places the panels with a function of the shell, from a spot and a size in millimetres to a pose.
    pub fn place_panels(&mut self, pose: impl Fn(PanelSpot, [f32; 2]) -> PanelPose) {
        self.screen.place_panels(pose);
    }

    /// Returns `true` if a panel stands beside the sculpture. A window then moves the sculpture aside.
    #[must_use]
    pub fn is_beside_sculpture(&self) -> bool {
        self.screen.is_beside_sculpture()
    }

    /// Returns `true` if the guide's panel is shown: during the first cut, and while its end is read.
    #[must_use]
    pub const fn has_guide(&self) -> bool {
        self.is_guided || self.guide_end.is_some()
    }

    /// Asks the staff for its PIN, if there is one. Closes an open question or staff's panel instead.
    pub fn toggle_staff_panel(&mut self) {
        let opens = self.pin_pad.is_some() && self.question == Question::None;
        self.ask(if opens { Question::Pin } else { Question::None });
    }

    /// Asks if the sculpture is finished. If a question is open, closes it instead.
    pub fn toggle_finish_question(&mut self, visit: &Visit) {
        let asks = is_at_work(visit.phase()) && self.question == Question::None;
        self.ask(if asks { Question::Finish } else { Question::None });
    }

    /// Asks if the sculpture is finished. If this question is open already, answers it with yes.
    pub fn ask_or_confirm_finish(&mut self, visit: &Visit) {
        match self.question {
            Question::Finish => self.perform(ButtonAction::Press(PanelAction::Finish)),
            _ => self.toggle_finish_question(visit),
        }
    }

    /// Completes a step of the guide that a window's visitor has done, if no tick shows it: a bit that hovers
    /// over the stone touches nothing, and a view that orbits the stone turns no stool.
    pub fn note_step_done(&mut self, visit: &Visit, step: GuideStep) {
        let is_asked = visit.phase() == VisitPhase::Guided && visit.guide_step() == step;
        let done = VisitCommand::Press(PanelAction::Skip { all: false });
        if is_asked && !self.queue.contains(&done) {
            self.queue.push(done);
        }
    }

    /// Returns the visitor's language.
    #[must_use]
    pub fn language(&self, visit: &Visit) -> Language {
        self.options.language(visit.language())
    }

    /// Returns `true` if a question to the visitor or the staff is open.
    #[must_use]
    pub fn is_asking(&self) -> bool {
        self.question != Question::None
    }

    /// Closes the open question.
    pub fn drop_question(&mut self) {
        self.ask(Question::None);
    }

    /// Returns `true` once if the room is to be turned to the headset's wearer, when a visitor is welcomed or
    /// the staff asks for it.
    pub fn take_recentring(&mut self) -> bool {
        core::mem::take(&mut self.recentres)
    }

    fn enter_phase(&mut self, phase: VisitPhase, visit: &Visit) {
        // A question to the staff stays open, whatever the phase of the visit.
        if self.question == Question::Finish {
            self.ask(Question::None);
        }
        match phase {
            VisitPhase::Attract => {
                self.lathe = LatheHand::default();
                self.told = None;
                self.remote.end_visit();
            }
            VisitPhase::Welcome => {
                self.recentres = true;
                self.remote.begin_visit();
            }
            VisitPhase::Export => (self.has_sent_badge, self.has_sent_export) = (false, false),
            _ => {}
        }
        // If the guide is off, its phase still lasts for a tick.
        let has_guide = visit.plan().value(PlanSetting::Guided) > 0;
        let is_end = self.is_guided && phase == VisitPhase::Sculpting && has_guide;
        self.is_guided = phase == VisitPhase::Guided;
        self.guide_end = is_end.then(|| {
            let end = GuideEnd::of_visit(visit);
            (end, end.reading_ticks(self.language(visit)))
        });
        (self.turn_left, self.undoes) = (0, false);
    }

    fn draw(&mut self, visit: &Visit, export: &ExportState) {
        let pin = self.pin_pad.as_ref().map(PinPad::entry);
        let mut state = ScreenState::of_visit(visit, &self.options);
        state.question = self.question;
        state.warning = self.told.map(|(message, _)| message);
        state.guide_end = self.guide_end.map(|(end, _)| end);
        if state.phase == VisitPhase::Export {
            // The last percent is for writing the files.
            state.percent = (export.part.clamp(0.0, 1.0) * 99.0) as u32;
        }
        state.pending = export.pending;
        state.booth = BoothTold::of_export(export);
        state.is_glowing = self.remote.is_glowing();
        state.pin = pin.unwrap_or(state.pin);
        if self.screen.is_another(&state) {
            self.pointing.forget_buttons();
            self.headset.take_eyes_anew();
        }
        if self.screen.draw(&state, self.pointing.hot_buttons(), &self.options) {
            self.pointing.forget_buttons();
            self.screen.draw(&state, self.pointing.hot_buttons(), &self.options);
        }
    }
}

/// Closes a visit that a save has from an earlier run with visits, for a shell without visits. An open visit
/// would hand over the sculpture, as no presence is reported.
pub fn close_visits(visit: &Visit, input: &mut TickInput) {
    if visit.phase() != VisitPhase::Closed {
        input.visit.command = VisitCommand::Close;
    }
}

/// Returns the warning for a number of remaining seconds.
const fn warning_of(seconds: u16) -> Option<Message> {
    match seconds {
        120 => Some(Message::WarningTwoMinutes),
        30 => Some(Message::WarningThirtySeconds),
        10 => Some(Message::WarningTenSeconds),
        _ => None,
    }
}

#[cfg(test)]
mod tests;
