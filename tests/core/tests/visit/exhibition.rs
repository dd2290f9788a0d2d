//! A visit that is driven and observed in a world, tick by tick, beside its model.

use std::sync::{Mutex, MutexGuard, PoisonError};

use glam::{Quat, Vec3};
use paros_core::edit::Pose;
use paros_core::session::{BenchItem, PointerCommand, TICK_RATE, Tool, ToolBit, commands};
use paros_core::visit::{PanelAction, PlanSetting, Presence, VisitCommand, VisitInput, VisitPhase};
use paros_core::{HandInput, TickInput, WorldEvent};
use paros_models::scripted_hand::RIGHT;
use paros_models::visit::{Expected, SeenTick, VisitModel};
use paros_models::world_harness::WorldHarness;

pub(crate) const N: usize = 32;

static HARNESS: Mutex<WorldHarness<N>> = Mutex::new(WorldHarness::new());

/// A hand's action for some ticks.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Deed {
    Nothing,
    Take(u8),
    Cut,
    /// Cuts at a fresh place.
    CutAside,
    Undo,
    Turn,
}

/// Some ticks with constant presence, use and deed, and a command in the first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stretch {
    pub(crate) ticks: u32,
    pub(crate) presence: Presence,
    pub(crate) is_used: bool,
    pub(crate) command: VisitCommand,
    pub(crate) deed: Deed,
}

/// A visit that is driven and observed, beside its model.
pub(crate) struct Exhibition {
    pub(crate) harness: MutexGuard<'static, WorldHarness<N>>,
    pub(crate) model: VisitModel,
    /// The visit's phases so far, without repeats in a row.
    pub(crate) phases: Vec<VisitPhase>,
    pub(crate) finished: u32,
}

impl Exhibition {
    /// Opens a visit with a clock of `length` seconds.
    pub(crate) fn open(length: u16) -> Self {
        let mut harness = HARNESS.lock().unwrap_or_else(PoisonError::into_inner);
        harness.reset();
        let mut exhibition =
            Exhibition { harness, model: VisitModel::closed(), phases: vec![], finished: 0 };
        exhibition.tell(Presence::Off, VisitCommand::Open);
        let (setting, value) = (PlanSetting::Length, length);
        exhibition.tell(Presence::Off, VisitCommand::Set { setting, value });
        exhibition
    }

    pub(crate) fn phase(&self) -> VisitPhase {
        self.harness.world.visit().phase()
    }

    pub(crate) fn tell(&mut self, presence: Presence, command: VisitCommand) {
        self.run(&Stretch { ticks: 1, presence, is_used: true, command, deed: Deed::Nothing });
    }

    pub(crate) fn press(&mut self, action: PanelAction) {
        self.tell(Presence::Worn, VisitCommand::Press(action));
    }

    /// Runs some seconds with a worn headset in use and a hand's action.
    pub(crate) fn do_for(&mut self, seconds: f32, deed: Deed) {
        let ticks = (seconds * TICK_RATE as f32) as u32;
        let (presence, command) = (Presence::Worn, VisitCommand::None);
        self.run(&Stretch { ticks, presence, is_used: true, command, deed });
    }

    /// Runs some seconds with the headset off.
    pub(crate) fn leave_for(&mut self, seconds: u32) {
        let (presence, command) = (Presence::Off, VisitCommand::None);
        let ticks = seconds * TICK_RATE;
        self.run(&Stretch { ticks, presence, is_used: false, command, deed: Deed::Nothing });
    }

    /// Advances to sculpting and cuts something.
    pub(crate) fn cut_something(&mut self) {
        self.tell(Presence::Worn, VisitCommand::None);
        self.press(PanelAction::Confirm);
        self.press(PanelAction::Confirm);
        self.press(PanelAction::Skip { all: true });
        assert_eq!(self.phase(), VisitPhase::Sculpting);
        self.do_for(0.05, Deed::Take(BenchItem::Tool(Tool::Rotary).number() as u8));
        self.do_for(0.5, Deed::Cut);
        assert!(self.harness.world.visit().is_sculpted());
    }

