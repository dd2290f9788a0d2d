//! Heat and battery: what is told of them. No stroke is stopped for either.

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
    /// What there is to say, where it was `before`; each once.
    #[must_use]
    pub fn warning(self, before: Strain) -> Option<&'static str> {
        if self.heat == Heat::Hot && before.heat != Heat::Hot {
            return Some("the headset is hot");
        }
        (self.is_low() && !before.is_low()).then_some("the battery is low")
    }

    /// Whether the battery is low.
    #[must_use]
    pub fn is_low(self) -> bool {
        self.charge.is_some_and(|charge| charge < LOW)
    }
}

#[cfg(test)]
mod tests {
    use super::{Heat, Strain};

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
