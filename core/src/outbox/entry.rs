//! A sculpture in the outbox: where it stands, and what leads from one state to the next.

use crate::badge::BadgeNumber;
use crate::limits::{CONFIRM_MS, MAX_PARCEL_BYTES};
use crate::outbox::messages::{
    Announcement, AnnouncementState, ContentHash, ReceiptOutcome, SculptureId,
};

/// Where a sculpture stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum EntryState {
    /// Its id is drawn and stored; its parcel is being made.
    Announced,
    /// *Kept here*: its parcel is on the disk, and waits.
    Kept,
    /// *Kept here*, and on its way.
    Sending {
        /// Bytes of the parcel that the booth holds, as far as is known.
        held: u32,
    },
    /// *Kept here*: the booth can't take it. It is tried again, rarely, and the staff told.
    Refused,
    /// It won't come: its parcel was never made, or is damaged.
    Lost,
    /// *Kept at the booth*: signed for. Its parcel stays here for the grace.
    Receipted {
        /// Seconds since, of those in which the program ran.
        seconds: u32,
    },
    /// Its parcel is to be deleted.
    Deletable,
    /// Nothing is left of it: it leaves the table.
    Gone,
}

/// What happens to a sculpture.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum EntryEvent {
    /// Its parcel is on the disk.
    ParcelKept,
    /// Its parcel won't be made, can't be read, or isn't what it was.
    ParcelMissing,
    /// A part of it was sent.
    PartSent,
    /// The booth holds so many bytes of it.
    PartHeld {
        /// From the parcel's start.
        held: u32,
    },
    /// The booth can't take it: too large, or not to be read.
    RefusedByBooth,
    /// The booth signed for it.
    SignedFor(ReceiptOutcome),
    /// It goes on under another id, whose parcel is on the disk.
    Renewed,
    /// The booth of another site is in charge, which hasn't signed for it.
    SiteChanged,
    /// Seconds passed.
    SecondsPassed {
        /// How many.
        seconds: u32,
        /// How many a parcel stays after its receipt.
        grace: u32,
    },
    /// What comes has no room beside it.
    RoomNeeded,
    /// The booth noted that it is lost.
    LossNoted,
    /// The booth doesn't know any more that it signed for it, as where it came back from an older copy.
    Forgotten,
    /// Its parcel was deleted.
    ParcelDeleted,
}

/// A sculpture in the outbox.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct OutboxEntry {
    /// Its id.
    pub id: SculptureId,
    /// The badge that the visitor was shown, once there is one.
    pub badge: Option<BadgeNumber>,
    /// SHA-256 of its parcel, once that is kept.
    pub hash: Option<ContentHash>,
    /// Length of its parcel, once that is kept.
    pub parcel_bytes: u32,
    /// Where it stands.
    pub state: EntryState,
    /// The id that it had before, which the booth knows as another sculpture's. Its parcel is deleted.
    pub replaced: Option<SculptureId>,
    /// What the booth has noted of it.
    pub(super) noted: Option<Announcement>,
    /// Requests in a row that came to nothing.
    pub(super) failures: u8,
    /// When a refused one is tried again, in milliseconds of the outbox.
    pub(super) retry_ms: u64,
    /// When the booth last said that it has what it signed for, in milliseconds of the outbox; `None` in this start.
    pub(super) confirmed_ms: Option<u64>,
    /// Whether the heartbeat under way asks whether the booth has what it signed for.
    pub(super) is_asked_for: bool,
    /// Whether the journal on the disk says that the booth signed for it.
    pub(super) is_signed_on_disk: bool,
}

