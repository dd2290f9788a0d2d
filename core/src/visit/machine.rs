//! The state machine of a visit.

use crate::session::input::{SessionMode, TICK_RATE};
use crate::visit::input::{PanelAction, StaffCommand, VisitCommand, VisitInput};
use crate::visit::phase::{GuideStep, VisitPhase};
use crate::visit::plan::{PlanSetting, VisitPlan};

/// Ticks that a staff extension adds to a visit's clock.
pub const EXTENSION_TICKS: u32 = 60 * TICK_RATE;

/// Remaining seconds at which the visitor is warned, in descending order.
pub const WARNING_SECONDS: [u16; 3] = [120, 30, 10];

/// Maximum ticks beyond the minimum of hands off to wait for unsupported stone to fall.
const SETTLE_TICKS: u32 = 15 * TICK_RATE;

/// A visit: its phase, its clock, and the visitor's choices.
///
/// Transitions from each phase; the first condition that becomes true applies:
///
/// | phase | next phase | condition |
/// |---|---|---|
/// | attract | welcome | the headset is worn by a new visitor |
/// | welcome | choice | confirmed, or timed out |
/// | | attract | gone |
/// | choice | guided | confirmed, or timed out |
/// | | attract | gone |
/// | guided | sculpting | all steps are done or skipped, or timed out |
/// | guided, sculpting | hands off | finished, ended by the staff, or the clock is at zero |
/// | | hands off | after a cut: gone, or idle without a clock |
/// | | attract | before the first cut: gone, or idle without a clock |
/// | hands off | export | timed out and no island search is pending, if anything was sculpted |
/// | | thanks | the same, if nothing was sculpted |
/// | | attract | the staff's reset, if nothing was sculpted |
/// | | sculpting | the staff extends the time, unless the visitor has gone |
/// | export | badge | the sculpture is stored, or timed out |
/// | | thanks | the same, without badges |
/// | | handover | the same, if the visitor has gone |
/// | badge | thanks | confirmed after the minimum time, or the maximum is over |
/// | | attract | gone |
/// | thanks | handover | timed out |
/// | | attract | gone |
/// | handover | welcome | the headset is worn by a new visitor |
/// | | attract | timed out |
///
/// *Gone* means that the headset was off the head, or not used, for as long as the phase allows. A staff
/// reset has the same effect as a visitor who has gone.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Visit {
    pub(super) phase: VisitPhase,
    pub(super) guide: GuideStep,
    /// Ticks in this phase.
    pub(super) phase_ticks: u32,
    /// Ticks since the headset came off; 0 while it is worn.
    pub(super) off_ticks: u32,
    /// Ticks since the headset was used.
    pub(super) idle_ticks: u32,
    /// Remaining ticks of the clock.
    pub(super) clock_ticks: u32,
    pub(super) is_clock_running: bool,
    /// `true` if anything was edited.
    pub(super) is_sculpted: bool,
    /// `true` if the visitor left before the end.
    pub(super) is_left: bool,
    /// `true` if the headset was off or unused since this phase began, so that its next wearer is a new
    /// visitor.
    pub(super) was_released: bool,
    /// The mode in which the session starts, as currently selected.
    pub(super) start: SessionMode,
    pub(super) language: u8,
    pub(super) working_hand: u8,
    pub(super) is_seated: bool,
    /// The badge's number plus one; 0 if none is set.
    pub(super) badge: u32,
    pub(super) plan: VisitPlan,
}

/// The facts of a tick that matter to a visit.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) struct VisitFacts {
    /// `true` if a hand holds a tool.
    pub(crate) holds_tool: bool,
    /// `true` if a bit touches the stone.
    pub(crate) touches: bool,
    /// `true` if stone was cut.
    pub(crate) cuts: bool,
    /// `true` if anything was edited: cut, smoothed or filled.
    pub(crate) edits: bool,
    /// `true` if the rasp smoothed.
    pub(crate) smooths: bool,
    /// `true` if a stroke was undone.
    pub(crate) undoes: bool,
    /// `true` if the stool was turned.
    pub(crate) turns_stool: bool,
    /// `true` if no island search is running or requested.
    pub(crate) is_settled: bool,
}

/// The actions that a visit requests of the world after a tick.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub(crate) struct VisitDecision {
    /// Starts a session, unless [`SessionMode::None`].
    pub(crate) start: SessionMode,
    /// Makes the sculpture final.
    pub(crate) finishes: bool,
    /// Puts all tools back on the bench.
    pub(crate) puts_back: bool,
    /// The newly entered phase, if it changed.
    pub(crate) enters: Option<VisitPhase>,
    /// The remaining seconds, if they reached one of [`WARNING_SECONDS`].
    pub(crate) warns: Option<u16>,
}

