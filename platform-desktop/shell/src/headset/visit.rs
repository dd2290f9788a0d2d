//! Visits: a session starts when there is none, is finished by the menu button, and is handed over to the next
//! visitor after the headset was unused for long.
//!
//! A headset is used while it is worn or moved, by user presence, by its controls, and by the motion of head and
//! hands. Whoever uses it after it was unused for the handover time is another visitor, whether it was off, asleep,
//! or its program killed meanwhile; a sensor that is stuck changes nothing. Times are those since boot, sleep included:
//! by a clock that stops while the device sleeps, a night would be a short break.
//!
//! Where the core holds visits ([`paros_core::visit`]) they decide all that; then it only tells whether the headset is
//! worn and used.

#[cfg(test)]
mod tests;
mod use_watch;

use std::time::Duration;

use paros_core::TickInput;
use paros_core::session::{SessionMode, SessionState, TICK_RATE, commands};
use paros_core::visit::Presence;

use use_watch::UseWatch;

use crate::last_use::{BootId, LastUse, UseClock};

/// The default of how long the headset must be unused for whoever uses it next to be another visitor.
pub const DEFAULT_HANDOVER: Duration = Duration::from_secs(45);

/// Ticks for which the menu button is held to finish: a second and a half.
const FINISH_HOLD_TICKS: u32 = TICK_RATE * 3 / 2;

/// The least idleness of a headset that wasn't taken off after which another visitor is held to have it, however short
/// the handover time: a visitor may stand still and look.
const LEAST_IDLENESS: Duration = Duration::from_secs(5);

/// Idleness after which a headset that wasn't seen to be taken off was put down and taken up again.
const PUT_DOWN: Duration = Duration::from_secs(10);

/// Who uses the headset.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum VisitorChange {
    /// Nobody, or the same visitor as before.
    None,
    /// It was put on again soon, by the same visitor as far as can be told.
    PutOnAgain,
    /// It was unused for long: another visitor has it.
    NextVisitor,
}

/// Whether the headset is worn, as the runtime has told it (`XR_EXT_user_presence`) and its use shows.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum WearState {
    /// It was never told.
    Unknown,
    Worn,
    OffSince(Duration),
    /// Off, but used as long after it was told so as no headset is that the same visitor puts on again.
    OffAndUsed,
}

/// Decides when sessions start and finish: from the headset's use and the menu button.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct VisitPolicy {
    /// How sessions start; [`SessionMode::None`] where visits start and hand over.
    start_mode: SessionMode,
    /// How long the headset must be unused for whoever uses it next to be another visitor.
    absence_before_handover: Duration,
    presence: WearState,
    watch: UseWatch,
    /// The last tick's input showed a use.
    is_used: bool,
    uses: UseClock,
    /// The session is to be finished and another started: another visitor has come.
    handing_over: bool,
    /// Ticks for which the menu button has been down.
    menu_held_ticks: u32,
}

impl VisitPolicy {
    /// A policy by which sessions start in a mode, and are handed over once the headset was unused for
    /// `absence_before_handover`. With [`SessionMode::None`] it starts and hands over nothing, as visits do that: it
    /// tells of wearing and use.
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

    /// Takes in that a session was found on the disk, and when the headset was last used, if that can be told. After
    /// too long, in another boot, or where it can't be told, the session is a former visitor's. `now` is the time since
    /// boot, as in all functions here.
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

    /// Takes in a change of user presence: the headset was put on or taken off.
    pub fn observe_presence(&mut self, is_worn: bool, now: Duration) -> VisitorChange {
        if !is_worn {
            if !matches!(self.presence, WearState::OffSince(_) | WearState::OffAndUsed) {
                self.presence = WearState::OffSince(now);
            }
            // Taking it off is no use of it, but where none was seen it was worn until now at the latest.
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

    /// Takes in a tick's input before it is run. While the headset is off its motion is that of whoever carries it;
    /// but a headset that is used though it is told to be off for so long is worn all the same.
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

    /// Takes in that poses are told in another space from now on: that is no motion.
    pub fn forget_poses(&mut self) {
        self.watch.forget_poses();
    }

    /// Whether the headset is worn, as a visit is told. A sensor that has it off though it is used tells nothing.
    #[must_use]
    pub const fn presence(&self) -> Presence {
        match self.presence {
            WearState::Unknown | WearState::OffAndUsed => Presence::Unknown,
            WearState::Worn => Presence::Worn,
            WearState::OffSince(_) => Presence::Off,
        }
    }

    /// Whether the last tick's input showed a use: while the headset is off its motion is none.
    #[must_use]
    pub const fn is_used(&self) -> bool {
        self.is_used
    }

    /// As [`UseClock::take_due_stamp`]. Returns `None` while a session is still to be handed over: the time would make
    /// it the next visitor's.
    pub fn take_due_stamp(&mut self) -> Option<Duration> {
        if self.handing_over { None } else { self.uses.take_due_stamp() }
    }

    /// As [`UseClock::take_last_stamp`], but for a session that is still to be handed over.
    pub fn take_last_stamp(&mut self) -> Option<Duration> {
        if self.handing_over { None } else { self.uses.take_last_stamp() }
    }

    /// Adds to a tick's input: a start where there is no session; the finish where the menu button was
    /// held long enough, or another visitor has come. A session in which nothing was sculpted yet leaves nothing to be
    /// kept: the next visitor's starts in its place.
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

    /// Notes that the headset is used, and by whom, where another visitor has it from a time of `limit` on.
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

    /// For how long a headset that wasn't taken off is idle before whoever uses it is another visitor.
    fn idleness_before_handover(&self) -> Duration {
        self.absence_before_handover.max(LEAST_IDLENESS)
    }
}
