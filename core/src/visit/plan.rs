//! The settings of an exhibition's visits: times and offered features.

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::session::input::{SessionMode, TICK_RATE};

/// A time or an option of a [`VisitPlan`].
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[repr(u8)]
pub enum PlanSetting {
    /// Timeout of the welcome in seconds, after which the current selection is used.
    Welcome = 0,
    /// Timeout of the choice of a start in seconds, after which the current selection is used.
    Choice = 1,
    /// Maximum duration of the guided first cut in seconds.
    Guided = 2,
    /// Duration of sculpting in seconds, from the first cut or the end of the guided part on; 0 for no limit.
    Length = 3,
    /// Idle timeout in seconds of sculpting without a time limit.
    Idle = 4,
    /// Seconds off the head before the first cut after which the visitor counts as gone.
    OffBeforeCut = 5,
    /// Seconds off the head while sculpting after which the visitor counts as gone, leaving a sculpture.
    OffSculpting = 6,
    /// Seconds off the head in later phases after which the visitor counts as gone.
    OffAfter = 7,
    /// Minimum duration of hands off in seconds, before the sculpture is final.
    HandsOff = 8,
    /// Timeout of the export in seconds, after which it continues in the background.
    Export = 9,
    /// Minimum time in seconds for which a badge is shown.
    BadgeLeast = 10,
    /// Maximum time in seconds for which a badge is shown.
    BadgeMost = 11,
    /// Maximum duration of the thanks in seconds.
    Thanks = 12,
    /// Duration in seconds of the notice to the staff that the headset is ready.
    Handover = 13,
    /// 1 if badges are issued, else 0.
    Badges = 14,
}

/// The settings of visits, in seconds. All timing of a visit depends only on these and on its inputs.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct VisitPlan {
    /// The values, indexed by [`PlanSetting`].
    values: [u16; PlanSetting::ALL.len()],
    /// The session mode for a visitor who chooses nothing.
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

    /// Returns the setting with this number.
    #[must_use]
    pub fn from_number(number: u8) -> Option<Self> {
        PlanSetting::ALL.get(usize::from(number)).copied()
    }

    /// Returns the default value: seconds, or 0 or 1.
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
    /// Creates a plan with default settings, and the free-form mode as the default start.
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

    /// Creates an empty plan: all zero bytes, as in an empty world.
    pub(super) const fn none() -> Self {
        VisitPlan { values: [0; PlanSetting::ALL.len()], start: SessionMode::None }
    }

    /// Returns the value of a setting.
    #[must_use]
    pub const fn value(&self, setting: PlanSetting) -> u16 {
        self.values[setting as usize]
    }

    /// Sets a value.
    pub const fn set_value(&mut self, setting: PlanSetting, value: u16) {
        self.values[setting as usize] = value;
    }

    /// Returns the session mode for a visitor who chooses nothing.
    #[must_use]
    pub const fn start(&self) -> SessionMode {
        self.start
    }

    /// Sets the session mode for a visitor who chooses nothing. Ignores [`SessionMode::None`].
    pub fn set_start(&mut self, start: SessionMode) {
        if start != SessionMode::None {
            self.start = start;
        }
    }

    /// Returns a setting's seconds as ticks.
    #[must_use]
    pub const fn ticks(&self, setting: PlanSetting) -> u32 {
        self.value(setting) as u32 * TICK_RATE
    }

    /// Length of a serialised plan in bytes.
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