impl Visit {
    /// Creates the state without visits.
    pub(crate) const fn new() -> Self {
        Visit {
            phase: VisitPhase::Closed,
            guide: GuideStep::TakeTool,
            phase_ticks: 0,
            off_ticks: 0,
            idle_ticks: 0,
            clock_ticks: 0,
            is_clock_running: false,
            is_sculpted: false,
            is_left: false,
            was_released: false,
            start: SessionMode::None,
            language: 0,
            working_hand: 0,
            is_seated: false,
            badge: 0,
            plan: VisitPlan::none(),
        }
    }

    /// Advances the visit by a tick.
    pub(crate) fn step(&mut self, input: &VisitInput, facts: &VisitFacts) -> VisitDecision {
        match input.command {
            VisitCommand::Open => return self.open(),
            VisitCommand::Close => {
                let enters = (self.phase != VisitPhase::Closed).then_some(VisitPhase::Closed);
                *self = Visit::new();
                return VisitDecision { enters, ..VisitDecision::default() };
            }
            _ if self.phase == VisitPhase::Closed => return VisitDecision::default(),
            VisitCommand::Set { setting, value } => self.plan.set_value(setting, value),
            VisitCommand::SetStart(start) => self.plan.set_start(start),
            VisitCommand::Badge { number } => self.badge = number + 1,
            _ => {}
        }
        self.pass_time(input);
        let mut decision = VisitDecision { warns: self.run_clock(), ..VisitDecision::default() };
        self.note_facts(facts);
        if let VisitCommand::Press(action) = input.command {
            self.take_press(action, &mut decision);
        }
        if input.command == VisitCommand::Staff(StaffCommand::Extend) {
            self.clock_ticks = self.clock_ticks.saturating_add(EXTENSION_TICKS);
        }
        // In hands off, a staff reset marks the visitor as gone; the sculpture is still exported.
        let is_reset = input.command == VisitCommand::Staff(StaffCommand::Reset);
        self.is_left |= is_reset && self.phase == VisitPhase::HandsOff;
        let next = self.next_phase(input, facts);
        if next != self.phase {
            self.is_left |= self.is_gone(input) || self.is_idle_for_long();
            self.enter(next, &mut decision);
        }
        decision
    }

    fn open(&mut self) -> VisitDecision {
        *self = Visit { plan: VisitPlan::new(), ..Visit::new() };
        let mut decision = VisitDecision::default();
        self.enter(VisitPhase::Attract, &mut decision);
        // A person who already wears the headset is the first visitor.
        self.was_released = true;
        decision
    }

    /// Advances the clock of a session that has one. Returns the remaining seconds when a warning is due.
    fn run_clock(&mut self) -> Option<u16> {
        let runs = matches!(self.phase, VisitPhase::Guided | VisitPhase::Sculpting)
            && self.is_clock_running
            && self.has_clock();
        if !runs || self.clock_ticks == 0 {
            return None;
        }
        self.clock_ticks -= 1;
        let is_due = |seconds: &u16| self.clock_ticks == u32::from(*seconds) * TICK_RATE;
        WARNING_SECONDS.into_iter().find(is_due)
    }

    fn note_facts(&mut self, facts: &VisitFacts) {
        if !matches!(self.phase, VisitPhase::Guided | VisitPhase::Sculpting) {
            return;
        }
        self.is_sculpted |= facts.edits;
        self.is_clock_running |= facts.edits;
        if self.phase == VisitPhase::Guided && self.is_step_done(facts) {
            self.guide = self.guide.next();
        }
    }

    const fn is_step_done(&self, facts: &VisitFacts) -> bool {
        match self.guide {
            GuideStep::TakeTool => facts.holds_tool,
            GuideStep::Touch => facts.touches || facts.cuts,
            GuideStep::Cut => facts.cuts,
            GuideStep::Smooth => facts.smooths,
            GuideStep::Undo => facts.undoes,
            GuideStep::TurnStool => facts.turns_stool,
            GuideStep::Done => false,
        }
    }

    fn take_press(&mut self, action: PanelAction, decision: &mut VisitDecision) {
        match (self.phase, action) {
            (VisitPhase::Welcome, PanelAction::Language(language)) => self.language = language,
            (VisitPhase::Welcome, PanelAction::WorkingHand(hand)) => self.working_hand = hand & 1,
            (VisitPhase::Welcome, PanelAction::Seated(is_seated)) => self.is_seated = is_seated,
            (VisitPhase::Choice, PanelAction::Start(start)) if start != SessionMode::None => {
                self.start = start;
                decision.start = start;
            }
            (VisitPhase::Guided, PanelAction::Skip { all: false }) => {
                self.guide = self.guide.next();
            }
            (VisitPhase::Guided, PanelAction::Skip { all: true }) => self.guide = GuideStep::Done,
            (VisitPhase::Guided | VisitPhase::Sculpting, PanelAction::PutBack) => {
                decision.puts_back = true;
            }
            _ => {}
        }
    }

