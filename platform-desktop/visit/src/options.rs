//! What a shell says of its visits.

use paros_core::badge::BadgeLanguage;
use paros_core::session::SessionMode;
use paros_core::visit::{PlanSetting, VisitCommand, VisitPlan};
use paros_shaders::panel::Language;
use paros_shell::headset::hand_reader::HandSource;
use paros_shell::modes::parse_mode;
use paros_shell::settings::{StaffPin, VisitSettings};

/// What visitors work with: their texts tell of it.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Controls {
    /// A headset's.
    #[default]
    Controllers,
    /// A headset's, without controllers.
    BareHands,
    /// A mouse or a touch screen.
    Mouse,
}

/// What an exhibition sets of its visits.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VisitOptions {
    /// The plan, as far as it isn't the core's own: sent a tick each once visits are open.
    pub plan: Vec<VisitCommand>,
    /// Languages on offer, that of who chose none first; at least one.
    pub languages: Vec<Language>,
    /// Ways to start on offer; with one there is nothing to choose.
    pub starts: Vec<SessionMode>,
    /// The staff's PIN; without one its panel stays shut.
    pub staff_pin: Option<StaffPin>,
    /// What visitors work with at first.
    pub controls: Controls,
}

impl Default for VisitOptions {
    /// The core's plan, both languages, a free stone, an owl or a shape, and no PIN.
    fn default() -> Self {
        let owl = parse_mode("owl").ok();
        let starts = [Some(SessionMode::FreeForm), owl, Some(SessionMode::Creative)];
        VisitOptions {
            plan: Vec::new(),
            languages: Language::ALL.to_vec(),
            starts: starts.into_iter().flatten().collect(),
            staff_pin: None,
            controls: Controls::Controllers,
        }
    }
}

impl Controls {
    /// What a headset's hands are read from: a controller in either counts, as its owner holds it. None while neither
    /// hand is there.
    #[must_use]
    pub fn of_hands(sources: [HandSource; 2]) -> Option<Self> {
        let is_there = |wanted: &[HandSource]| sources.iter().any(|source| wanted.contains(source));
        if is_there(&[HandSource::Controller]) {
            Some(Controls::Controllers)
        } else {
            let bare = [HandSource::Joints, HandSource::HandInteraction];
            is_there(&bare).then_some(Controls::BareHands)
        }
    }
}

impl VisitOptions {
    /// Those of settings.
    #[must_use]
    pub fn of_settings(settings: &VisitSettings) -> Self {
        let language = |name: &BadgeLanguage| match name {
            BadgeLanguage::English => Language::English,
            BadgeLanguage::Greek => Language::Greek,
        };
        VisitOptions {
            plan: settings.plan_commands(),
            languages: settings.languages.iter().map(language).collect(),
            starts: settings.starts.iter().map(|start| start.mode).collect(),
            staff_pin: settings.staff_pin,
            ..VisitOptions::default()
        }
    }

    /// The commands by which the plan of a visit that was found becomes this one: an earlier run's may differ in what is
    /// the core's own here.
    pub(crate) fn changes_of_plan(&self, found: &VisitPlan) -> impl Iterator<Item = VisitCommand> {
        let mut plan = VisitPlan::new();
        for command in &self.plan {
            match *command {
                VisitCommand::Set { setting, value } => plan.set_value(setting, value),
                VisitCommand::SetStart(start) => plan.set_start(start),
                _ => {}
            }
        }
        let found = *found;
        let changed = PlanSetting::ALL.into_iter().filter_map(move |setting| {
            let value = plan.value(setting);
            (value != found.value(setting)).then_some(VisitCommand::Set { setting, value })
        });
        let start = (plan.start() != found.start()).then_some(plan.start());
        changed.chain(start.map(VisitCommand::SetStart))
    }

    /// The language of a number of the visit's.
    pub(crate) fn language(&self, number: u8) -> Language {
        let first = self.languages.first().copied().unwrap_or_default();
        self.languages.get(usize::from(number)).copied().unwrap_or(first)
    }
}

#[cfg(test)]
mod tests {
    use paros_core::visit::{PlanSetting, VisitCommand, VisitPlan};
    use paros_shell::headset::hand_reader::HandSource;

    use super::{Controls, VisitOptions};

    #[test]
    fn what_an_earlier_run_set_becomes_the_default_again() {
        let set = |setting, value| VisitCommand::Set { setting, value };
        let plan = vec![set(PlanSetting::Export, 30), set(PlanSetting::Thanks, 9)];
        let options = VisitOptions { plan, ..VisitOptions::default() };
        let mut found = VisitPlan::new();
        found.set_value(PlanSetting::Length, 90);
        found.set_value(PlanSetting::Thanks, 9);
        let length = PlanSetting::Length.default_value();
        assert_eq!(
            options.changes_of_plan(&found).collect::<Vec<_>>(),
            [set(PlanSetting::Length, length), set(PlanSetting::Export, 30)]
        );
    }

    #[test]
    fn texts_tell_of_what_the_hands_are_read_from() {
        use HandSource::{Controller, HandInteraction, Joints, None as Lost};
        for (sources, controls) in [
            ([Lost, Lost], None),
            ([Controller, Lost], Some(Controls::Controllers)),
            ([Lost, Joints], Some(Controls::BareHands)),
            ([HandInteraction, Joints], Some(Controls::BareHands)),
            ([Joints, Controller], Some(Controls::Controllers)),
        ] {
            assert_eq!(Controls::of_hands(sources), controls, "{sources:?}");
        }
    }
}
