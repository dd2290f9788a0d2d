//! Heat and battery: what is told to the visitor, and how much is drawn less finely for it.

/// How far the edges of the view are drawn less finely; OpenXR's `XrFoveationLevelFB`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub enum Foveation {
    /// Not at all.
    Off,
    /// A little.
    Low,
    /// The usual.
    #[default]
    Medium,
    /// As far as it goes.
    High,
}

/// How hot the headset is.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub enum Heat {
    /// Not to speak of.
    #[default]
    Normal,
    /// It will be slowed down if this goes on.
    Warm,
    /// It is being slowed down, or will be switched off.
    Hot,
}

/// What a headset tells of itself.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Strain {
    /// How hot it is.
    pub heat: Heat,
    /// Hundredths of the battery's charge, where that is known and it isn't being charged.
    pub charge: Option<u8>,
}

/// Hundredths of charge below which there is a warning.
const LOW: u8 = 15;

impl Strain {
    /// How far to foveate, where the setting says `usual`: more under strain, never less. Nothing
    /// else is done, and no stroke is stopped.
    #[must_use]
    pub fn foveation(self, usual: Foveation) -> Foveation {
        match self.heat {
            Heat::Hot => Foveation::High,
            Heat::Warm => usual.max(Foveation::Medium),
            Heat::Normal if self.is_low() => usual.max(Foveation::Medium),
            Heat::Normal => usual,
        }
    }

    /// What there is to say, where it was `before`; each once.
    #[must_use]
    pub fn warning(self, before: Strain) -> Option<&'static str> {
        if self.heat == Heat::Hot && before.heat != Heat::Hot {
            return Some("the headset is hot: the edges are drawn less finely");
        }
        (self.is_low() && !before.is_low()).then_some("the battery is low")
    }

    fn is_low(self) -> bool {
        self.charge.is_some_and(|charge| charge < LOW)
    }
}

#[cfg(test)]
mod tests {
    use super::{Foveation, Heat, LOW, Strain};

    #[test]
    fn strain_raises_foveation_and_never_lowers_it() {
        let levels = [Foveation::Off, Foveation::Low, Foveation::Medium, Foveation::High];
        for heat in [Heat::Normal, Heat::Warm, Heat::Hot] {
            for charge in [None, Some(LOW), Some(LOW - 1)] {
                for usual in levels {
                    assert!(Strain { heat, charge }.foveation(usual) >= usual);
                }
            }
        }
        assert_eq!(Strain::default().foveation(Foveation::Off), Foveation::Off);
        let hot = Strain { heat: Heat::Hot, charge: None };
        assert_eq!(hot.foveation(Foveation::Off), Foveation::High);
    }

    #[test]
    fn a_warning_is_given_once() {
        let fine = Strain { heat: Heat::Normal, charge: Some(90) };
        let low = Strain { charge: Some(9), ..fine };
        assert!(low.warning(fine).is_some_and(|text| text.contains("battery")));
        assert_eq!(low.warning(low), None);
        let hot = Strain { heat: Heat::Hot, ..low };
        assert!(hot.warning(low).is_some_and(|text| text.contains("hot")));
        assert_eq!(hot.warning(hot), None);
        assert_eq!(fine.warning(hot), None);
    }
}
