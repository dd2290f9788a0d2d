//! What a shell says of its visits.

use paros_core::session::SessionMode;
use paros_core::visit::VisitCommand;
use paros_shaders::panel::Language;

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
#[derive(Clone, Debug)]
pub struct VisitOptions {
    /// The plan, as far as it isn't the core's own: sent a tick each once visits are open.
    pub plan: Vec<VisitCommand>,
    /// Languages on offer, that of who chose none first; at least one.
    pub languages: Vec<Language>,
    /// Ways to start on offer; with one there is nothing to choose.
    pub starts: Vec<SessionMode>,
    /// The staff's PIN; without one its panel stays shut.
    pub staff_pin: Option<[u8; 4]>,
    /// What visitors work with at first.
    pub controls: Controls,
    /// Random bits for badges, from the operating system.
    pub random_bits: fn() -> u32,
}

impl VisitOptions {
    /// The language of a number of the visit's.
    pub(crate) fn language(&self, number: u8) -> Language {
        let first = self.languages.first().copied().unwrap_or_default();
        self.languages.get(usize::from(number)).copied().unwrap_or(first)
    }
}
