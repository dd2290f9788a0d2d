//! A naive model of visits: it stores all inputs, recounts in each tick, and takes the first line of a table
//! whose condition holds.

use std::collections::HashMap;

use paros_core::session::{SessionMode, TICK_RATE};
use paros_core::visit::{
    GuideStep, PanelAction, PlanSetting, Presence, StaffCommand, VisitCommand, VisitInput,
    VisitPhase,
};

/// The state and events of the world in a tick, for [`VisitModel::tick`].
#[derive(Clone, Copy, Default, Debug)]
pub struct SeenTick {
    /// `true` if a hand holds a tool.
    pub holds_tool: bool,
    /// `true` if a bit touches the stone.
    pub touches: bool,
    /// `true` if stone was cut.
    pub cuts: bool,
    /// `true` if anything was edited.
    pub edits: bool,
    /// `true` if the rasp smoothed.
    pub smooths: bool,
    /// `true` if a stroke was undone.
    pub undoes: bool,
    /// `true` if the stool was turned.
    pub turns: bool,
    /// `true` if nothing is left to fall.
    pub is_settled: bool,
}

/// The model's state of a visit.
#[derive(Clone, Debug)]
pub struct VisitModel {
    /// The current phase.
    pub phase: VisitPhase,
    /// The current step of the guided part.
    pub guide: GuideStep,
    /// The session's start mode.
    pub start: SessionMode,
    /// Number of ticks left on the clock.
    pub clock: u32,
    /// `true` if anything was edited.
    pub is_sculpted: bool,
    /// `true` if the visitor left before the end.
    pub is_left: bool,
    /// The plan's times in seconds, by setting.
    plan: HashMap<u8, u32>,
    plan_start: SessionMode,
    clock_runs: bool,
    phase_ticks: u32,
    /// The inputs since the headset was last worn, and since it was last used.
    off: Vec<u32>,
    idle: Vec<u32>,
    was_released: bool,
}

/// The expected effects on the world.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Expected {
    /// The session to start, if any.
    pub start: Option<SessionMode>,
    /// `true` if the sculpture becomes final.
    pub finishes: bool,
    /// The seconds left, if they are to be announced.
    pub warns: Option<u16>,
}

impl VisitModel {
    /// Creates the model with visits closed.
    pub fn closed() -> Self {
        VisitModel {
            phase: VisitPhase::Closed,
            guide: GuideStep::TakeTool,
            start: SessionMode::None,
            clock: 0,
            is_sculpted: false,
            is_left: false,
            plan: HashMap::new(),
            plan_start: SessionMode::FreeForm,
            clock_runs: false,
            phase_ticks: 0,
            off: Vec::new(),
            idle: Vec::new(),
            was_released: false,
        }
    }

    fn ticks(&self, setting: PlanSetting) -> u32 {
        let default = u32::from(setting.default_value());
        self.plan.get(&(setting as u8)).copied().unwrap_or(default) * TICK_RATE
    }

    /// Returns the ticks for which the headset has been off or, after five seconds, still.
    fn gone_for(&self) -> u32 {
        let still = self.idle.iter().sum::<u32>().saturating_sub(5 * TICK_RATE);
        self.off.iter().sum::<u32>().max(still)
    }

    /// Advances the visit by a tick, given its input and what happened in the world.
    pub fn tick(&mut self, input: &VisitInput, seen: &SeenTick) -> Expected {
        let mut expected = Expected::default();
        match input.command {
            VisitCommand::Open => {
                *self =
                    VisitModel { phase: VisitPhase::Attract, was_released: true, ..Self::closed() };
                return Expected { start: Some(SessionMode::FreeForm), ..expected };
            }
            VisitCommand::Close => *self = Self::closed(),
            _ => {}
        }
        if self.phase == VisitPhase::Closed {
            return expected;
        }
        self.hear(input);
        self.run_clock(&mut expected);
        self.watch(seen);
        self.press(input.command, &mut expected);
        let is_gone = self.is_gone(input);
        let next = self
            .table(input, seen, is_gone)
            .into_iter()
            .find_map(|(holds, to)| holds.then_some(to));
        self.is_left |= self.phase == VisitPhase::HandsOff
            && input.command == VisitCommand::Staff(StaffCommand::Reset);
        if let Some(next) = next {
            self.is_left |= is_gone || self.is_idle_out();
            self.enter(next, &mut expected);
        }
        expected
    }

