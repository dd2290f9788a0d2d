//! Thermal state and battery of the headset, and the warnings for them. Neither ever interrupts a stroke.

/// The thermal state in three levels, OpenXR's notification levels NORMAL, WARNING and IMPAIRED.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default, Debug)]
pub enum ThermalState {
    /// The device neither throttles nor is about to.
    #[default]
    Normal,
    /// The device will soon throttle.
    Warm,
    /// The device throttles, or is about to shut down.
    Hot,
}

/// Thermal state and battery.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct DeviceHealth {
    /// The thermal state.
    pub thermal: ThermalState,
    /// The battery's charge in percent, if it is known and the battery discharges, be it on a charger.
    pub battery_percent: Option<u8>,
    /// `true` if the battery discharges on a charger that is too weak. See [`ChargeWatch`].
    pub drains_on_charger: bool,
    /// The battery as the device reports it, for staff who look after several headsets.
    pub battery: Battery,
}

/// The battery's state.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct Battery {
    /// The charge in percent, 0 to 100; `None` if the device does not know it.
    pub percent: Option<u8>,
    /// `true` if the battery is being charged.
    pub charging: bool,
}

/// The thermal status: the values of `PowerManager.THERMAL_STATUS_*`.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[expect(missing_docs, reason = "Android has no more words for them either")]
pub enum ThermalStatus {
    None = 0,
    Light = 1,
    Moderate = 2,
    Severe = 3,
    Critical = 4,
    Emergency = 5,
    Shutdown = 6,
}

/// The thermal status and its forecast.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct ThermalReading {
    /// The status now.
    pub status: ThermalStatus,
    /// The thermal headroom forecast for 10 s from now: at 1 the device throttles. `None` if the device does
    /// not know it.
    pub headroom: Option<f32>,
}

/// Detects a battery that discharges on its charger. Devices report such a battery as charging, and a headset
/// is worn on the cable all day; so the charge itself is compared from reading to reading.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub enum ChargeWatch {
    /// The battery isn't being charged, or its charge is unknown.
    #[default]
    Unplugged,
    /// The battery is being charged.
    Charging {
        /// The greatest charge since charging began, in percent.
        highest: u8,
    },
    /// The battery discharges on its charger.
    Draining {
        /// The least charge since it began to discharge, in percent.
        lowest: u8,
    },
}

/// The fall of the charge, in percent, from which a battery counts as discharging on its charger. A fall of 1
/// might be rounding, or the moment of plugging in.
const DRAINED_PERCENT: u8 = 2;

impl ChargeWatch {
    /// Adds a reading. Returns `true` if the battery discharges on its charger: its charge has fallen by 2
    /// percent while charging and hasn't risen since.
    pub fn observe(&mut self, percent: Option<u8>, is_charging: bool) -> bool {
        *self = match (*self, percent.filter(|_| is_charging)) {
            (_, None) => ChargeWatch::Unplugged,
            (ChargeWatch::Unplugged, Some(percent)) => ChargeWatch::Charging { highest: percent },
            (ChargeWatch::Charging { highest }, Some(percent)) => {
                if percent.saturating_add(DRAINED_PERCENT) <= highest {
                    ChargeWatch::Draining { lowest: percent }
                } else {
                    ChargeWatch::Charging { highest: highest.max(percent) }
                }
            }
            (ChargeWatch::Draining { lowest }, Some(percent)) => {
                if percent > lowest {
                    ChargeWatch::Charging { highest: percent }
                } else {
                    ChargeWatch::Draining { lowest: percent }
                }
            }
        };
        matches!(self, ChargeWatch::Draining { .. })
    }
}

/// Thermal headrooms from which the device counts as warm and as hot; it throttles at 1.
const WARM_HEADROOM: f32 = 0.85;
const HOT_HEADROOM: f32 = 1.0;

/// The charge in percent below which there is a warning.
const LOW_BATTERY: u8 = 15;

impl DeviceHealth {
    /// Assesses the device's health from Android's readings and from [`ChargeWatch::observe`].
    #[must_use]
    pub fn assess(thermal: ThermalReading, battery: Battery, drains_on_charger: bool) -> Self {
        let headroom = thermal.headroom.unwrap_or(0.0);
        let thermal = match thermal.status {
            status if status >= ThermalStatus::Severe || headroom >= HOT_HEADROOM => {
                ThermalState::Hot
            }
            status if status >= ThermalStatus::Moderate || headroom >= WARM_HEADROOM => {
                ThermalState::Warm
            }
            _ => ThermalState::Normal,
        };
        let is_draining = !battery.charging || drains_on_charger;
        let battery_percent = battery.percent.filter(|_| is_draining);
        DeviceHealth { thermal, battery_percent, drains_on_charger, battery }
    }

    /// Returns the warning for a change from `previous`, or `None` if nothing has become worse.
    #[must_use]
    pub fn new_warning(self, previous: DeviceHealth) -> Option<&'static str> {
        if self.thermal == ThermalState::Hot && previous.thermal != ThermalState::Hot {
            return Some("the headset is hot");
        }
        if self.drains_on_charger && !previous.drains_on_charger {
            return Some("the battery drains on its charger, which is too weak");
        }
        (self.is_battery_low() && !previous.is_battery_low()).then_some("the battery is low")
    }

    /// Returns `true` if the battery is low, and either isn't being charged or drains on its charger.
    #[must_use]
    pub fn is_battery_low(self) -> bool {
        self.battery_percent.is_some_and(|percent| percent < LOW_BATTERY)
    }
}

