//! Visits: passes head and hands to the visit host, and applies its requests to the room.

use std::fmt;
use std::time::Duration;

use paros_core::TickInput;
use paros_core::internals::RoomPose;
use paros_core::limits::INTERVALS;
use paros_core::visit::{Visit, VisitPhase};
use paros_core::volume::{Grid, Size};
use paros_headset::room_placement::PlacementNeed;
use paros_shaders::gpu::Renderer;
use paros_shaders::panel::Panel;
use paros_shell::headset::hand_sample::HandSample;
use paros_shell::headset::haptics::TickHaptics;
use paros_shell::last_use::LastUse;
use paros_shell::statics::Resident;
use paros_visit::{ExportState, HeadsetTick, VisitHost, close_visits};

use super::HeadsetShell;
use crate::options::ShellOptions;
use crate::platform::Platform;

/// Returns the host of visits, if visits are enabled. A recording begins a new visit, even if one was found
/// on the disk.
pub(super) fn open_host(
    options: &ShellOptions,
    start_anew: bool,
    visit: &Visit,
) -> Option<VisitHost> {
    let mut host = VisitHost::new(options.visits.clone()?, visit);
    if start_anew {
        host.begin_anew();
    }
    Some(host)
}

impl<const N: usize> HeadsetShell<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Passes to the host a visit that was found on the disk, and for how long the headset was unused.
    pub(super) fn resume_visit(&mut self, last_use: Option<LastUse>, platform: &mut dyn Platform) {
        let visit = self.studio.world().visit();
        let Some(host) = self.host.as_mut().filter(|_| visit.phase() != VisitPhase::Closed) else {
            return;
        };
        let unused = last_use.and_then(|used| used.time_until(self.boot, platform.since_boot()));
        host.note_found(visit, unused);
        let phase = visit.phase();
        match unused {
            Some(unused) => {
                let seconds = unused.as_secs();
                platform.log(format_args!("a visit goes on: {phase:?}, unused for {seconds} s"));
            }
            None => platform.log(format_args!("a former visitor's visit is found: {phase:?}")),
        }
    }

    /// Adds the visit's part to a tick's input. Without a host all visits are closed.
    pub(super) fn fill_visit_input(
        &mut self,
        (now, head, hands, is_menu_down): (Duration, Option<RoomPose>, &[HandSample; 2], bool),
        input: &mut TickInput,
    ) {
        let Some(host) = &mut self.host else {
            return close_visits(self.studio.world().visit(), input);
        };
        let tick = HeadsetTick {
            now,
            head: head.map(|(position, _)| position),
            hands,
            sources: self.hand_readers.map(|reader| reader.source()),
            is_menu_down,
            presence: self.visit.presence(),
            is_used: self.visit.is_used(),
        };
        host.fill_headset_input(self.studio.world(), &tick, input);
    }

    /// Passes the result of a tick to the host. If the host requests it, as for a new visitor, the room is
    /// placed again.
    pub(super) fn follow_visit_tick(&mut self) {
        let Some(host) = &mut self.host else { return };
        let export = ExportState::of_studio(&self.studio, self.courier.as_deref());
        host.follow_headset_tick(self.studio.world(), &export);
        if host.take_recentring() {
            self.placement.request(PlacementNeed::Anyhow);
        }
    }

    /// Passes the finished preview pictures of a choice to the renderer.
    pub(super) fn hand_over_previews(&mut self, renderer: &mut Renderer) {
        if let Some(host) = &mut self.host {
            host.hand_over_previews(|cell, picture| renderer.set_panel_picture(cell, picture));
        }
    }

    /// Returns the haptics of both hands for the last tick.
    pub(super) fn felt_of_last_tick(&self) -> [TickHaptics; 2] {
        let world = self.studio.world();
        let mut felt = TickHaptics::of_last_tick(world);
        if let Some(host) = &self.host {
            host.adapt_haptics(world.visit(), &mut felt);
        }
        felt
    }

    /// Returns `true` if the host moves the hands in the world, so that the visitor's must be hidden.
    pub(super) fn host_moves_hands(&self) -> bool {
        self.host.is_some() && VisitHost::moves_hands(self.studio.world().visit())
    }

    /// Returns the panels of the visit.
    pub(super) fn visit_panels(&self) -> &[Panel] {
        self.host.as_ref().map_or(&[], VisitHost::panels)
    }

    /// Returns the visit's part of the status line for tests.
    pub(super) fn visit_status(&self) -> VisitStatus<'_> {
        VisitStatus { visit: self.studio.world().visit(), host: self.host.as_ref() }
    }
}

/// A visit's phase, its seconds left and its buttons, as text.
pub(super) struct VisitStatus<'a> {
    visit: &'a Visit,
    host: Option<&'a VisitHost>,
}

impl fmt::Display for VisitStatus<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let left = self.visit.seconds_left().unwrap_or(0);
        write!(f, "visit {:?}; left {left}; buttons ", self.visit.phase())?;
        let mut buttons = self.host.iter().flat_map(|host| host.buttons());
        buttons.try_for_each(|(action, at)| write!(f, "{action}@{} {} {}|", at.x, at.y, at.z))
    }
}
