//! The settings of visits, and the commands that send them to a world.

use paros_core::badge::Language;
use paros_core::session::SessionMode;
use paros_core::visit::{PlanSetting, VisitCommand, VisitPlan};

use super::pin::StaffPin;

/// The most session starts on offer: the cards that fit on a panel in two rows.
pub const MAX_STARTS: usize = 8;

/// A session start on offer.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VisitStart {
    /// The name, as in the setting `mode`.
    pub name: String,
    /// The mode.
    pub mode: SessionMode,
}

/// The settings of an exhibition's visits.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VisitSettings {
    /// The times, whether there are badges, and the start if nothing is chosen, which is one of `starts`.
    pub plan: VisitPlan,
    /// The languages to choose from, at least one, without repetition. A visit's language is an index into
    /// this list, 0 if none is chosen.
    pub languages: Vec<Language>,
    /// The session starts on offer, 1 to [`MAX_STARTS`], without repetition.
    pub starts: Vec<VisitStart>,
    /// The PIN that opens the staff's panel; without a PIN the panel can't be opened.
    pub staff_pin: Option<StaffPin>,
    /// The age in years from which a visitor may leave an e-mail address at the booth; 0 if nobody may.
    pub email_from_age: u32,
}

impl VisitSettings {
    /// Returns the settings before any value is stored.
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

/// Returns the commands that change a world's plan from one to another: the start first, then the others in
/// the order of [`PlanSetting::ALL`]. Send one command per tick. [`VisitCommand::Open`] resets the plan to
/// the default.
pub fn plan_changes(from: &VisitPlan, to: &VisitPlan) -> impl Iterator<Item = VisitCommand> {
    let (from, to) = (*from, *to);
    let values = PlanSetting::ALL.into_iter().filter_map(move |setting| {
        let value = to.value(setting);
        (value != from.value(setting)).then_some(VisitCommand::Set { setting, value })
    });
    let start = (to.start() != from.start()).then_some(VisitCommand::SetStart(to.start()));
    // The start comes first, as a visitor may begin before the last command is sent.
    start.into_iter().chain(values)
}

#[cfg(test)]
mod tests;
