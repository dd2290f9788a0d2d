//! Session policy of a headset that visitors share: starts a session if there is none, finishes it by the
//! menu button, and hands the headset over to the next visitor after it was unused for long.
//!
//! The headset counts as used while it is worn or moved, judged by user presence, the controls, and the
//! motion of head and hands. A person who uses it after it was unused for the handover time counts as another
//! visitor, be it that the headset was off or asleep, or that its program was killed meanwhile; a stuck
//! presence sensor changes nothing. Times are those since boot, including sleep: a clock that stops during
//! sleep would make a night a short break.
//!
//! In visit mode ([`paros_core::visit`]) the core makes all these decisions; this module then only reports
//! whether the headset is worn and used.

#[cfg(test)]
mod tests;
mod use_watch;

use std::time::Duration;

use paros_core::TickInput;
use paros_core::session::{SessionMode, SessionState, TICK_RATE, commands};
use paros_core::visit::Presence;

use use_watch::UseWatch;

use crate::last_use::{BootId, LastUse, UseClock};

/// The default time that the headset must be unused for its next user to count as another visitor.
pub const DEFAULT_HANDOVER: Duration = Duration::from_secs(45);

/// Ticks for which the menu button must be held to finish a session: a second and a half.
const FINISH_HOLD_TICKS: u32 = TICK_RATE * 3 / 2;

/// The least idle time after which a headset that wasn't taken off counts as another visitor's, even if the
/// handover time is shorter: a visitor may stand still and look.
const LEAST_IDLENESS: Duration = Duration::from_secs(5);

/// The idle time after which a headset that wasn't seen to be taken off counts as put down and taken up
/// again.
const PUT_DOWN: Duration = Duration::from_secs(10);

/// A change of the person who uses the headset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum VisitorChange {
    /// No change: nobody uses it, or the same visitor as before.
    None,
    /// The headset was put on again soon, presumably by the same visitor.
    PutOnAgain,
    /// The headset was unused for long: another visitor has it.
    NextVisitor,
}

/// The wearing state of the headset, according to the runtime (`XR_EXT_user_presence`) and to its use.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum WearState {
    /// The runtime has not reported it.
    Unknown,
    Worn,
    OffSince(Duration),
    /// Reported as off, but still used after a time in which the same visitor would have put it on again: the
    /// presence sensor is stuck.
    OffAndUsed,
}

/// Decides when sessions start and finish, from the headset's use and the menu button.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct VisitPolicy {
    /// The mode in which sessions start; [`SessionMode::None`] in visit mode, in which visits start and hand
    /// over.
    start_mode: SessionMode,
    /// The time that the headset must be unused for its next user to count as another visitor.
    absence_before_handover: Duration,
    presence: WearState,
    watch: UseWatch,
    /// `true` if the last tick's input showed a use.
    is_used: bool,
    uses: UseClock,
    /// `true` if another visitor has come: the session is to be finished, and another one started.
    handing_over: bool,
    /// Ticks for which the menu button has been down.
    menu_held_ticks: u32,
}

impl VisitPolicy {
    /// Creates a policy that starts sessions in a mode, and hands over once the headset was unused for
    /// `absence_before_handover`. With [`SessionMode::None`], for visit mode, it only reports wearing and
    /// use, and starts and hands over nothing.
    #[must_use]
    pub fn new(start_mode: SessionMode, absence_before_handover: Duration) -> Self {
        VisitPolicy {
            start_mode,
            absence_before_handover,
            presence: WearState::Unknown,
            watch: UseWatch::default(),
            is_used: false,
            uses: UseClock::default(),
            handing_over: false,
            menu_held_ticks: 0,
        }
    }

    /// Notes that a saved session was found, and when the headset was last used. The session is a former
    /// visitor's if that was too long ago, in another boot, or is unknown. `now` is the time since boot, as
    /// in all functions here.
    pub fn resume_session(
        &mut self,
        last_use: Option<LastUse>,
        boot: Option<BootId>,
        now: Duration,
    ) -> VisitorChange {
        let is_recent = |used: &LastUse| {
            let away = used.time_until(boot, now);
            away.is_some_and(|away| away < self.absence_before_handover)
        };
        self.uses.last_use = last_use.filter(is_recent).map(|used| used.since_boot);
        if self.uses.last_use.is_some() {
            return VisitorChange::None;
        }
        self.handing_over = true;
        VisitorChange::NextVisitor
    }

