//! A thread that polls thermal state and battery, as a call into Java may take longer than a frame.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use paros_shell::headset::device_health::{ChargeWatch, DeviceHealth};

use super::AndroidDevice;
use crate::log::write_log_line;

/// The polling interval. Android computes a new headroom at most once a second.
const POLL_INTERVAL: Duration = Duration::from_secs(10);

/// The handle of the polling thread, which ends when the handle is dropped.
#[derive(Debug)]
pub struct DeviceMonitor {
    shared: Arc<MonitorState>,
    thread: Option<JoinHandle<()>>,
}

/// The state that the polling thread and the monitor share.
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

    /// Returns the device.
    #[must_use]
    pub fn device(&self) -> &AndroidDevice {
        &self.shared.device
    }

    /// Returns the health that was read last.
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
            // The thread returns nothing; a panic has been printed.
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
                    *latest = DeviceHealth::assess(thermal, battery, drains);
                }
                (Err(why), _) | (_, Err(why)) => write_log_line(format_args!("{why}")),
            }
            thread::park_timeout(POLL_INTERVAL);
        }
    }
}