    fn hear(&mut self, input: &VisitInput) {
        let mut away = 0;
        match input.command {
            VisitCommand::Set { setting, value } => {
                self.plan.insert(setting as u8, value.into());
            }
            VisitCommand::SetStart(start) if start != SessionMode::None => self.plan_start = start,
            VisitCommand::Away { seconds } => away = u32::from(seconds) * TICK_RATE,
            _ => {}
        }
        if input.presence != Presence::Off {
            self.off.clear();
        } else {
            self.off.push(1);
        }
        if input.is_used {
            self.idle.clear();
        } else {
            self.idle.push(1);
        }
        self.off.push(away);
        self.idle.push(away);
        self.phase_ticks += 1;
        let is_long = self.idle.iter().sum::<u32>() >= 10 * TICK_RATE;
        self.was_released |= input.presence == Presence::Off || is_long;
    }

    fn is_sculpting(&self) -> bool {
        [VisitPhase::Guided, VisitPhase::Sculpting].contains(&self.phase)
    }

    fn run_clock(&mut self, expected: &mut Expected) {
        if self.is_sculpting()
            && self.clock_runs
            && self.ticks(PlanSetting::Length) > 0
            && self.clock > 0
        {
            self.clock -= 1;
            expected.warns =
                [120, 30, 10].into_iter().find(|s| self.clock == u32::from(*s) * TICK_RATE);
        }
    }

    fn watch(&mut self, seen: &SeenTick) {
        if !self.is_sculpting() {
            return;
        }
        self.is_sculpted |= seen.edits;
        self.clock_runs |= seen.edits;
        let is_done = match self.guide {
            GuideStep::TakeTool => seen.holds_tool,
            GuideStep::Touch => seen.touches || seen.cuts,
            GuideStep::Cut => seen.cuts,
            GuideStep::Smooth => seen.smooths,
            GuideStep::Undo => seen.undoes,
            GuideStep::TurnStool => seen.turns,
            GuideStep::Done => false,
        };
        if is_done && self.phase == VisitPhase::Guided {
            self.guide = self.guide.next();
        }
    }

    fn press(&mut self, command: VisitCommand, expected: &mut Expected) {
        match (self.phase, command) {
            (VisitPhase::Choice, VisitCommand::Press(PanelAction::Start(start)))
                if start != SessionMode::None =>
            {
                self.start = start;
                expected.start = Some(start);
            }
            (VisitPhase::Guided, VisitCommand::Press(PanelAction::Skip { all })) => {
                self.guide = if all { GuideStep::Done } else { self.guide.next() };
            }
            (_, VisitCommand::Staff(StaffCommand::Extend)) => self.clock += 60 * TICK_RATE,
            _ => {}
        }
    }

    fn is_gone(&self, input: &VisitInput) -> bool {
        let allowed = match self.phase {
            VisitPhase::Welcome | VisitPhase::Choice => PlanSetting::OffBeforeCut,
            _ if self.is_sculpting() && !self.is_sculpted => PlanSetting::OffBeforeCut,
            _ if self.is_sculpting() => PlanSetting::OffSculpting,
            _ => PlanSetting::OffAfter,
        };
        input.command == VisitCommand::Staff(StaffCommand::Reset)
            || self.gone_for() >= self.ticks(allowed).max(1)
    }

    fn is_idle_out(&self) -> bool {
        self.is_sculpting()
            && self.ticks(PlanSetting::Length) == 0
            && self.idle.iter().sum::<u32>() >= self.ticks(PlanSetting::Idle).max(1)
    }

