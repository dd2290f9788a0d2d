//! The users of the headset: passes observations to the visit policy and the room placement, and carries out
//! their decisions.

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
    /// Decides whose session was found on the disk, if any. On a shared headset it belongs to a former
    /// visitor, unless it was left a short while ago. In the user's own folders it belongs to the user.
    pub(super) fn resume_session(&mut self, platform: &mut dyn Platform) {
        let world = self.studio.world();
        if world.session_state() == SessionState::Waiting {
            return;
        }
        let (tick, digest) = (world.tick(), world.digest());
        // A recording starts a new session and ignores the one that was found.
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

    /// Returns `true` if visitors share the headset: it has a folder of its own, or visits are held.
    fn is_shared(&self) -> bool {
        self.options.folder.is_some() || self.host.is_some()
    }

    /// Reports to the visit policy that the headset was put on or taken off (`XR_EXT_user_presence`).
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

    /// Passes a tick's input to the visit policy.
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
            // The staff may have held the headset before: place the room again.
            VisitorChange::PutOnAgain if is_untouched => {}
            VisitorChange::PutOnAgain | VisitorChange::None => return,
        }
        self.placement.request(PlacementNeed::Anyhow);
    }

    /// Passes the head's pose to the room placement. Returns the room's new place if it must move.
    pub(super) fn observe_head(&mut self, head: Option<RoomPose>) -> Option<RoomTransform> {
        let worn_head = head.filter(|_| self.visit.presence() != Presence::Off);
        self.placement.observe_head(worn_head)
    }

    /// Moves the room after a frame's ticks: to the decided place, or, after a recentring, to its default
    /// place in the new space.
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

    /// Stores the time of the last use on the disk, if the stored one is too old.
    pub(super) fn keep_due_last_use(&mut self) {
        let due = self.visit.take_due_stamp();
        self.keep_last_use(due);
    }

    /// Stores the time of the last use on the disk, as the process may sleep or end next.
    pub(super) fn keep_last_use_before_pause(&mut self) {
        let last = self.visit.take_last_stamp();
        self.keep_last_use(last);
    }

    fn keep_last_use(&mut self, since_boot: Option<Duration>) {
        if let (Some(since_boot), Some(boot), true) = (since_boot, self.boot, self.is_shared()) {
            self.studio.keep_last_use(LastUse { boot, since_boot });
        }
    }

    /// Saves the core's session and the time of its last use, and waits until both are written.
    pub(super) fn save_session_before_pause(&mut self) {
        self.keep_last_use_before_pause();
        self.studio.save_session_and_wait();
    }

    /// Saves like [`Self::save_session_before_pause`], after retrying failed writes: the headset may stay off
    /// from now on.
    pub(super) fn save_studio_and_wait(&mut self) {
        self.studio.retry_failed_writes();
        self.save_session_before_pause();
    }
}
