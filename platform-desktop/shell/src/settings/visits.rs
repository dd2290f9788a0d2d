//! The settings of visits, and how shells tell a world of them.

use paros_core::badge::Language;
use paros_core::session::SessionMode;
use paros_core::visit::{PlanSetting, VisitCommand, VisitPlan};

use super::pin::StaffPin;

/// The most ways to start that are on offer: as many cards as a panel has in two rows.
pub const MAX_STARTS: usize = 8;

/// A way to start that is on offer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VisitStart {
    /// Its name, as `mode` takes it.
    pub name: String,
    /// The mode.
    pub mode: SessionMode,
}

/// What an exhibition sets of its visits.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VisitSettings {
    /// Times, whether there are badges, and how a session starts where nothing is chosen: one of the starts.
    pub plan: VisitPlan,
    /// The languages to choose from, at least one, each once; a visit's language is a number in this list, 0 where none
    /// is chosen.
    pub languages: Vec<Language>,
    /// The ways to start that are on offer, 1 to [`MAX_STARTS`], each once.
    pub starts: Vec<VisitStart>,
    /// What opens the staff's panel; without it nothing does.
    pub staff_pin: Option<StaffPin>,
    /// The age from which the booth lets a visitor leave an e-mail address, in years; 0 where nobody may.
    pub email_from_age: u32,
}

impl VisitSettings {
    /// Visits before any setting is stored.
    pub(super) const fn unset() -> Self {
        VisitSettings {
            plan: VisitPlan::new(),
            languages: Vec::new(),
            starts: Vec::new(),
            staff_pin: None,
            email_from_age: 0,
        }
    }
}

/// The commands by which a world's plan becomes another, in the order of [`PlanSetting::ALL`] and the start last. One is
/// to be sent a tick; [`VisitCommand::Open`] makes the plan the default one.
pub fn plan_changes(from: &VisitPlan, to: &VisitPlan) -> impl Iterator<Item = VisitCommand> {
    let (from, to) = (*from, *to);
    let values = PlanSetting::ALL.into_iter().filter_map(move |setting| {
        let value = to.value(setting);
        (value != from.value(setting)).then_some(VisitCommand::Set { setting, value })
    });
    let start = (to.start() != from.start()).then_some(VisitCommand::SetStart(to.start()));
    // First, as a visitor may be welcome before the last of them is told.
    start.into_iter().chain(values)
}

#[cfg(test)]
mod tests;
