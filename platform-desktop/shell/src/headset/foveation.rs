//! Fixed foveated rendering: chooses the level. The caller must not change the level in the middle of a
//! stroke.

use std::fmt;

use super::device_health::{DeviceHealth, ThermalState};

/// The coarseness of shading towards the edges of a picture: `XrFoveationLevelFB`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub enum FoveationLevel {
    /// Full resolution everywhere (`NONE`).
    #[default]
    Off,
    /// Hardly visible.
    Low,
    /// Visible to people who look for it.
    Medium,
    /// The coarsest.
    High,
}

impl FoveationLevel {
    /// All levels with their names.
    pub const NAMES: [(&str, FoveationLevel); 4] = [
        ("off", FoveationLevel::Off),
        ("low", FoveationLevel::Low),
        ("medium", FoveationLevel::Medium),
        ("high", FoveationLevel::High),
    ];

    /// Returns the level with a name from [`FoveationLevel::NAMES`].
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let found = FoveationLevel::NAMES.into_iter().find(|(named, _)| *named == name);
        found.map(|(_, level)| level)
    }

    /// Returns a line for the log if a setting requests foveation and something that it needs is missing;
    /// `None` if no foveation was requested.
    #[must_use]
    pub fn describe_unmet_request(
        requested: Option<FoveationLevel>,
        missing: &str,
    ) -> Option<String> {
        let asked = requested.filter(|level| *level != FoveationLevel::Off)?;
        Some(format!("no foveation, though {asked} is asked for: {missing}"))
    }
}

/// The foveation to request from the runtime.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct Foveation {
    /// The level.
    pub level: FoveationLevel,
    /// `true` if the runtime may use a lower level while frames are on time.
    pub is_dynamic: bool,
}

impl Foveation {
    /// Chooses the foveation for a device's health and a setting. The setting is a least level; `Off`
    /// disables foveation, and `None` leaves it to the GPU and the health.
    ///
    /// An integrated GPU, as in headsets, gets at least MEDIUM, dynamic, from the first frame on, as Meta
    /// recommends: a sculpture that fills the view nearly exhausts its texture units.
    #[must_use]
    pub fn choose(
        health: DeviceHealth,
        minimum_or_off: Option<FoveationLevel>,
        is_gpu_integrated: bool,
    ) -> Self {
        let least = match health.thermal {
            ThermalState::Hot => FoveationLevel::High,
            ThermalState::Warm => FoveationLevel::Medium,
            ThermalState::Normal if health.is_battery_low() => FoveationLevel::Medium,
            ThermalState::Normal => FoveationLevel::Off,
        };
        let usual = if is_gpu_integrated { FoveationLevel::Medium } else { FoveationLevel::Off };
        match minimum_or_off {
            Some(FoveationLevel::Off) => {
                Foveation { level: FoveationLevel::Off, is_dynamic: false }
            }
            Some(minimum) => Foveation { level: minimum.max(least), is_dynamic: false },
            None => Foveation { level: usual.max(least), is_dynamic: is_gpu_integrated },
        }
    }
}

impl fmt::Display for Foveation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}{}", self.level, if self.is_dynamic { ", dynamic" } else { "" })
    }
}

impl fmt::Display for FoveationLevel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, _) = FoveationLevel::NAMES[*self as usize];
        f.write_str(name)
    }
}

#[cfg(test)]
mod tests {
    use super::{Foveation, FoveationLevel};
    use crate::headset::device_health::{Battery, DeviceHealth, ThermalState};

    const FINE: DeviceHealth = DeviceHealth {
        thermal: ThermalState::Normal,
        battery_percent: Some(90),
        drains_on_charger: false,
        battery: Battery { percent: Some(90), charging: false },
    };

    #[test]
    fn levels_are_named() {
        for (name, level) in FoveationLevel::NAMES {
            assert_eq!(level.to_string(), name);
        }
    }

    #[test]
    fn heat_or_a_low_battery_raises_it_and_their_end_lowers_it() {
        let hot = DeviceHealth { thermal: ThermalState::Hot, ..FINE };
        let warm = DeviceHealth { thermal: ThermalState::Warm, ..FINE };
        let low = DeviceHealth { battery_percent: Some(9), ..FINE };
        for (health, level) in [
            (FINE, FoveationLevel::Off),
            (warm, FoveationLevel::Medium),
            (low, FoveationLevel::Medium),
            (hot, FoveationLevel::High),
            (DeviceHealth { battery_percent: Some(9), ..hot }, FoveationLevel::High),
            // The charge isn't known while the battery is charging.
            (DeviceHealth { battery_percent: None, ..FINE }, FoveationLevel::Off),
        ] {
            assert_eq!(Foveation::choose(health, None, false).level, level, "{health:?}");
            let on_headset = Foveation::choose(health, None, true);
            let usual = level.max(FoveationLevel::Medium);
            assert_eq!(on_headset, Foveation { level: usual, is_dynamic: true }, "{health:?}");
            let set = |level| {
                let chosen = Foveation::choose(health, Some(level), true);
                assert!(!chosen.is_dynamic, "a level that is set holds");
                chosen.level
            };
            assert_eq!(set(FoveationLevel::Off), FoveationLevel::Off, "{health:?}");
            assert_eq!(set(FoveationLevel::Low), level.max(FoveationLevel::Low), "{health:?}");
            assert_eq!(set(FoveationLevel::High), FoveationLevel::High, "{health:?}");
        }
    }

    #[test]
    fn only_who_asks_is_told() {
        let told =
            |setting| FoveationLevel::describe_unmet_request(setting, "the runtime lacks it");
        assert_eq!(told(None), None);
        assert_eq!(told(Some(FoveationLevel::Off)), None);
        let line = "no foveation, though medium is asked for: the runtime lacks it";
        assert_eq!(told(Some(FoveationLevel::Medium)).as_deref(), Some(line));
    }
}
