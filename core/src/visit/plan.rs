//! What an exhibition sets of its visits: times and what is offered.

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::session::input::{SessionMode, TICK_RATE};

/// A time or a choice of a [`VisitPlan`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum PlanSetting {
    /// Seconds of the welcome, after which what stands is taken.
    Welcome = 0,
    /// Seconds of the choice of a start, after which what stands is taken.
    Choice = 1,
    /// Seconds of the guided first cut at most.
    Guided = 2,
    /// Seconds of sculpting, from the first cut or the end of the guided part on; 0 for no end.
    Length = 3,
    /// Seconds without use after which sculpting without an end is over.
    Idle = 4,
    /// Seconds off the head before the first cut after which the visitor has gone.
    OffBeforeCut = 5,
    /// Seconds off the head while sculpting after which the visitor has gone, and left a sculpture.
    OffSculpting = 6,
    /// Seconds off the head with the badge shown or later after which the visitor has gone.
    OffAfter = 7,
    /// Seconds of hands off at least, before the sculpture is final.
    HandsOff = 8,
    /// Seconds after which a sculpture that is still being exported is left to the background.
    Export = 9,
    /// Seconds for which a badge is shown at least.
    BadgeLeast = 10,
    /// Seconds for which a badge is shown at most.
    BadgeMost = 11,
    /// Seconds of thanks at most.
    Thanks = 12,
    /// Seconds for which the staff is told that the headset is ready.
    Handover = 13,
    /// Whether badges are given: 1, or 0.
    Badges = 14,
}

/// The settings of visits, in seconds. All that a visit does with time follows from them and from its inputs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct VisitPlan {
    /// By [`PlanSetting`].
    values: [u16; PlanSetting::ALL.len()],
    /// How a session starts where the visitor chooses nothing.
    start: SessionMode,
}

impl PlanSetting {
    /// All settings, in the order of their numbers.
    pub const ALL: [PlanSetting; 15] = [
        PlanSetting::Welcome,
        PlanSetting::Choice,
        PlanSetting::Guided,
        PlanSetting::Length,
        PlanSetting::Idle,
        PlanSetting::OffBeforeCut,
        PlanSetting::OffSculpting,
        PlanSetting::OffAfter,
        PlanSetting::HandsOff,
        PlanSetting::Export,
        PlanSetting::BadgeLeast,
        PlanSetting::BadgeMost,
        PlanSetting::Thanks,
        PlanSetting::Handover,
        PlanSetting::Badges,
    ];

    /// The setting of a number.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        PlanSetting::ALL.get(usize::from(number)).copied()
    }

    /// The value where nobody sets another: seconds, or 0 or 1.
    #[must_use]
    pub const fn default_value(self) -> u16 {
        match self {
            PlanSetting::Welcome => 20,
            PlanSetting::Choice | PlanSetting::OffSculpting => 45,
            PlanSetting::Guided
            | PlanSetting::Export
            | PlanSetting::BadgeMost
            | PlanSetting::Thanks => 60,
            PlanSetting::Length => 600,
            PlanSetting::Idle => 90,
            PlanSetting::OffBeforeCut | PlanSetting::BadgeLeast | PlanSetting::Handover => 10,
            PlanSetting::OffAfter => 5,
            PlanSetting::HandsOff => 3,
            PlanSetting::Badges => 1,
        }
    }
}

impl VisitPlan {
    /// All settings by default, and free form where nothing is chosen.
    #[must_use]
    pub const fn new() -> Self {
        let mut values = [0; PlanSetting::ALL.len()];
        let mut i = 0;
        while i < values.len() {
            values[i] = PlanSetting::ALL[i].default_value();
            i += 1;
        }
        VisitPlan { values, start: SessionMode::FreeForm }
    }

    /// No plan: all zero bytes, as an empty world's.
    pub(super) const fn none() -> Self {
        VisitPlan { values: [0; PlanSetting::ALL.len()], start: SessionMode::None }
    }

    /// The value of a setting.
    #[must_use]
    pub const fn value(&self, setting: PlanSetting) -> u16 {
        self.values[setting as usize]
    }

    /// Sets a value.
    pub const fn set_value(&mut self, setting: PlanSetting, value: u16) {
        self.values[setting as usize] = value;
    }

    /// How a session starts where nothing is chosen.
    #[must_use]
    pub const fn start(&self) -> SessionMode {
        self.start
    }

    /// Sets how a session starts where nothing is chosen; none is no way to start.
    pub fn set_start(&mut self, start: SessionMode) {
        if start != SessionMode::None {
            self.start = start;
        }
    }

    /// The ticks of a setting's seconds.
    #[must_use]
    pub const fn ticks(&self, setting: PlanSetting) -> u32 {
        self.value(setting) as u32 * TICK_RATE
    }

    /// Length of a written plan in bytes.
    pub(super) const BYTES: usize = 2 * PlanSetting::ALL.len() + SessionMode::BYTES;

    pub(super) fn write(&self, to: &mut ByteWriter<'_>) {
        self.values.iter().for_each(|value| to.u16(*value));
        self.start.write(to);
    }

    pub(super) fn read(from: &mut ByteReader<'_>) -> Result<Self, BadBytes> {
        let mut plan = VisitPlan::none();
        for value in &mut plan.values {
            *value = from.u16()?;
        }
        plan.start = SessionMode::read(from)?;
        Ok(plan)
    }
}

impl Default for VisitPlan {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::{PlanSetting, VisitPlan};

    #[test]
    fn settings_are_numbered_in_their_order() {
        for (number, setting) in PlanSetting::ALL.into_iter().enumerate() {
            assert_eq!(setting as usize, number);
            assert_eq!(PlanSetting::from_number(number as u8), Some(setting));
            assert_eq!(VisitPlan::new().value(setting), setting.default_value());
        }
        assert_eq!(PlanSetting::from_number(PlanSetting::ALL.len() as u8), None);
    }
}
