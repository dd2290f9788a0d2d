//! The headset's way to a booth.

use paros_core::limits::INTERVALS;
use paros_core::outbox::messages::HeatLevel;
use paros_core::volume::{Grid, Size};
use paros_shaders::panel::Language;
use paros_shell::headset::device_health::ThermalState;
use paros_shell::outbox::courier::Courier;
use paros_shell::outbox::enrolment::Enrolment;
use paros_shell::statics::Resident;
use paros_shell::studio::{SendPlan, Studio};
use paros_sound::Speaker;
use paros_visit::{DeviceStatus, answer_without_visits};

use super::HeadsetShell;
use crate::boot_clock::read_since_boot;
use crate::options::ShellOptions;
use crate::platform::Platform;

/// Has a studio's sculptures brought to the booth at which the device is enrolled, if it is at one. What stands in the way
/// is logged, and the studio goes on without.
pub(super) fn bring_to_booth<const N: usize>(
    studio: &mut Studio<'_, N>,
    options: &ShellOptions,
    platform: &mut dyn Platform,
) where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    let folder = platform.booth_folder(&studio.paths().sessions);
    let settings = &options.booth;
    match open_courier(options, &folder, platform) {
        Ok(None) => {}
        Ok(Some(courier)) => {
            let visits = options.visits.as_ref();
            let languages = visits.map_or_else(|| vec![Language::English], |v| v.languages.clone());
            let (kind, sends_traces) = (settings.kind(), settings.sends_traces);
            studio.set_courier(courier, SendPlan { kind, sends_traces, languages });
        }
        Err(why) => platform.log(format_args!("{why}")),
    }
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
    /// Carries out what the booth asks, tells it how the headset is, and logs what has become of sculptures.
    pub(super) fn follow_booth(&mut self, is_awake: bool, platform: &mut dyn Platform) {
        let Some(courier) = self.studio.courier() else { return };
        let device = DeviceStatus {
            battery_percent: self.health.battery_percent,
            // The charge is told of a battery that isn't being charged, or drains all the same.
            is_charging: self.health.drains_on_charger,
            heat: heat_of(self.health.thermal.max(self.runtime_thermal)),
            is_awake,
        };
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

const fn heat_of(thermal: ThermalState) -> HeatLevel {
    match thermal {
        ThermalState::Normal => HeatLevel::Normal,
        ThermalState::Warm => HeatLevel::Warm,
        ThermalState::Hot => HeatLevel::Hot,
    }
}
