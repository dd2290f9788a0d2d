//! What holds visits in a shell.

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

/// For how long a visitor is told of the time that is left, in ticks.
const WARNING_TICKS: u32 = 6 * TICK_RATE;

/// How far the button turns the stool, and how far in a tick, in 65,536ths of a turn: an eighth in half a second.
const BUTTON_TURN: i16 = 8192;
const BUTTON_TURN_SPEED: i16 = 228;

/// Holds visits: between the core, which decides, and a shell.
#[derive(Debug)]
pub struct VisitHost {
    pub(crate) options: VisitOptions,
    queue: VisitQueue,
    pin_pad: Option<PinPad>,
    /// For badges.
    random_bits: fn() -> u32,
    question: Question,
    lathe: LatheHand,
    pub(crate) previews: LivingPreviews,
    pub(crate) pointing: Pointing,
    pub(crate) screen: Screen,
    pub(crate) headset: HeadsetWatch,
    /// What the visitor is told of the time, and for how many ticks more.
    told: Option<(Message, u32)>,
    /// The phase is the guided one.
    is_guided: bool,
    /// How the first cut ended, and for how many ticks more that is told.
    guide_end: Option<(GuideEnd, u32)>,
    /// Turn of the stool that a button has asked for and no tick has taken yet.
    turn_left: i16,
    undoes: bool,
    recentres: bool,
    /// The badge of this visit has been sent, and the export's end.
    has_sent_badge: bool,
    has_sent_export: bool,
    remote: RemoteWatch,
    /// Seconds for which the program slept or didn't run, not sent yet.
    away_seconds: u16,
}

impl VisitHost {
    /// A host of a world: visits begin there, or go on where they are.
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

    /// Has visits begin anew, in an empty world, whatever visit was found there.
    pub fn begin_anew(&mut self) {
        self.queue.open(&self.options.plan);
    }

    /// Takes in what visitors work with now.
    pub(crate) const fn set_controls(&mut self, controls: Controls) {
        self.options.controls = controls;
    }

    /// Takes in that the program slept, or didn't run, for so many seconds in which nobody used it.
    pub(crate) const fn note_away(&mut self, seconds: u16) {
        self.away_seconds = self.away_seconds.saturating_add(seconds);
    }

    /// Takes in where hands, rays and cursor are, after the panels were put where they stand. Does what they press.
    /// Call it before each tick.
    pub fn follow_pointers(&mut self, visit: &Visit, pointers: &[Option<Pointer>; POINTERS]) {
        // Who is asked something looks at the question.
        let is_at_work = visit.phase().lets_hands_work() && self.question == Question::None;
        let is_stone_between = is_at_work && self.options.controls != Controls::Mouse;
        let (panels, buttons) = (self.screen.panels(), self.screen.buttons());
        let pressed = self.pointing.follow(pointers, panels, buttons, is_stone_between);
        if let Some(action) = pressed.and_then(|id| self.screen.action(id)) {
            self.perform(action);
        }
    }

    /// Whether a ray meets a panel: then a press is not for what lies behind it.
    #[must_use]
    pub fn covers_ray(&self, origin: Vec3, direction: Vec3) -> bool {
        self.panels().iter().any(|panel| panel.intersect_ray(origin, direction).is_some())
    }

    /// Puts into a tick's input what the visit is told, and what buttons ask for. While nobody is there the hands are
    /// the host's own.
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
            // One that waits for its release isn't let go by a glance at a button.
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
        // How a session starts is the visit's to say.
        input.start = SessionMode::None;
    }

    /// Takes in what a tick did, and lays the panels out that show it.
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
            // A question hides it.
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
                // There is nothing to choose.
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

    /// The panels to be drawn: those that are shown, and the rays of hands on them.
    #[must_use]
    pub fn panels(&self) -> &[Panel] {
        self.screen.drawn_panels()
    }

    /// The buttons that are shown: what they do, for tests and logs, and where their middles are in the room.
    pub fn buttons(&self) -> impl Iterator<Item = (String, Vec3)> {
        self.screen.buttons().iter().filter_map(|shown| {
            let action = self.screen.action(shown.button.id)?;
            let panel = &self.screen.panels()[shown.panel];
            Some((format!("{action:?}"), point_in_room(panel, shown.button.rect.middle())))
        })
    }

    /// Puts the panels where a shell has them stand, by their spots and sizes in millimetres.
    pub fn place_panels(&mut self, pose: impl Fn(PanelSpot, [f32; 2]) -> PanelPose) {
        self.screen.place_panels(pose);
    }

    /// Whether a panel stands beside the sculpture, and a window moves that aside for it.
    #[must_use]
    pub fn is_beside_sculpture(&self) -> bool {
        self.screen.is_beside_sculpture()
    }

    /// Whether the guide has its panel: at the first cut, and until its end is read.
    #[must_use]
    pub const fn has_guide(&self) -> bool {
        self.is_guided || self.guide_end.is_some()
    }

    /// Asks the staff for its PIN, if there is one; a panel of the staff's that is open is shut.
    pub fn toggle_staff_panel(&mut self) {
        let opens = self.pin_pad.is_some() && self.question == Question::None;
        self.ask(if opens { Question::Pin } else { Question::None });
    }

    /// Asks the visitor whether the sculpture is ready, or no longer does.
    pub fn toggle_finish_question(&mut self, visit: &Visit) {
        let asks = is_at_work(visit.phase()) && self.question == Question::None;
        self.ask(if asks { Question::Finish } else { Question::None });
    }

    /// Asks the visitor whether the sculpture is ready; where that is being asked, it is.
    pub fn ask_or_confirm_finish(&mut self, visit: &Visit) {
        match self.question {
            Question::Finish => self.perform(ButtonAction::Press(PanelAction::Finish)),
            _ => self.toggle_finish_question(visit),
        }
    }

    /// Takes in that a window's visitor has done what a step of the guide asks for, where no tick tells: a bit that rests
    /// over the stone touches nothing, and an eye that goes round it turns no stool.
    pub fn note_step_done(&mut self, visit: &Visit, step: GuideStep) {
        let is_asked = visit.phase() == VisitPhase::Guided && visit.guide_step() == step;
        let done = VisitCommand::Press(PanelAction::Skip { all: false });
        if is_asked && !self.queue.contains(&done) {
            self.queue.push(done);
        }
    }

    /// The visitor's language.
    #[must_use]
    pub fn language(&self, visit: &Visit) -> Language {
        self.options.language(visit.language())
    }

    /// Whether something is asked, of the visitor or the staff.
    #[must_use]
    pub fn is_asking(&self) -> bool {
        self.question != Question::None
    }

    /// Asks nothing more.
    pub fn drop_question(&mut self) {
        self.ask(Question::None);
    }

    /// Whether the room is to be turned to who wears the headset, as a visitor is welcome or the staff asks for it; told
    /// once.
    pub fn take_recentring(&mut self) -> bool {
        core::mem::take(&mut self.recentres)
    }

    fn enter_phase(&mut self, phase: VisitPhase, visit: &Visit) {
        // The staff is asked on, whatever the visitor's time does.
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
        // Where the first cut is left out, a tick of it passes all the same.
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
            // The last hundredth is writing it.
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

/// Where a shell holds no visits: closes the one that a save has from a run that did. Left open it would hand the
/// sculpture over, as nobody is told to be there.
pub fn close_visits(visit: &Visit, input: &mut TickInput) {
    if visit.phase() != VisitPhase::Closed {
        input.visit.command = VisitCommand::Close;
    }
}

/// How a visitor is told of the seconds left.
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
