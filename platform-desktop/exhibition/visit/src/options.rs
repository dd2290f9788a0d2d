//! The options of visits that a shell sets.

use paros_core::session::SessionMode;
use paros_core::visit::VisitPlan;
use paros_shaders::panel::Language;
use paros_shell::headset::hand_reader::HandSource;
use paros_shell::modes::parse_mode;
use paros_shell::settings::{BoothSettings, StaffPin, VisitSettings};
use paros_upload::SendPlan;

/// The controls that visitors use. Texts are adapted to them.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum Controls {
    /// The controllers of a headset.
    #[default]
    Controllers,
    /// Bare hands with a headset.
    BareHands,
    /// A mouse or a touch screen.
    Mouse,
}

/// The settings of an exhibition for its visits.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct VisitOptions {
    /// Times, the use of badges, and the start of a session if nothing is chosen.
    pub plan: VisitPlan,
    /// Languages on offer, at least one. The first one is the default.
    pub languages: Vec<Language>,
    /// Ways to start on offer. With a single one there is no choice.
    pub starts: Vec<SessionMode>,
    /// The staff's PIN. Without a PIN the staff's panel can't be opened.
    pub staff_pin: Option<StaffPin>,
    /// The controls at the start.
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

/// Returns what is sent of finished sculptures to the booth. A studio without visits uses English.
#[must_use]
pub fn send_plan(settings: &BoothSettings, visits: Option<&VisitOptions>) -> SendPlan {
    let languages = visits.map_or_else(|| vec![Language::English], |v| v.languages.clone());
    SendPlan { sends_traces: settings.sends_traces, languages }
}

impl Controls {
    /// Returns the controls that match the hands' sources. A controller in either hand counts as controllers.
    /// Returns `None` while neither hand is tracked.
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
    /// Makes the options from settings.
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

    /// Returns the language of a visit's language number.
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