    /// Notes a change of user presence: the headset was put on or taken off.
    pub fn observe_presence(&mut self, is_worn: bool, now: Duration) -> VisitorChange {
        if !is_worn {
            if !matches!(self.presence, WearState::OffSince(_) | WearState::OffAndUsed) {
                self.presence = WearState::OffSince(now);
            }
            // Taking the headset off is not a use. If no use was seen before, it was worn until now at the
            // latest.
            self.uses.last_use.get_or_insert(now);
            return VisitorChange::None;
        }
        let before = core::mem::replace(&mut self.presence, WearState::Worn);
        if matches!(before, WearState::Unknown | WearState::Worn) {
            return self.note_use(self.idleness_before_handover(), now);
        }
        match self.note_use(self.absence_before_handover, now) {
            VisitorChange::NextVisitor => VisitorChange::NextVisitor,
            VisitorChange::None | VisitorChange::PutOnAgain => VisitorChange::PutOnAgain,
        }
    }

    /// Observes a tick's input before it is run. Motion of a headset that is off doesn't count, as somebody
    /// may carry it; but if it is used long after it was reported as off, the presence sensor is stuck, and
    /// the headset counts as worn.
    pub fn observe_tick(
        &mut self,
        input: &TickInput,
        is_menu_down: bool,
        now: Duration,
    ) -> VisitorChange {
        let is_used = self.watch.observe(input, is_menu_down);
        let limit = self.idleness_before_handover();
        self.is_used = false;
        if let WearState::OffSince(since) = self.presence {
            if !is_used || now.saturating_sub(since) < limit {
                return VisitorChange::None;
            }
            self.presence = WearState::OffAndUsed;
        }
        self.is_used = is_used;
        if is_used { self.note_use(limit, now) } else { VisitorChange::None }
    }

    /// Notes that the reference space of poses has changed: the jump is no motion.
    pub fn forget_poses(&mut self) {
        self.watch.forget_poses();
    }

    /// Returns whether the headset is worn, for a visit. The state is unknown while the presence sensor is
    /// stuck.
    #[must_use]
    pub const fn presence(&self) -> Presence {
        match self.presence {
            WearState::Unknown | WearState::OffAndUsed => Presence::Unknown,
            WearState::Worn => Presence::Worn,
            WearState::OffSince(_) => Presence::Off,
        }
    }

    /// Returns `true` if the last tick's input showed a use. Motion of a headset that is off doesn't count.
    #[must_use]
    pub const fn is_used(&self) -> bool {
        self.is_used
    }

    /// Calls [`UseClock::take_due_stamp`]. Returns `None` while a session is still to be handed over: the
    /// time would assign it to the next visitor.
    pub fn take_due_stamp(&mut self) -> Option<Duration> {
        if self.handing_over { None } else { self.uses.take_due_stamp() }
    }

    /// Calls [`UseClock::take_last_stamp`]. Returns `None` while a session is still to be handed over.
    pub fn take_last_stamp(&mut self) -> Option<Duration> {
        if self.handing_over { None } else { self.uses.take_last_stamp() }
    }

    /// Adds a session's start or finish to a tick's input: a start if there is no session; a finish if the
    /// menu button was held long enough, or another visitor has come. If nothing was sculpted yet, there is
    /// nothing to keep: the next visitor's session replaces it at once.
    pub fn add_session_start_or_finish(
        &mut self,
        session: SessionState,
        is_sculpted: bool,
        is_menu_down: bool,
        input: &mut TickInput,
    ) {
        let is_pressed = is_menu_down && self.menu_held_ticks == 0;
        self.menu_held_ticks =
            if is_menu_down { self.menu_held_ticks.saturating_add(1) } else { 0 };
        let is_held = self.menu_held_ticks == FINISH_HOLD_TICKS;
        let is_start_due = match session {
            SessionState::Waiting => true,
            SessionState::Sculpting => self.handing_over && !is_sculpted,
            SessionState::Finished => self.handing_over || is_pressed,
        };
        if is_start_due {
            (input.start, self.handing_over) = (self.start_mode, false);
        } else if session == SessionState::Sculpting && (self.handing_over || is_held) {
            input.commands |= commands::FINISH;
        }
    }

    /// Notes a use of the headset. The user counts as another visitor if the headset was unused for `limit`
    /// or longer.
    fn note_use(&mut self, limit: Duration, now: Duration) -> VisitorChange {
        let Some(away) = self.uses.note_use(now) else { return VisitorChange::None };
        if away >= limit && self.start_mode != SessionMode::None {
            self.handing_over = true;
            VisitorChange::NextVisitor
        } else if away >= PUT_DOWN {
            VisitorChange::PutOnAgain
        } else {
            VisitorChange::None
        }
    }

    /// Returns the idle time after which the next user of a headset that wasn't taken off counts as another
    /// visitor.
    fn idleness_before_handover(&self) -> Duration {
        self.absence_before_handover.max(LEAST_IDLENESS)
    }
}
