//! What a shell says of its visits.

use paros_core::session::SessionMode;
use paros_core::visit::VisitPlan;
use paros_shaders::panel::Language;
use paros_shell::headset::hand_reader::HandSource;
use paros_shell::modes::parse_mode;
use paros_shell::settings::{BoothSettings, StaffPin, VisitSettings};
use paros_upload::SendPlan;

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
    /// Times, whether there are badges, and how a session starts where nothing is chosen.
    pub plan: VisitPlan,
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
            plan: VisitPlan::new(),
            languages: Language::ALL.to_vec(),
            starts: starts.into_iter().flatten().collect(),
            staff_pin: None,
            controls: Controls::Controllers,
        }
    }
}

/// How finished sculptures go to the booth; a studio without visits speaks English.
#[must_use]
pub fn send_plan(settings: &BoothSettings, visits: Option<&VisitOptions>) -> SendPlan {
    let languages = visits.map_or_else(|| vec![Language::English], |v| v.languages.clone());
    SendPlan { sends_traces: settings.sends_traces, languages }
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
        VisitOptions {
            plan: settings.plan,
            languages: settings.languages.clone(),
            starts: settings.starts.iter().map(|start| start.mode).collect(),
            staff_pin: settings.staff_pin,
            ..VisitOptions::default()
        }
    }

    /// The language of a number of the visit's.
    pub(crate) fn language(&self, number: u8) -> Language {
        let first = self.languages.first().copied().unwrap_or_default();
        self.languages.get(usize::from(number)).copied().unwrap_or(first)
    }
}

#[cfg(test)]
mod tests {
    use paros_shell::headset::hand_reader::HandSource;

    use super::Controls;

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
