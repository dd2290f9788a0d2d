//! Heat and battery, asked for now and then beside the frames: a call takes as long as it takes.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::{Battery, Device, Heat as Told, Thermal};
use crate::strain::{Heat, Strain};

/// How often the device is asked. It forecasts heat once a second at the most.
const EVERY: Duration = Duration::from_secs(10);

/// Forecasts of heat, 1 being where the device throttles, from which it counts as warm and as hot.
const WARM: f32 = 0.85;
const HOT: f32 = 1.0;

/// A device that is watched until this is dropped.
#[derive(Debug)]
pub struct Watch {
    watched: Arc<Watched>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Debug)]
struct Watched {
    device: Device,
    latest: Mutex<Strain>,
    over: AtomicBool,
}

impl Watch {
    /// Begins to watch a device. Where the system gives no thread, nothing is known of its strain.
    #[must_use]
    pub fn new(device: Device) -> Self {
        let (latest, over) = (Mutex::new(Strain::default()), AtomicBool::new(false));
        let watched = Arc::new(Watched { device, latest, over });
        let theirs = Arc::clone(&watched);
        let thread = thread::Builder::new().name("watch".into()).spawn(move || theirs.watch());
        Watch { watched, thread: thread.ok() }
    }

    /// The device.
    #[must_use]
    pub fn device(&self) -> &Device {
        &self.watched.device
    }

    /// What it told last.
    #[must_use]
    pub fn strain(&self) -> Strain {
        *self.watched.latest.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        self.watched.over.store(true, Ordering::Release);
        if let Some(thread) = self.thread.take() {
            thread.thread().unpark();
            // It has nothing to say but that it panicked, which it has said.
            let _ = thread.join();
        }
    }
}

impl Watched {
    fn watch(&self) {
        while !self.over.load(Ordering::Acquire) {
            match (self.device.heat(), self.device.battery()) {
                (Ok(heat), Ok(battery)) => {
                    let mut latest = self.latest.lock().unwrap_or_else(PoisonError::into_inner);
                    *latest = strain(heat, battery);
                }
                (Err(why), _) | (_, Err(why)) => eprintln!("paros-quest: {why}"),
            }
            thread::park_timeout(EVERY);
        }
    }
}

/// What a device's numbers mean for the shell.
fn strain(heat: Told, battery: Battery) -> Strain {
    let forecast = heat.headroom.unwrap_or(0.0);
    let heat = match heat.status {
        status if status >= Thermal::Severe || forecast >= HOT => Heat::Hot,
        status if status >= Thermal::Moderate || forecast >= WARM => Heat::Warm,
        _ => Heat::Normal,
    };
    Strain { heat, charge: battery.percent.filter(|_| !battery.charging) }
}

#[cfg(test)]
mod tests {
    use super::strain;
    use crate::device::{Battery, Heat as Told, Thermal};
    use crate::strain::{Heat, Strain};

    #[test]
    fn numbers_become_strain() {
        let battery = Battery { percent: Some(40), charging: false };
        let heat_of = |status, headroom| strain(Told { status, headroom }, battery).heat;
        assert_eq!(heat_of(Thermal::Light, None), Heat::Normal);
        assert_eq!(heat_of(Thermal::Moderate, Some(0.2)), Heat::Warm);
        assert_eq!(heat_of(Thermal::None, Some(0.9)), Heat::Warm);
        assert_eq!(heat_of(Thermal::None, Some(1.0)), Heat::Hot);
        assert_eq!(heat_of(Thermal::Shutdown, None), Heat::Hot);
        let cool = Told { status: Thermal::None, headroom: None };
        assert_eq!(strain(cool, battery), Strain { heat: Heat::Normal, charge: Some(40) });
        let charging = Battery { charging: true, ..battery };
        assert_eq!(strain(cool, charging).charge, None);
    }
}