    /// Returns conditions and the phases that they lead to, in order of priority.
    fn table(&self, input: &VisitInput, seen: &SeenTick, is_gone: bool) -> Vec<(bool, VisitPhase)> {
        use VisitPhase::{
            Attract, Badge, Choice, Export, Guided, Handover, HandsOff, Sculpting, Thanks, Welcome,
        };
        let over = |setting| self.phase_ticks >= self.ticks(setting);
        let pressed = |action| input.command == VisitCommand::Press(action);
        let staff = |command| input.command == VisitCommand::Staff(command);
        let here = match input.presence {
            Presence::Worn => true,
            Presence::Unknown => input.is_used,
            Presence::Off => false,
        };
        let next_visitor = (here && self.was_released, Welcome);
        let rung = self.ticks(PlanSetting::Length) > 0 && self.clock_runs && self.clock == 0;
        let ready = pressed(PanelAction::Finish) || staff(StaffCommand::End) || rung;
        let lost = is_gone || self.is_idle_out();
        let kept = input.command == VisitCommand::Exported || over(PlanSetting::Export) || is_gone;
        let calm = over(PlanSetting::HandsOff)
            && (seen.is_settled
                || self.phase_ticks >= self.ticks(PlanSetting::HandsOff) + 15 * TICK_RATE);
        match self.phase {
            VisitPhase::Closed => vec![],
            Attract => vec![next_visitor],
            Welcome => vec![
                (is_gone, Attract),
                (pressed(PanelAction::Confirm) || over(PlanSetting::Welcome), Choice),
            ],
            Choice => vec![
                (is_gone, Attract),
                (pressed(PanelAction::Confirm) || over(PlanSetting::Choice), Guided),
            ],
            Guided | Sculpting => vec![
                (ready, HandsOff),
                (lost && self.is_sculpted, HandsOff),
                (lost, Attract),
                (
                    self.phase == Guided
                        && (self.guide == GuideStep::Done || over(PlanSetting::Guided)),
                    Sculpting,
                ),
            ],
            HandsOff => vec![
                (staff(StaffCommand::Extend) && !self.is_left, Sculpting),
                (staff(StaffCommand::Reset) && !self.is_sculpted, Attract),
                (calm && self.is_sculpted, Export),
                (calm, Thanks),
            ],
            Export => vec![
                (kept && (self.is_left || is_gone), Handover),
                (kept && self.ticks(PlanSetting::Badges) == 0, Thanks),
                (kept, Badge),
            ],
            Badge => vec![
                (is_gone, Attract),
                (over(PlanSetting::BadgeMost), Thanks),
                (over(PlanSetting::BadgeLeast) && pressed(PanelAction::Confirm), Thanks),
            ],
            Thanks => vec![(is_gone, Attract), (over(PlanSetting::Thanks), Handover)],
            Handover => vec![next_visitor, (over(PlanSetting::Handover), Attract)],
        }
    }

    fn enter(&mut self, phase: VisitPhase, expected: &mut Expected) {
        let fresh = VisitModel {
            plan: self.plan.clone(),
            plan_start: self.plan_start,
            ..VisitModel::closed()
        };
        match phase {
            VisitPhase::Attract => {
                expected.start = Some(SessionMode::FreeForm);
                *self = VisitModel { off: self.off.clone(), idle: self.idle.clone(), ..fresh };
            }
            VisitPhase::Welcome => {
                expected.start = Some(self.plan_start);
                *self = VisitModel { start: self.plan_start, ..fresh };
            }
            VisitPhase::Guided => self.clock = self.ticks(PlanSetting::Length),
            VisitPhase::Sculpting => (self.clock_runs, self.is_left) = (true, false),
            VisitPhase::Export => expected.finishes = true,
            _ => {}
        }
        let is_off = self.off.iter().sum::<u32>() > 0;
        self.was_released = is_off || self.was_released && self.is_left;
        (self.phase, self.phase_ticks) = (phase, 0);
    }
}
