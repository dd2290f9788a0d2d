//! The accessors of a visit, and its serialisation in a saved world.

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::session::input::{SessionMode, TICK_RATE};
use crate::visit::machine::Visit;
use crate::visit::phase::{GuideStep, VisitPhase};
use crate::visit::plan::{PlanSetting, VisitPlan};

impl Visit {
    /// Returns the current phase.
    #[must_use]
    pub const fn phase(&self) -> VisitPhase {
        self.phase
    }

    /// Returns the step of the guided first cut.
    #[must_use]
    pub const fn guide_step(&self) -> GuideStep {
        self.guide
    }

    /// Returns the ticks since this phase began.
    #[must_use]
    pub const fn phase_ticks(&self) -> u32 {
        self.phase_ticks
    }

    /// Returns the ticks since the headset was used.
    #[must_use]
    pub const fn idle_ticks(&self) -> u32 {
        self.idle_ticks
    }

    /// Returns the remaining seconds of a session that has a clock, rounded up.
    #[must_use]
    pub fn seconds_left(&self) -> Option<u32> {
        let has_clock = self.plan.value(PlanSetting::Length) > 0;
        has_clock.then(|| self.clock_ticks.div_ceil(TICK_RATE))
    }

    /// Returns `true` if anything was edited.
    #[must_use]
    pub const fn is_sculpted(&self) -> bool {
        self.is_sculpted
    }

    /// Returns `true` if the visitor left before the end.
    #[must_use]
    pub const fn is_left(&self) -> bool {
        self.is_left
    }

    /// Returns the mode in which the session starts, as currently selected.
    #[must_use]
    pub const fn start(&self) -> SessionMode {
        self.start
    }

    /// Returns the number of the language; 0 is the exhibition's first.
    #[must_use]
    pub const fn language(&self) -> u8 {
        self.language
    }

    /// Returns the working hand: 0 left, 1 right.
    #[must_use]
    pub const fn working_hand(&self) -> u8 {
        self.working_hand
    }

    /// Returns `true` if the visitor is seated.
    #[must_use]
    pub const fn is_seated(&self) -> bool {
        self.is_seated
    }

    /// Returns the number of the badge, 27 bits, once the shell has set one.
    #[must_use]
    pub const fn badge(&self) -> Option<u32> {
        self.badge.checked_sub(1)
    }

    /// Returns the plan.
    #[must_use]
    pub const fn plan(&self) -> &VisitPlan {
        &self.plan
    }

    /// Length of a serialised visit in bytes.
    pub(crate) const BYTES: usize = 2 + 4 * 4 + 1 + SessionMode::BYTES + 1 + 4 + VisitPlan::BYTES;

    pub(crate) fn write(&self, to: &mut ByteWriter<'_>) {
        to.u8(self.phase as u8);
        to.u8(self.guide as u8);
        [self.phase_ticks, self.off_ticks, self.idle_ticks, self.clock_ticks]
            .iter()
            .for_each(|ticks| to.u32(*ticks));
        let flags = [self.is_clock_running, self.is_sculpted, self.is_left, self.was_released];
        let flags = (0..).zip(flags).fold(0, |bits, (i, flag)| bits | u8::from(flag) << i);
        to.u8(flags | u8::from(self.is_seated) << 4 | self.working_hand << 5);
        self.start.write(to);
        to.u8(self.language);
        to.u32(self.badge);
        self.plan.write(to);
    }

    pub(crate) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let bad = from.error_here("a visit's phase, 0 to 10, and step, 0 to 6");
        let (phase, guide) = (from.u8()?, from.u8()?);
        let phase = VisitPhase::from_number(phase).ok_or(bad)?;
        let guide = GuideStep::from_number(guide).ok_or(bad)?;
        let (phase_ticks, off_ticks) = (from.u32()?, from.u32()?);
        let (idle_ticks, clock_ticks) = (from.u32()?, from.u32()?);
        let bad = from.error_here("flags of a visit, six of them");
        let flags = from.u8()?;
        let start = SessionMode::read(from)?;
        let language = from.u8()?;
        if flags >> 6 != 0 {
            return Err(bad);
        }
        let bad = from.error_here("a badge of 27 bits, or none");
        let badge = from.u32()?;
        if badge > 1 << 27 {
            return Err(bad);
        }
        Ok(Visit {
            phase,
            guide,
            phase_ticks,
            off_ticks,
            idle_ticks,
            clock_ticks,
            is_clock_running: flags & 1 != 0,
            is_sculpted: flags & 2 != 0,
            is_left: flags & 4 != 0,
            was_released: flags & 8 != 0,
            is_seated: flags & 16 != 0,
            working_hand: flags >> 5 & 1,
            start,
            language,
            badge,
            plan: VisitPlan::read(from)?,
        })
    }
}
