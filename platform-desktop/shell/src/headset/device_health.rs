//! Thermal state and battery of the headset, and the warnings that they call for. No stroke is stopped
//! for either.

/// How hot the headset is, in three levels; OpenXR's notification levels NORMAL, WARNING, IMPAIRED.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub enum ThermalState {
    /// No throttling, and none near.
    #[default]
    Normal,
    /// The device will throttle if this goes on.
    Warm,
    /// The device throttles, or will be switched off.
    Hot,
}

/// Thermal state and battery.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct DeviceHealth {
    /// How hot the device is.
    pub thermal: ThermalState,
    /// The battery's charge in percent, where it is known and the battery isn't being charged.
    pub battery_percent: Option<u8>,
}

/// The charge in percent below which there is a warning.
const LOW_BATTERY: u8 = 15;

impl DeviceHealth {
    /// The warning that a change from `previous` calls for; each is given once.
    #[must_use]
    pub fn new_warning(self, previous: DeviceHealth) -> Option<&'static str> {
        if self.thermal == ThermalState::Hot && previous.thermal != ThermalState::Hot {
            return Some("the headset is hot");
        }
        (self.is_battery_low() && !previous.is_battery_low()).then_some("the battery is low")
    }

    /// Whether the battery is low, and not being charged.
    #[must_use]
    pub fn is_battery_low(self) -> bool {
        self.battery_percent.is_some_and(|percent| percent < LOW_BATTERY)
    }
}

#[cfg(test)]
mod tests {
    use super::{DeviceHealth, ThermalState};

    #[test]
    fn a_warning_is_given_once() {
        let fine = DeviceHealth { thermal: ThermalState::Normal, battery_percent: Some(90) };
        let low = DeviceHealth { battery_percent: Some(9), ..fine };
        assert!(low.new_warning(fine).is_some_and(|text| text.contains("battery")));
        assert_eq!(low.new_warning(low), None);
        let hot = DeviceHealth { thermal: ThermalState::Hot, ..low };
        assert!(hot.new_warning(low).is_some_and(|text| text.contains("hot")));
        assert_eq!(hot.new_warning(hot), None);
        assert_eq!(fine.new_warning(hot), None);
    }
}
