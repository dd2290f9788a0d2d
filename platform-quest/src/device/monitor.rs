//! A polling thread for thermal state and battery: a call into Java may take longer than a frame.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use paros_shell::headset::device_health::{ChargeWatch, DeviceHealth, ThermalState};

use super::{AndroidDevice, Battery, ThermalReading, ThermalStatus};
use crate::log::write_log_line;

/// The polling interval. Android computes a new headroom at most once a second.
const POLL_INTERVAL: Duration = Duration::from_secs(10);

/// Thermal headrooms from which the device counts as warm and as hot; it throttles at 1.
const WARM_HEADROOM: f32 = 0.85;
const HOT_HEADROOM: f32 = 1.0;

/// Polls a device until it is dropped.
#[derive(Debug)]
pub struct DeviceMonitor {
    shared: Arc<MonitorState>,
    thread: Option<JoinHandle<()>>,
}

/// What the polling thread and the monitor share.
#[derive(Debug)]
struct MonitorState {
    device: AndroidDevice,
    latest: Mutex<DeviceHealth>,
    stop: AtomicBool,
}

impl DeviceMonitor {
    /// Starts the thread. If the system refuses a thread, the health stays the default.
    #[must_use]
    pub fn start_polling(device: AndroidDevice) -> Self {
        let (latest, stop) = (Mutex::new(DeviceHealth::default()), AtomicBool::new(false));
        let shared = Arc::new(MonitorState { device, latest, stop });
        let theirs = Arc::clone(&shared);
        let thread =
            thread::Builder::new().name("watch".into()).spawn(move || theirs.poll_until_stopped());
        DeviceMonitor { shared, thread: thread.ok() }
    }

    /// The device.
    #[must_use]
    pub fn device(&self) -> &AndroidDevice {
        &self.shared.device
    }

    /// The health that was read last.
    #[must_use]
    pub fn latest(&self) -> DeviceHealth {
        *self.shared.latest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for DeviceMonitor {
    fn drop(&mut self) {
        self.shared.stop.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // It returns nothing; a panic has been printed.
            let _ = thread.join();
        }
    }
}

impl MonitorState {
    /// Polls at [`POLL_INTERVAL`] until `stop` is set.
    fn poll_until_stopped(&self) {
        let mut charge = ChargeWatch::default();
        while !self.stop.load(Ordering::Acquire) {
            match (self.device.read_thermal(), self.device.read_battery()) {
                (Ok(thermal), Ok(battery)) => {
                    let drains = charge.observe(battery.percent, battery.charging);
                    let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
                    *latest = assess_health(thermal, battery, drains);
                }
                (Err(why), _) | (_, Err(why)) => write_log_line(format_args!("{why}")),
            }
            thread::park_timeout(POLL_INTERVAL);
        }
    }
}

/// The shell's thermal state and battery charge, by Android's readings, of a battery that drains on its charger or not.
fn assess_health(
    thermal: ThermalReading,
    battery: Battery,
    drains_on_charger: bool,
) -> DeviceHealth {
    let headroom = thermal.headroom.unwrap_or(0.0);
    let thermal = match thermal.status {
        status if status >= ThermalStatus::Severe || headroom >= HOT_HEADROOM => ThermalState::Hot,
        status if status >= ThermalStatus::Moderate || headroom >= WARM_HEADROOM => {
            ThermalState::Warm
        }
        _ => ThermalState::Normal,
    };
    let is_draining = !battery.charging || drains_on_charger;
    let battery_percent = battery.percent.filter(|_| is_draining);
    DeviceHealth { thermal, battery_percent, drains_on_charger }
}

#[cfg(test)]
mod tests {
    use paros_shell::headset::device_health::{DeviceHealth, ThermalState};

    use super::assess_health;
    use crate::device::{Battery, ThermalReading, ThermalStatus};

    #[test]
    fn readings_become_health() {
        let battery = Battery { percent: Some(40), charging: false };
        let thermal_of = |status, headroom| {
            assess_health(ThermalReading { status, headroom }, battery, false).thermal
        };
        assert_eq!(thermal_of(ThermalStatus::Light, None), ThermalState::Normal);
        assert_eq!(thermal_of(ThermalStatus::Moderate, Some(0.2)), ThermalState::Warm);
        assert_eq!(thermal_of(ThermalStatus::None, Some(0.9)), ThermalState::Warm);
        assert_eq!(thermal_of(ThermalStatus::None, Some(1.0)), ThermalState::Hot);
        assert_eq!(thermal_of(ThermalStatus::Shutdown, None), ThermalState::Hot);
        let cool = ThermalReading { status: ThermalStatus::None, headroom: None };
        let expected = DeviceHealth { battery_percent: Some(40), ..DeviceHealth::default() };
        assert_eq!(assess_health(cool, battery, false), expected);
        let charging = Battery { charging: true, ..battery };
        assert_eq!(assess_health(cool, charging, false).battery_percent, None);
        // On a charger that is too weak it is as without one.
        let weak = DeviceHealth { drains_on_charger: true, ..expected };
        assert_eq!(assess_health(cool, charging, true), weak);
    }
}
