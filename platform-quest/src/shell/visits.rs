//! Who uses the headset: what the visit policy and the room's placement are told, and what they decide is carried out.

use std::time::Duration;

use paros_core::TickInput;
use paros_core::internals::RoomPose;
use paros_core::limits::INTERVALS;
use paros_core::session::SessionState;
use paros_core::visit::Presence;
use paros_core::volume::{Grid, Size};
use paros_headset::room_placement::{PlacementNeed, RoomTransform};
use paros_shell::headset::visit::VisitorChange;
use paros_shell::last_use::LastUse;
use paros_shell::statics::Resident;

use super::HeadsetShell;
use crate::error::Error;
use crate::platform::Platform;
use crate::xr::HeadsetSession;

impl<const N: usize> HeadsetShell<'_, N>
where
    Grid<N>: Size + Resident<N, INTERVALS>,
{
    /// Tells whose session was found on the disk, if any was: in a folder of the headset's own it is a former
    /// visitor's, unless it was left a short while ago. In the user's own folders it is the user's.
    pub(super) fn resume_session(&mut self, platform: &mut dyn Platform) {
        let world = self.studio.world();
        if world.session_state() == SessionState::Waiting {
            return;
        }
        let (tick, digest) = (world.tick(), world.digest());
        // A recording starts anew, and leaves what was found.
        if self.is_shared() && !self.start_anew {
            let last_use = self.studio.read_last_use().map_err(|why| {
                platform.log(format_args!("{why}"));
            });
            let last_use = last_use.ok();
            if self.host.is_some() {
                return self.resume_visit(last_use, platform);
            }
            let now = platform.since_boot();
            let change = self.visit.resume_session(last_use, self.boot, now);
            if change == VisitorChange::NextVisitor {
                platform
                    .log(format_args!("a session is found at tick {tick}, digest {digest:016x}"));
                return self.on_visitor_change(change, platform);
            }
        }
        platform.log(format_args!("a session goes on from tick {tick}, digest {digest:016x}"));
    }

    /// Whether visitors share the headset: its folder is its own, or visits are held.
    fn is_shared(&self) -> bool {
        self.options.folder.is_some() || self.host.is_some()
    }

    /// Tells the visit policy that the headset was put on or off (`XR_EXT_user_presence`).
    pub(super) fn on_user_presence_changed(
        &mut self,
        is_present: bool,
        platform: &mut dyn Platform,
    ) {
        let change = self.visit.observe_presence(is_present, platform.since_boot());
        self.on_visitor_change(change, platform);
        if !is_present {
            self.save_session_before_pause();
        }
    }

    /// Tells the visit policy what a tick's input shows.
    pub(super) fn observe_visitor(
        &mut self,
        input: &TickInput,
        is_menu_down: bool,
        now: Duration,
        platform: &mut dyn Platform,
    ) {
        let change = self.visit.observe_tick(input, is_menu_down, now);
        self.on_visitor_change(change, platform);
    }

    fn on_visitor_change(&mut self, change: VisitorChange, platform: &mut dyn Platform) {
        let is_untouched = self.studio.world().session_state() == SessionState::Sculpting
            && !self.studio.has_unfinished_sculpture();
        match change {
            VisitorChange::NextVisitor => platform.log(format_args!("another visitor")),
            // Somebody held it before, who may have been the staff.
            VisitorChange::PutOnAgain if is_untouched => {}
            VisitorChange::PutOnAgain | VisitorChange::None => return,
        }
        self.placement.request(PlacementNeed::Anyhow);
    }

    /// Tells the room's placement where the head is in the room. Returns where the room is to lie, if that changes.
    pub(super) fn observe_head(&mut self, head: Option<RoomPose>) -> Option<RoomTransform> {
        let worn_head = head.filter(|_| self.visit.presence() != Presence::Off);
        self.placement.observe_head(worn_head)
    }

    /// Moves the room after a frame's ticks: to where it was decided, or back to where the runtime's new space has it.
    pub(super) fn move_room(
        &mut self,
        session: &mut HeadsetSession,
        decided: Option<RoomTransform>,
        has_recentred: bool,
        platform: &mut dyn Platform,
    ) -> Result<(), Error> {
        let decided = if has_recentred { self.placement.restart_in_new_space() } else { decided };
        let Some(room) = decided else { return Ok(()) };
        session.move_room(room)?;
        self.has_room_moved = true;
        if let Some(host) = &mut self.host {
            host.note_room_moved();
        }
        let (degrees, metres) = (room.yaw.to_degrees(), room.origin.length());
        let raised = room.height.offset_metres();
        platform.log(format_args!(
            "the room is turned by {degrees:.0} degrees, moved by {metres:.2} m, raised by {raised:.2} m"
        ));
        Ok(())
    }

    /// Has the time of the last use kept on the disk, each time that the one there has become old.
    pub(super) fn keep_due_last_use(&mut self) {
        let due = self.visit.take_due_stamp();
        self.keep_last_use(due);
    }

    /// Has the time of the last use kept on the disk, as the process may sleep or end next.
    pub(super) fn keep_last_use_before_pause(&mut self) {
        let last = self.visit.take_last_stamp();
        self.keep_last_use(last);
    }

    fn keep_last_use(&mut self, since_boot: Option<Duration>) {
        if let (Some(since_boot), Some(boot), true) = (since_boot, self.boot, self.is_shared()) {
            self.studio.keep_last_use(LastUse { boot, since_boot });
        }
    }

    /// Saves the core's session and when it was last used, and waits until both are written.
    pub(super) fn save_session_before_pause(&mut self) {
        self.keep_last_use_before_pause();
        self.studio.save_session_and_wait();
    }

    /// As [`Self::save_session_before_pause`], and tries what could not be written once more: the headset may stay off
    /// from now on.
    pub(super) fn save_studio_and_wait(&mut self) {
        self.studio.retry_failed_writes();
        self.save_session_before_pause();
    }
}
