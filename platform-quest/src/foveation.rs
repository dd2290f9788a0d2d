//! How coarsely a picture is shaded away from its middle, and when. No level changes in the middle
//! of a stroke: that is up to who asks.

use std::fmt;

use crate::strain::{Heat, Strain};

/// How coarsely a picture is shaded away from its middle; `XrFoveationLevelFB`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub enum Foveation {
    /// Alike everywhere.
    #[default]
    Off,
    /// Hardly to be seen.
    Low,
    /// To be seen by who looks for it.
    Medium,
    /// As coarsely as can be.
    High,
}

/// The extensions of OpenXR that it takes, all of them.
pub const EXTENSIONS: [&str; 4] = [
    "XR_FB_foveation",
    "XR_FB_foveation_configuration",
    "XR_FB_foveation_vulkan",
    "XR_FB_swapchain_update_state",
];

impl Foveation {
    /// All levels by their names.
    pub const NAMED: [(&str, Foveation); 4] = [
        ("off", Foveation::Off),
        ("low", Foveation::Low),
        ("medium", Foveation::Medium),
        ("high", Foveation::High),
    ];

    /// The level for a strain, where a setting says how it is without: `None` leaves it to the
    /// strain alone, `Off` has it left off whatever comes.
    #[must_use]
    pub fn under(strain: Strain, setting: Option<Foveation>) -> Foveation {
        let least = match strain.heat {
            Heat::Hot => Foveation::High,
            Heat::Warm => Foveation::Medium,
            Heat::Normal if strain.is_low() => Foveation::Medium,
            Heat::Normal => Foveation::Off,
        };
        match setting {
            Some(Foveation::Off) => Foveation::Off,
            setting => setting.unwrap_or_default().max(least),
        }
    }

    /// What is told where a setting asks for it and something is missing. Nobody misses what was
    /// not asked for.
    #[must_use]
    pub fn missing(setting: Option<Foveation>, what: &str) -> Option<String> {
        let asked = setting.filter(|level| *level != Foveation::Off)?;
        Some(format!("no foveation, though {asked} is asked for: {what}"))
    }
}

impl fmt::Display for Foveation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, _) = Foveation::NAMED[*self as usize];
        f.write_str(name)
    }
}

#[cfg(test)]
mod tests {
    use super::Foveation;
    use crate::strain::{Heat, Strain};

    const FINE: Strain = Strain { heat: Heat::Normal, charge: Some(90) };

    #[test]
    fn levels_are_named() {
        for (name, level) in Foveation::NAMED {
            assert_eq!(level.to_string(), name);
        }
    }

    #[test]
    fn strain_raises_it_and_its_end_lowers_it() {
        let hot = Strain { heat: Heat::Hot, ..FINE };
        let warm = Strain { heat: Heat::Warm, ..FINE };
        let low = Strain { charge: Some(9), ..FINE };
        for (strain, level) in [
            (FINE, Foveation::Off),
            (warm, Foveation::Medium),
            (low, Foveation::Medium),
            (hot, Foveation::High),
            (Strain { charge: Some(9), ..hot }, Foveation::High),
            // One that is being charged has no charge to speak of.
            (Strain { charge: None, ..FINE }, Foveation::Off),
        ] {
            assert_eq!(Foveation::under(strain, None), level, "{strain:?}");
            let set = |level| Foveation::under(strain, Some(level));
            assert_eq!(set(Foveation::Off), Foveation::Off, "{strain:?}");
            assert_eq!(set(Foveation::Low), level.max(Foveation::Low), "{strain:?}");
            assert_eq!(set(Foveation::High), Foveation::High, "{strain:?}");
        }
    }

    #[test]
    fn only_who_asks_is_told() {
        let told = |setting| Foveation::missing(setting, "the runtime lacks it");
        assert_eq!(told(None), None);
        assert_eq!(told(Some(Foveation::Off)), None);
        let line = "no foveation, though medium is asked for: the runtime lacks it";
        assert_eq!(told(Some(Foveation::Medium)).as_deref(), Some(line));
    }
}