    pub(crate) fn run(&mut self, stretch: &Stretch) {
        for tick in 0..stretch.ticks {
            let command = if tick == 0 { stretch.command } else { VisitCommand::None };
            let Stretch { presence, is_used, deed, .. } = *stretch;
            let visit = VisitInput { presence, is_used, command };
            let input = TickInput { visit, ..self.input_of(deed, tick) };
            let stool = self.harness.world.stool_frame();
            self.harness.step(&input);
            let turns = self.harness.world.stool_frame() != stool;
            self.compare(&visit, turns);
        }
    }

    fn input_of(&self, deed: Deed, tick: u32) -> TickInput {
        let world = &self.harness.world;
        let mut input = TickInput::default();
        match deed {
            Deed::Nothing => {}
            Deed::Take(item) => input.pointer = PointerCommand::Take { hand: RIGHT as u8, item },
            Deed::Cut | Deed::CutAside => {
                // The hand comes down from above the stone again and again.
                let height = N as f32 * (1.1 - 0.02 * (tick % 36) as f32);
                let aside = if deed == Deed::CutAside { 6.0 } else { 0.0 };
                let place = Vec3::new(N as f32 / 2.0 + aside, height, N as f32 / 2.0);
                let pose = Pose { position: place, rotation: Quat::IDENTITY };
                let hand = world.hand_with_bit_at(RIGHT, &pose);
                input.hands[RIGHT] = HandInput { trigger: 255, ..hand };
            }
            Deed::Undo => input.commands = commands::UNDO,
            Deed::Turn => input.pointer = PointerCommand::Turn { by: 300 },
        }
        input
    }

    /// Compares the tick with the model's tick.
    fn compare(&mut self, told: &VisitInput, turns: bool) {
        let world = &self.harness.world;
        let edited = |smooths: Option<bool>| {
            world.events().iter().any(|event| match event {
                WorldEvent::Edited { bit, report, .. } => {
                    let is_rasp = matches!(bit, ToolBit::File | ToolBit::Float);
                    report.changed_volume() && smooths.is_none_or(|smooths| smooths == is_rasp)
                }
                _ => false,
            })
        };
        let holds_tool = (0..2).any(|hand| world.held_tool(hand).is_some());
        let seen = SeenTick {
            // The visit may have put a tool back in the tick in which it was taken.
            holds_tool: holds_tool
                || world.events().iter().any(|event| matches!(event, WorldEvent::Took { .. })),
            touches: (0..2).any(|hand| world.hand_contact(hand).is_some_and(|c| c.overlap > 0)),
            cuts: edited(Some(false)) && (0..2).any(|hand| world.edit_report(hand).removed > 0),
            edits: edited(None),
            smooths: edited(Some(true)),
            undoes: world.events().contains(&WorldEvent::Undone),
            turns,
            is_settled: world.is_settled(),
        };
        let Expected { start, finishes, warns } = self.model.tick(told, &seen);
        let visit = world.visit();
        let now = (visit.phase(), visit.guide_step(), visit.is_sculpted(), visit.is_left());
        let model = &self.model;
        assert_eq!(now, (model.phase, model.guide, model.is_sculpted, model.is_left), "{told:?}");
        let started = world.events().iter().find_map(|event| match event {
            WorldEvent::Started(mode) => Some(*mode),
            _ => None,
        });
        let missing = world.events().contains(&WorldEvent::NoSuchStart);
        assert!(started == start || missing && start.is_some(), "{started:?}, not {start:?}");
        assert!(visit.phase().lets_hands_work() || !holds_tool, "a tool hangs in the air");
        if let Some(seconds) = visit.seconds_left() {
            assert_eq!(seconds, model.clock.div_ceil(TICK_RATE));
        }
        let left = world.events().iter().find_map(|event| match event {
            WorldEvent::TimeLeft { seconds } => Some(*seconds),
            _ => None,
        });
        assert_eq!(left, warns);
        let is_finished = world.events().contains(&WorldEvent::Finished);
        assert!(!is_finished || finishes, "the sculpture is final too soon");
        self.finished += u32::from(is_finished);
        if self.phases.last() != Some(&visit.phase()) {
            self.phases.push(visit.phase());
        }
        let works = visit.phase().lets_hands_work() || !edited(None);
        assert!(works || world.events().contains(&WorldEvent::Visit(visit.phase())), "hands off");
    }
}