impl EntryState {
    /// The next state; `None` for what can't happen in this one, which changes nothing.
    ///
    /// | state | event | next |
    /// |---|---|---|
    /// | announced, lost | parcel kept | kept |
    /// | announced, kept, sending, refused | parcel missing | lost |
    /// | receipted, deletable | parcel missing | gone |
    /// | kept, refused | part sent | sending, of which nothing is held |
    /// | sending | part sent | the same |
    /// | sending | part held | sending, of which so much is held |
    /// | sending | refused by the booth | refused |
    /// | kept, sending, refused | signed for, kept there | receipted |
    /// | kept, sending, refused | signed for, deleted there | deletable |
    /// | kept, sending, refused | renewed | gone |
    /// | receipted | the site changed, forgotten | kept |
    /// | receipted | seconds passed, up to the grace | receipted for so much longer |
    /// | receipted | seconds passed, beyond the grace; room needed | deletable |
    /// | lost | loss noted | gone |
    /// | deletable | parcel deleted | gone |
    ///
    /// Never does a parcel become deletable for which the booth hasn't signed.
    #[must_use]
    pub const fn next(self, event: EntryEvent) -> Option<Self> {
        use EntryEvent as Event;
        use EntryState as State;
        Some(match (self, event) {
            (State::Announced | State::Lost, Event::ParcelKept) => State::Kept,
            (
                State::Announced | State::Kept | State::Sending { .. } | State::Refused,
                Event::ParcelMissing,
            ) => State::Lost,
            (State::Receipted { .. } | State::Deletable, Event::ParcelMissing) => State::Gone,
            (State::Kept | State::Refused, Event::PartSent) => State::Sending { held: 0 },
            (State::Sending { held }, Event::PartSent) => State::Sending { held },
            (State::Sending { .. }, Event::PartHeld { held }) => State::Sending { held },
            (State::Sending { .. }, Event::RefusedByBooth) => State::Refused,
            (State::Kept | State::Sending { .. } | State::Refused, Event::SignedFor(outcome)) => {
                match outcome {
                    ReceiptOutcome::Kept => State::Receipted { seconds: 0 },
                    ReceiptOutcome::Deleted => State::Deletable,
                }
            }
            (State::Kept | State::Sending { .. } | State::Refused, Event::Renewed) => State::Gone,
            (State::Receipted { .. }, Event::SiteChanged | Event::Forgotten) => State::Kept,
            (State::Receipted { seconds: before }, Event::SecondsPassed { seconds, grace }) => {
                let seconds = before.saturating_add(seconds);
                if seconds > grace { State::Deletable } else { State::Receipted { seconds } }
            }
            (State::Receipted { .. }, Event::RoomNeeded) => State::Deletable,
            (State::Lost, Event::LossNoted) | (State::Deletable, Event::ParcelDeleted) => {
                State::Gone
            }
            _ => return None,
        })
    }

    /// Whether the booth hasn't signed for it: it is announced with each heartbeat.
    #[must_use]
    pub const fn is_owed(self) -> bool {
        self.announcement_state().is_some()
    }

    /// Whether the booth signed for it, and its parcel is here still.
    pub(super) const fn is_signed(self) -> bool {
        matches!(self, EntryState::Receipted { .. } | EntryState::Deletable)
    }

    /// Whether it isn't to be deleted yet.
    pub(super) const fn stays(self) -> bool {
        !matches!(self, EntryState::Deletable | EntryState::Gone)
    }

    /// Whether a parcel of it is in the outbox's folder.
    #[must_use]
    pub const fn has_parcel(self) -> bool {
        !matches!(self, EntryState::Announced | EntryState::Lost | EntryState::Gone)
    }

    /// As it is announced; `None` where it isn't any more.
    #[must_use]
    pub const fn announcement_state(self) -> Option<AnnouncementState> {
        match self {
            EntryState::Announced => Some(AnnouncementState::Announced),
            EntryState::Kept => Some(AnnouncementState::Kept),
            EntryState::Sending { .. } => Some(AnnouncementState::Sending),
            EntryState::Refused => Some(AnnouncementState::Refused),
            EntryState::Lost => Some(AnnouncementState::Lost),
            EntryState::Receipted { .. } | EntryState::Deletable | EntryState::Gone => None,
        }
    }
}

impl OutboxEntry {
    /// An entry in a state in which it needs no parcel.
    pub(super) const fn announced(id: SculptureId, badge: Option<BadgeNumber>) -> Self {
        OutboxEntry {
            id,
            badge,
            hash: None,
            parcel_bytes: 0,
            state: EntryState::Announced,
            replaced: None,
            noted: None,
            failures: 0,
            retry_ms: 0,
            confirmed_ms: None,
            is_asked_for: false,
            is_signed_on_disk: false,
        }
    }

    /// Leads it to a state.
    pub(super) fn enter(&mut self, state: EntryState) {
        self.state = state;
        self.is_signed_on_disk &= state.is_signed();
    }

    /// What the booth is told of it; `None` where it has signed.
    #[must_use]
    pub fn announcement(&self) -> Option<Announcement> {
        let state = self.state.announcement_state()?;
        Some(Announcement { id: self.id, badge: self.badge, state })
    }

    /// What the booth is asked of it where it has signed: whether it has it still. `None` where there is nothing to ask at
    /// `now_ms` of the outbox.
    pub(super) fn question(&self, now_ms: u64) -> Option<Announcement> {
        let is_due = |confirmed_ms: u64| now_ms.saturating_sub(confirmed_ms) >= CONFIRM_MS;
        let is_receipted = matches!(self.state, EntryState::Receipted { .. });
        let is_to_be_asked = is_receipted && self.confirmed_ms.is_none_or(is_due);
        let state = AnnouncementState::SignedFor;
        is_to_be_asked.then_some(Announcement { id: self.id, badge: self.badge, state })
    }

    /// Whether what the booth has noted isn't how it stands.
    pub(super) fn has_news(&self) -> bool {
        self.announcement().is_some_and(|announcement| self.noted != Some(announcement))
    }

    /// Bytes of the parcel that is in the folder.
    pub(super) const fn bytes_here(&self) -> u64 {
        if self.state.has_parcel() { self.parcel_bytes as u64 } else { 0 }
    }
}

const _: () = assert!(MAX_PARCEL_BYTES <= u32::MAX as u64);
