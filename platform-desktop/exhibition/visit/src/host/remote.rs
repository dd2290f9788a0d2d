//! The remote control by the booth's staff: commands to a headset, and its reported status.

use paros_core::session::TICK_RATE;
use paros_core::visit::{PlanSetting, Presence, StaffCommand, Visit, VisitCommand, VisitPhase};
use paros_protocol::{CommandKind, CommandOutcome, HeadsetStatus, HeatLevel};
use paros_upload::RemoteCommand;
use paros_upload::courier::Courier;

use super::VisitHost;
use crate::options::Controls;
use crate::screen::{ButtonAction, is_at_work};

/// Ticks for which a device identifies itself by glowing.
pub(super) const GLOW_TICKS: u32 = 5 * TICK_RATE;

/// A shell's readings of its device.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct DeviceStatus {
    /// The charge of the battery in percent; `None` if unknown.
    pub battery_percent: Option<u8>,
    /// `true` if the battery is being charged.
    pub is_charging: bool,
    /// The thermal state.
    pub heat: HeatLevel,
    /// `true` if the device shows pictures. Otherwise it isn't worn and refuses commands.
    pub is_awake: bool,
}

impl Default for DeviceStatus {
    /// Returns the status of a device without readings.
    fn default() -> Self {
        DeviceStatus {
            battery_percent: None,
            is_charging: false,
            heat: HeatLevel::Normal,
            is_awake: true,
        }
    }
}

/// The state of a headset that is reported to the booth.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) struct RemoteWatch {
    /// Random bits of the visit under way; 0 for none.
    session_id: u64,
    worn_ticks: u32,
    is_worn: bool,
    glow_ticks: u32,
    rings: bool,
}

impl RemoteWatch {
    /// Makes the state for a visit that is found in this phase.
    pub(super) fn of_visit(phase: VisitPhase) -> Self {
        let mut watch = RemoteWatch {
            session_id: 0,
            worn_ticks: 0,
            is_worn: false,
            glow_ticks: 0,
            rings: false,
        };
        if !matches!(phase, VisitPhase::Closed | VisitPhase::Attract) {
            watch.begin_visit();
        }
        watch
    }

    pub(super) fn begin_visit(&mut self) {
        // Without random bits the id is 0, and commands for a visit are refused or expire.
        self.session_id = getrandom::u64().map_or(0, |bits| bits.max(1));
        self.worn_ticks = 0;
    }

    pub(super) const fn end_visit(&mut self) {
        self.session_id = 0;
    }

    pub(super) fn note_tick(&mut self, phase: VisitPhase, presence: Presence, is_used: bool) {
        let is_visit =
            !matches!(phase, VisitPhase::Closed | VisitPhase::Attract | VisitPhase::Handover);
        self.is_worn = match presence {
            Presence::Worn => true,
            Presence::Off => false,
            Presence::Unknown => is_used && is_visit,
        };
        self.worn_ticks = if self.is_worn { self.worn_ticks.saturating_add(1) } else { 0 };
        self.glow_ticks = self.glow_ticks.saturating_sub(1);
    }

    pub(super) const fn is_glowing(&self) -> bool {
        self.glow_ticks > 0
    }

    /// Returns the id of the visit under way, for tests.
    #[cfg(test)]
    pub(super) const fn session_id(&self) -> u64 {
        self.session_id
    }
}

impl VisitHost {
    /// Carries out the commands that a courier received, and passes it the device's status. Call this after
    /// each tick, and from time to time while there are no ticks.
    pub fn follow_courier(&mut self, courier: &Courier, visit: &Visit, device: DeviceStatus) {
        while let Some(command) = courier.take_command() {
            let outcome = match device.is_awake {
                true => self.carry_out(&command, visit),
                false => CommandOutcome::Refused,
            };
            courier.note_command_done(command.id, outcome);
        }
        let RemoteWatch { session_id, worn_ticks, is_worn, .. } = self.remote;
        courier.report_status(HeadsetStatus {
            session_id,
            is_worn: is_worn && device.is_awake,
            is_glowing: self.remote.is_glowing(),
            phase: visit.phase(),
            worn_seconds: worn_ticks / TICK_RATE,
            ..status_of(device)
        });
    }

    /// Returns `true` once if the device is to ring, so that it is found.
    pub const fn take_ring(&mut self) -> bool {
        core::mem::replace(&mut self.remote.rings, false)
    }

    /// Returns `true` while the device glows, so that staff find it.
    #[must_use]
    pub const fn is_glowing(&self) -> bool {
        self.remote.is_glowing()
    }

