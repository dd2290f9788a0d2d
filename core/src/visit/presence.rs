//! Presence detection: how long the headset has been off or unused, and the consequences.

use crate::session::input::TICK_RATE;
use crate::visit::input::{Presence, StaffCommand, VisitCommand, VisitInput};
use crate::visit::machine::Visit;
use crate::visit::phase::VisitPhase;
use crate::visit::plan::PlanSetting;

/// Ticks without movement, in addition to the phase's limit, before a visitor counts as gone.
const STILL_TICKS: u32 = 5 * TICK_RATE;

/// Ticks without use after which the next user of a headset without presence detection counts as a new
/// visitor.
const RELEASED_TICKS: u32 = 10 * TICK_RATE;

impl Visit {
    /// Returns the ticks until the visitor counts as gone if the headset remains unused, or `None` if that
    /// has no effect in this phase: there is no visitor, or hands are off.
    #[must_use]
    pub fn ticks_until_gone(&self) -> Option<u32> {
        let follows = match self.phase {
            VisitPhase::Closed | VisitPhase::Attract => false,
            VisitPhase::HandsOff | VisitPhase::Handover => false,
            VisitPhase::Welcome | VisitPhase::Choice => true,
            VisitPhase::Guided | VisitPhase::Sculpting => true,
            VisitPhase::Export | VisitPhase::Badge | VisitPhase::Thanks => true,
        };
        let idle = self.ticks_until_idle_for_long().unwrap_or(u32::MAX);
        follows.then(|| self.ticks_until_off_for_long().min(idle))
    }

    /// Counts the duration of the phase, and how long the headset hasn't been worn or used.
    pub(super) fn pass_time(&mut self, input: &VisitInput) {
        let away = match input.command {
            VisitCommand::Away { seconds } => u32::from(seconds) * TICK_RATE,
            _ => 0,
        };
        let longer = |ticks: u32| ticks.saturating_add(1).saturating_add(away);
        self.phase_ticks = self.phase_ticks.saturating_add(1);
        self.idle_ticks = if input.is_used { away } else { longer(self.idle_ticks) };
        self.off_ticks = match input.presence {
            Presence::Off => longer(self.off_ticks),
            Presence::Worn | Presence::Unknown => away,
        };
        self.was_released |= input.presence == Presence::Off || self.idle_ticks >= RELEASED_TICKS;
    }

    /// Returns `true` if the visitor has gone: the headset was off or unused for as long as this phase
    /// allows.
    pub(super) fn is_gone(&self, input: &VisitInput) -> bool {
        let is_reset = input.command == VisitCommand::Staff(StaffCommand::Reset);
        is_reset || self.ticks_until_off_for_long() == 0
    }

    /// Returns the ticks until the headset was off or unused for as long as this phase allows.
    fn ticks_until_off_for_long(&self) -> u32 {
        let allowed = match self.phase {
            VisitPhase::Welcome | VisitPhase::Choice => PlanSetting::OffBeforeCut,
            VisitPhase::Guided | VisitPhase::Sculpting if self.is_sculpted => {
                PlanSetting::OffSculpting
            }
            VisitPhase::Guided | VisitPhase::Sculpting => PlanSetting::OffBeforeCut,
            _ => PlanSetting::OffAfter,
        };
        let allowed = self.plan.ticks(allowed).max(1);
        let still = (allowed + STILL_TICKS).saturating_sub(self.idle_ticks);
        match self.off_ticks {
            0 => still,
            off => still.min(allowed.saturating_sub(off)),
        }
    }

    /// Returns `true` if the headset was unused for as long as sculpting without a clock allows.
    pub(super) fn is_idle_for_long(&self) -> bool {
        self.ticks_until_idle_for_long() == Some(0)
    }

    /// Returns the ticks until then, or `None` if there is a clock, or if the phase isn't sculpting.
    fn ticks_until_idle_for_long(&self) -> Option<u32> {
        let is_sculpting = matches!(self.phase, VisitPhase::Guided | VisitPhase::Sculpting);
        let allowed = self.plan.ticks(PlanSetting::Idle).max(1);
        (is_sculpting && !self.has_clock()).then(|| allowed.saturating_sub(self.idle_ticks))
    }

    /// Returns `true` if a new visitor wears the headset, who didn't wear it when this phase began.
    pub(super) const fn is_next_visitor(&self, input: &VisitInput) -> bool {
        let is_here = match input.presence {
            Presence::Worn => true,
            Presence::Unknown => input.is_used,
            Presence::Off => false,
        };
        is_here && self.was_released
    }
}