impl ThermalStatus {
    /// Returns the status for Android's number. Unknown numbers of later Android versions count as the worst
    /// status.
    #[must_use]
    pub fn from_number(number: i32) -> Self {
        use ThermalStatus::{Critical, Emergency, Light, Moderate, None, Severe, Shutdown};
        let all = [None, Light, Moderate, Severe, Critical, Emergency, Shutdown];
        let known = usize::try_from(number).map(|number| all.get(number).copied());
        known.map_or(None, |known| known.unwrap_or(Shutdown))
    }
}

#[cfg(test)]
mod tests {
    use super::{Battery, ChargeWatch, DeviceHealth, ThermalReading, ThermalState, ThermalStatus};

    #[test]
    fn a_warning_is_given_once() {
        let fine = DeviceHealth { battery_percent: Some(90), ..DeviceHealth::default() };
        let low = DeviceHealth { battery_percent: Some(9), ..fine };
        assert!(low.new_warning(fine).is_some_and(|text| text.contains("battery")));
        assert_eq!(low.new_warning(low), None);
        let hot = DeviceHealth { thermal: ThermalState::Hot, ..low };
        assert!(hot.new_warning(low).is_some_and(|text| text.contains("hot")));
        assert_eq!(hot.new_warning(hot), None);
        assert_eq!(fine.new_warning(hot), None);
    }

    /// Returns, for each reading, whether the battery discharges on its charger after it.
    fn drains_after(readings: &[(u8, bool)]) -> Vec<bool> {
        let mut watch = ChargeWatch::default();
        readings
            .iter()
            .map(|(percent, charging)| watch.observe(Some(*percent), *charging))
            .collect()
    }

    #[test]
    fn a_battery_that_falls_on_its_charger_drains_until_it_rises() {
        let falls = [
            (50, true),
            (49, true),
            (48, true),
            (48, true),
            (47, true),
            (48, true),
            (47, true),
            (46, true),
        ];
        let expected = [false, false, true, true, true, false, false, true];
        assert_eq!(drains_after(&falls), expected);
        // The fall counts from the highest charge since it was plugged in.
        assert_eq!(
            drains_after(&[(50, true), (53, true), (52, true), (51, true)]),
            [false, false, false, true]
        );
        // Without a charger it only empties.
        assert_eq!(drains_after(&[(50, false), (40, false), (39, true), (38, true)]), [false; 4]);
        // Unplugging resets the watch.
        assert_eq!(
            drains_after(&[(50, true), (48, true), (48, false), (47, true)]),
            [false, true, false, false]
        );
        assert_eq!(
            drains_after(&[(1, true), (0, true), (100, true), (98, true)]),
            [false, false, false, true]
        );
        let mut watch = ChargeWatch::Draining { lowest: 40 };
        assert!(!watch.observe(None, true), "nothing is known");
    }

    #[test]
    fn a_weak_charger_is_told_once_and_before_the_battery_is_low() {
        let fine = DeviceHealth { battery_percent: Some(60), ..DeviceHealth::default() };
        let drains = DeviceHealth { drains_on_charger: true, ..fine };
        assert!(drains.new_warning(fine).is_some_and(|text| text.contains("charger")));
        assert_eq!(drains.new_warning(drains), None);
        let low = DeviceHealth { battery_percent: Some(9), ..drains };
        assert!(low.new_warning(drains).is_some_and(|text| text.contains("low")));
    }

    #[test]
    fn readings_become_health() {
        let battery = Battery { percent: Some(40), charging: false };
        let thermal_of = |status, headroom| {
            DeviceHealth::assess(ThermalReading { status, headroom }, battery, false).thermal
        };
        assert_eq!(thermal_of(ThermalStatus::Light, None), ThermalState::Normal);
        assert_eq!(thermal_of(ThermalStatus::Moderate, Some(0.2)), ThermalState::Warm);
        assert_eq!(thermal_of(ThermalStatus::None, Some(0.9)), ThermalState::Warm);
        assert_eq!(thermal_of(ThermalStatus::None, Some(1.0)), ThermalState::Hot);
        assert_eq!(thermal_of(ThermalStatus::Shutdown, None), ThermalState::Hot);
        let cool = ThermalReading { status: ThermalStatus::None, headroom: None };
        let expected =
            DeviceHealth { battery_percent: Some(40), battery, ..DeviceHealth::default() };
        assert_eq!(DeviceHealth::assess(cool, battery, false), expected);
        let charging = Battery { charging: true, ..battery };
        let on_charger = DeviceHealth::assess(cool, charging, false);
        assert_eq!((on_charger.battery_percent, on_charger.battery), (None, charging));
        // A charger that is too weak counts as none.
        let weak = DeviceHealth { drains_on_charger: true, battery: charging, ..expected };
        assert_eq!(DeviceHealth::assess(cool, charging, true), weak);
    }
}