    /// Returns the phase after this tick, by the table above.
    fn next_phase(&self, input: &VisitInput, facts: &VisitFacts) -> VisitPhase {
        let is_confirmed = input.command == VisitCommand::Press(PanelAction::Confirm);
        let is_over = |setting| self.phase_ticks >= self.plan.ticks(setting);
        let is_gone = self.is_gone(input);
        match self.phase {
            VisitPhase::Closed => VisitPhase::Closed,
            VisitPhase::Attract if self.is_next_visitor(input) => VisitPhase::Welcome,
            VisitPhase::Attract => VisitPhase::Attract,
            VisitPhase::Guided | VisitPhase::Sculpting => self.next_while_sculpting(input),
            VisitPhase::HandsOff => self.next_after_hands_off(input, facts),
            VisitPhase::Export => self.next_after_export(input),
            VisitPhase::Handover if self.is_next_visitor(input) => VisitPhase::Welcome,
            VisitPhase::Handover if is_over(PlanSetting::Handover) => VisitPhase::Attract,
            VisitPhase::Handover => VisitPhase::Handover,
            _ if is_gone => VisitPhase::Attract,
            VisitPhase::Welcome if is_confirmed || is_over(PlanSetting::Welcome) => {
                VisitPhase::Choice
            }
            VisitPhase::Choice if is_confirmed || is_over(PlanSetting::Choice) => {
                VisitPhase::Guided
            }
            VisitPhase::Badge
                if is_over(PlanSetting::BadgeMost)
                    || is_confirmed && is_over(PlanSetting::BadgeLeast) =>
            {
                VisitPhase::Thanks
            }
            VisitPhase::Thanks if is_over(PlanSetting::Thanks) => VisitPhase::Handover,
            phase => phase,
        }
    }

    fn next_while_sculpting(&self, input: &VisitInput) -> VisitPhase {
        let is_ended = match input.command {
            VisitCommand::Press(PanelAction::Finish) | VisitCommand::Staff(StaffCommand::End) => {
                true
            }
            _ => self.has_clock() && self.is_clock_running && self.clock_ticks == 0,
        };
        if is_ended {
            VisitPhase::HandsOff
        } else if self.is_gone(input) || self.is_idle_for_long() {
            if self.is_sculpted { VisitPhase::HandsOff } else { VisitPhase::Attract }
        } else if self.phase == VisitPhase::Guided {
            let is_over = self.phase_ticks >= self.plan.ticks(PlanSetting::Guided);
            let is_done = self.guide == GuideStep::Done || is_over;
            if is_done { VisitPhase::Sculpting } else { VisitPhase::Guided }
        } else {
            VisitPhase::Sculpting
        }
    }

    fn next_after_hands_off(&self, input: &VisitInput, facts: &VisitFacts) -> VisitPhase {
        let least = self.plan.ticks(PlanSetting::HandsOff);
        let is_over = self.phase_ticks >= least && facts.is_settled
            || self.phase_ticks >= least.saturating_add(SETTLE_TICKS);
        match (input.command, self.is_sculpted) {
            (VisitCommand::Staff(StaffCommand::Extend), _) if !self.is_left => {
                VisitPhase::Sculpting
            }
            (VisitCommand::Staff(StaffCommand::Reset), false) => VisitPhase::Attract,
            (_, true) if is_over => VisitPhase::Export,
            (_, false) if is_over => VisitPhase::Thanks,
            _ => VisitPhase::HandsOff,
        }
    }

    fn next_after_export(&self, input: &VisitInput) -> VisitPhase {
        let is_kept = input.command == VisitCommand::Exported;
        let is_over = self.phase_ticks >= self.plan.ticks(PlanSetting::Export);
        if !is_kept && !is_over && !self.is_gone(input) {
            VisitPhase::Export
        } else if self.is_left || self.is_gone(input) {
            VisitPhase::Handover
        } else if self.plan.value(PlanSetting::Badges) == 0 {
            VisitPhase::Thanks
        } else {
            VisitPhase::Badge
        }
    }

    pub(super) const fn has_clock(&self) -> bool {
        self.plan.value(PlanSetting::Length) > 0
    }

    fn enter(&mut self, phase: VisitPhase, decision: &mut VisitDecision) {
        match phase {
            VisitPhase::Attract => {
                let Visit { off_ticks, idle_ticks, plan, .. } = *self;
                *self = Visit { off_ticks, idle_ticks, plan, ..Visit::new() };
                decision.start = SessionMode::FreeForm;
            }
            VisitPhase::Welcome => {
                let plan = self.plan;
                *self = Visit { plan, start: plan.start(), working_hand: 1, ..Visit::new() };
                decision.start = self.start;
            }
            VisitPhase::Guided => self.clock_ticks = self.plan.ticks(PlanSetting::Length),
            VisitPhase::Sculpting => (self.is_clock_running, self.is_left) = (true, false),
            VisitPhase::HandsOff => decision.puts_back = true,
            VisitPhase::Export => decision.finishes = true,
            _ => {}
        }
        // A wearer after the visitor has left is a new visitor, even while the old visitor's sculpture is
        // still processed.
        self.was_released = self.off_ticks > 0 || self.is_left && self.was_released;
        (self.phase, self.phase_ticks) = (phase, 0);
        decision.enters = Some(phase);
    }
}
