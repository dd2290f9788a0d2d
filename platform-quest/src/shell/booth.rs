//! The headset's connection to a booth.

use std::mem;
use std::sync::Arc;

use paros_core::limits::INTERVALS;
use paros_core::session::SessionState;
use paros_core::visit::VisitPhase;
use paros_core::volume::{Grid, Size};
use paros_protocol::{HeatLevel, Parcel};
use paros_shell::headset::device_health::{DeviceHealth, ThermalState};
use paros_shell::statics::Resident;
use paros_shell::studio::Studio;
use paros_sound::Speaker;
use paros_upload::connect;
use paros_upload::courier::Courier;
use paros_upload::enrolment::Enrolment;
use paros_visit::{DeviceStatus, answer_without_visits, send_plan};

use super::HeadsetShell;
use crate::boot_clock::read_since_boot;
use crate::options::ShellOptions;
use crate::platform::Platform;

/// Connects a studio to the booth at which the device is enrolled, if any, and returns the courier that sends
/// its sculptures. The courier also takes over the parcels in `without_room`, for which the previous courier
/// had no room. On an error, which is logged, the studio works without a booth, and `without_room` is
/// unchanged.
pub(super) fn bring_to_booth<const N: usize>(
    studio: &mut Studio<'_, N>,
    options: &ShellOptions,
    platform: &mut dyn Platform,
    without_room: &mut Vec<Parcel>,
) -> Option<Arc<Courier>>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let folder = platform.booth_folder(&studio.paths().sessions);
    let courier = open_courier(options, &folder, platform);
    let courier = courier.inspect_err(|why| platform.log(format_args!("{why}"))).ok().flatten()?;
    courier.keep_parcels(mem::take(without_room));
    Some(connect(studio, courier, send_plan(&options.booth, options.visits.as_ref())))
}

fn open_courier(
    options: &ShellOptions,
    folder: &std::path::Path,
    platform: &mut dyn Platform,
) -> Result<Option<Courier>, String> {
    let connect = |enrolment: &Enrolment| {
        let link = platform.open_booth_link(enrolment);
        link.ok_or_else(|| "nothing is sent to the booth: there is no way there".to_owned())
    };
    Courier::open_enrolled(&options.booth, folder, read_clock_ms, connect)
}

fn read_clock_ms() -> u64 {
    u64::try_from(read_since_boot().as_millis()).unwrap_or(u64::MAX)
}

impl<const N: usize> HeadsetShell<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Carries out the booth's requests, reports the headset's status, and logs the upload status of
    /// sculptures.
    pub(super) fn follow_booth(&mut self, is_awake: bool, platform: &mut dyn Platform) {
        // A finished sculpture isn't sent to a new booth: its making wasn't recorded for the booth.
        let is_finished = self.studio.world().session_state() == SessionState::Finished;
        self.is_enrolled_anew |= platform.poll_enrolled();
        let is_forgotten = self.courier.as_ref().is_some_and(|courier| courier.is_forgotten());
        if is_forgotten && !self.is_enrolled_anew {
            platform.enrol_again();
        }
        // Opening another courier reads the whole outbox: do it only while nobody carves.
        let phase = self.studio.world().visit().phase();
        let is_between = matches!(phase, VisitPhase::Closed | VisitPhase::Attract);
        let is_idle = !is_awake || self.host.is_some() && is_between;
        let is_time = !is_finished && (is_idle || self.courier.is_none());
        if is_time && self.is_enrolled_anew {
            self.is_enrolled_anew = false;
            // Close the old courier first: both use the same outbox folder. Its parcels are sent under the
            // new enrolment.
            self.studio.set_receiver(None);
            let ended = self.courier.take().and_then(Arc::into_inner).map(Courier::close);
            self.without_room.extend(ended.unwrap_or_default());
            let without_room = &mut self.without_room;
            self.courier = bring_to_booth(&mut self.studio, self.options, platform, without_room);
        }
        let Some(courier) = &self.courier else { return };
        let device = DeviceStatus { is_awake, ..device_status(self.health, self.runtime_thermal) };
        match &mut self.host {
            Some(host) => {
                host.follow_courier(courier, self.studio.world().visit(), device);
                if host.take_ring() {
                    self.speaker.iter_mut().for_each(Speaker::ring);
                }
            }
            None => answer_without_visits(courier, device),
        }
        for note in courier.take_notes() {
            platform.log(format_args!("{note}"));
        }
    }
}

/// Returns the battery and heat status for the booth. `runtime_thermal` is the thermal state that the OpenXR
/// runtime reports.
fn device_status(health: DeviceHealth, runtime_thermal: ThermalState) -> DeviceStatus {
    DeviceStatus {
        battery_percent: health.battery.percent,
        is_charging: health.battery.charging,
        heat: heat_of(health.thermal.max(runtime_thermal)),
        ..DeviceStatus::default()
    }
}

const fn heat_of(thermal: ThermalState) -> HeatLevel {
    match thermal {
        ThermalState::Normal => HeatLevel::Normal,
        ThermalState::Warm => HeatLevel::Warm,
        ThermalState::Hot => HeatLevel::Hot,
    }
}

#[cfg(test)]
mod tests {
    use paros_protocol::HeatLevel;
    use paros_shell::headset::device_health::{
        Battery, DeviceHealth, ThermalReading, ThermalState, ThermalStatus,
    };

    use super::device_status;

    #[test]
    fn the_booth_hears_of_a_battery_on_its_charger_and_of_the_greater_heat() {
        let cool = ThermalReading { status: ThermalStatus::None, headroom: None };
        let battery = Battery { percent: Some(40), charging: true };
        let health = DeviceHealth::assess(cool, battery, false);
        let told = device_status(health, ThermalState::Warm);
        assert_eq!((told.battery_percent, told.is_charging), (Some(40), true));
        assert_eq!(told.heat, HeatLevel::Warm);
        let hot = DeviceHealth { thermal: ThermalState::Hot, ..health };
        assert_eq!(device_status(hot, ThermalState::Warm).heat, HeatLevel::Hot);
    }
}