    pub(super) fn carry_out(&mut self, command: &RemoteCommand, visit: &Visit) -> CommandOutcome {
        // The visit may have ended since the command arrived.
        if command.kind.is_for_visit() && command.session_id != self.remote.session_id {
            return CommandOutcome::Expired;
        }
        let phase = visit.phase();
        let has_clock = visit.plan().value(PlanSetting::Length) != 0;
        let can = match command.kind {
            CommandKind::Identify => true,
            CommandKind::Extend => {
                has_clock && is_at_work(phase) || phase == VisitPhase::HandsOff && !visit.is_left()
            }
            CommandKind::End => is_at_work(phase),
            // A window has no room to turn.
            CommandKind::Recentre => self.options.controls != Controls::Mouse,
            CommandKind::Reset => {
                !matches!(phase, VisitPhase::Closed | VisitPhase::Attract | VisitPhase::Handover)
            }
        };
        if !can {
            return CommandOutcome::Refused;
        }
        match command.kind {
            CommandKind::Identify => {
                (self.remote.glow_ticks, self.remote.rings) = (GLOW_TICKS, true);
            }
            CommandKind::Recentre => self.recentres = true,
            CommandKind::Extend => self.perform(ButtonAction::Staff(StaffCommand::Extend)),
            CommandKind::End => self.queue.push(VisitCommand::Staff(StaffCommand::End)),
            CommandKind::Reset => self.queue.push(VisitCommand::Staff(StaffCommand::Reset)),
        }
        CommandOutcome::Done
    }
}

/// Refuses all commands and reports the device's status, for a shell without visits.
pub fn answer_without_visits(courier: &Courier, device: DeviceStatus) {
    while let Some(command) = courier.take_command() {
        courier.note_command_done(command.id, CommandOutcome::Refused);
    }
    courier.report_status(status_of(device));
}

fn status_of(device: DeviceStatus) -> HeadsetStatus {
    HeadsetStatus {
        is_charging: device.is_charging,
        battery_percent: device.battery_percent,
        heat: device.heat,
        app_version: app_version(),
        ..HeadsetStatus::default()
    }
}

/// Returns the program's version, which all crates share.
fn app_version() -> [u16; 3] {
    let mut parts = env!("CARGO_PKG_VERSION").split('.').map(|part| part.parse().unwrap_or(0));
    core::array::from_fn(|_| parts.next().unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use paros_core::limits::INTERVALS;
    use paros_core::visit::VisitPhase;
    use paros_shell::tick_runner::with_fresh_world;

    use super::*;
    use crate::options::VisitOptions;

    fn host_in(controls: Controls) -> VisitHost {
        let options = VisitOptions { controls, ..VisitOptions::default() };
        let mut host = None;
        with_fresh_world::<128, INTERVALS, _>(|runner| {
            host = Some(VisitHost::new(options, runner.world().visit()));
        });
        host.expect("a host")
    }

    #[test]
    fn the_version_is_the_package_s() {
        assert_eq!(app_version().map(|part| part.to_string()).join("."), env!("CARGO_PKG_VERSION"));
    }

    #[test]
    fn a_command_of_another_visit_does_nothing() {
        let mut host = host_in(Controls::Controllers);
        host.remote.begin_visit();
        let own = host.remote.session_id;
        assert_ne!(own, 0);
        let mut outcome = |kind, session_id| {
            with_fresh_world::<128, INTERVALS, _>(|runner| {
                let command = RemoteCommand { id: 1, kind, session_id };
                host.carry_out(&command, runner.world().visit())
            })
        };
        assert_eq!(outcome(CommandKind::End, own ^ 1), CommandOutcome::Expired);
        assert_eq!(outcome(CommandKind::End, own), CommandOutcome::Refused, "nobody sculpts");
        assert_eq!(outcome(CommandKind::Identify, 0), CommandOutcome::Done);
        assert!(host.is_glowing());
        assert!(host.take_ring() && !host.take_ring());
        (0..GLOW_TICKS).for_each(|_| {
            host.remote.note_tick(VisitPhase::Attract, Presence::Off, false);
        });
        assert!(!host.is_glowing());
    }

    #[test]
    fn a_window_has_no_room_to_turn() {
        let mut host = host_in(Controls::Mouse);
        with_fresh_world::<128, INTERVALS, _>(|runner| {
            let command = RemoteCommand { id: 1, kind: CommandKind::Recentre, session_id: 0 };
            let visit = runner.world().visit();
            assert_eq!(host.carry_out(&command, visit), CommandOutcome::Refused);
        });
    }
}
