//! The outbox's table of sculptures, and what comes in and leaves.

use core::fmt;

use heapless::Vec;

use crate::badge::BadgeNumber;
use crate::limits::MAX_OUTBOX_ENTRIES;
use crate::outbox::entry::{EntryEvent, EntryState, OutboxEntry};
use crate::outbox::heartbeats::HeartbeatClock;
use crate::outbox::messages::{ContentHash, Receipt, SculptureId, SiteId};
use crate::outbox::uploads::UploadClock;

/// Whose outbox it is. An enrolment gives both.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct OutboxOwner {
    /// The site whose booth signs for its sculptures.
    pub site: SiteId,
    /// The headset's number there, from 1.
    pub headset: u32,
}

/// What an exhibition sets.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct OutboxSettings {
    /// Seconds that a parcel stays here after its receipt, of those in which the program runs.
    pub grace_seconds: u32,
    /// Bytes that all parcels may take together.
    pub max_bytes: u64,
}

/// What a headset owes the booth, and until when it keeps what it owes no more.
///
/// Entries stand in the order of their coming, the oldest first. Times are those of one clock that goes on, as Android's
/// `CLOCK_BOOTTIME`; one that is set back stands still, one set forward only makes waits shorter.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Outbox {
    pub(super) owner: OutboxOwner,
    pub(super) settings: OutboxSettings,
    pub(super) boot_id: u64,
    pub(super) was_wiped: bool,
    pub(super) entries: Vec<OutboxEntry, MAX_OUTBOX_ENTRIES>,
    pub(super) uploads: UploadClock,
    pub(super) heartbeats: HeartbeatClock,
    /// The shell's clock as it was last told, in milliseconds.
    last_told_ms: Option<u64>,
    /// Milliseconds of this start that have passed.
    pub(super) elapsed_ms: u64,
    /// Milliseconds that aren't counted as a receipt's seconds yet, below 1,000.
    part_ms: u32,
    /// Seconds of receipts since the journal was written.
    unsaved_seconds: u32,
    pub(super) is_journal_due: bool,
}

/// Why the outbox doesn't do what it was asked. Nothing has changed.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum OutboxRefusal {
    /// There is no room, and nothing that may be deleted.
    Full,
    /// There is an entry of that id, or a sculpture that gave it up.
    KnownId,
    /// There is no entry of that id.
    UnknownId,
    /// It stands where this can't happen.
    WrongState,
    /// The receipt is another's: of another site, headset, parcel or badge.
    WrongReceipt,
}

/// Seconds of receipts after which the journal is written again though nothing else happened: what a start forgets of
/// a grace.
const SAVED_EVERY_SECONDS: u32 = 600;

impl Outbox {
    /// The outbox of a headset that has none: new, or its data was wiped. `boot_id` is random bits of this start, not
    /// 0.
    #[must_use]
    pub const fn new(owner: OutboxOwner, settings: OutboxSettings, boot_id: u64) -> Self {
        Outbox {
            owner,
            settings,
            boot_id,
            was_wiped: true,
            entries: Vec::new(),
            uploads: UploadClock::new(),
            heartbeats: HeartbeatClock::new(),
            last_told_ms: None,
            elapsed_ms: 0,
            part_ms: 0,
            unsaved_seconds: 0,
            is_journal_due: true,
        }
    }

    /// All sculptures, the oldest first.
    #[must_use]
    pub fn entries(&self) -> &[OutboxEntry] {
        &self.entries
    }

    /// The sculpture of an id.
    #[must_use]
    pub fn find(&self, id: SculptureId) -> Option<&OutboxEntry> {
        self.entries.iter().find(|entry| entry.id == id)
    }

    /// Whose it is.
    #[must_use]
    pub const fn owner(&self) -> OutboxOwner {
        self.owner
    }

    /// Whether it began with nothing, and the booth hasn't heard so yet.
    #[must_use]
    pub const fn was_wiped(&self) -> bool {
        self.was_wiped
    }

    /// Whether the journal on the disk is behind: it is written next.
    #[must_use]
    pub const fn is_journal_due(&self) -> bool {
        self.is_journal_due
    }

    /// The journal is on the disk as [`Outbox::save`](Outbox::save) wrote it last.
    pub fn note_journal_written(&mut self) {
        self.is_journal_due = false;
        self.unsaved_seconds = 0;
        for entry in &mut self.entries {
            entry.is_signed_on_disk = entry.state.is_signed();
        }
    }

    /// Sculptures that the booth hasn't signed for.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.entries.iter().filter(|entry| entry.state.is_owed()).count()
    }

    /// Takes in a sculpture that is finished, under an id of random bits. The journal is written before the booth is
    /// told, and before the parcel is.
    ///
    /// # Errors
    /// `Full` where the table is; `KnownId`. The visit goes on without: its print is in the folder all the same.
    pub fn announce(
        &mut self,
        id: SculptureId,
        badge: Option<BadgeNumber>,
    ) -> Result<(), OutboxRefusal> {
        if self.entries.iter().any(|entry| entry.id == id || entry.replaced == Some(id)) {
            return Err(OutboxRefusal::KnownId);
        }
        let entry = OutboxEntry::announced(id, badge);
        self.entries.push(entry).map_err(|_| OutboxRefusal::Full)?;
        self.is_journal_due = true;
        Ok(())
    }

    /// Notes the badge of a sculpture whose parcel isn't made yet.
    ///
    /// # Errors
    /// `UnknownId`; `WrongState` where it is made.
    pub fn note_badge(&mut self, id: SculptureId, badge: BadgeNumber) -> Result<(), OutboxRefusal> {
        let entry = self.find_mut(id)?;
        if entry.state != EntryState::Announced {
            return Err(OutboxRefusal::WrongState);
        }
        if entry.badge != Some(badge) {
            entry.badge = Some(badge);
            self.is_journal_due = true;
        }
        Ok(())
    }

    /// A parcel is on the disk, under its own name: it is *kept here*. One that the table doesn't know is taken in, as
    /// where the journal was damaged.
    ///
    /// # Errors
    /// `Full` where the table doesn't know it and is full; `WrongState` where it is kept already, or signed for;
    /// `KnownId` where it was given up for another id.
    pub fn keep(
        &mut self,
        id: SculptureId,
        badge: Option<BadgeNumber>,
        hash: ContentHash,
        parcel_bytes: u32,
    ) -> Result<(), OutboxRefusal> {
        if let Some(entry) = self.find(id) {
            entry.state.next(EntryEvent::ParcelKept).ok_or(OutboxRefusal::WrongState)?;
        } else {
            self.announce(id, badge)?;
        }
        self.apply(id, EntryEvent::ParcelKept)?;
        let entry = self.find_mut(id)?;
        (entry.badge, entry.hash, entry.parcel_bytes) = (badge, Some(hash), parcel_bytes);
        (entry.failures, entry.retry_ms) = (0, 0);
        Ok(())
    }

    /// The parcel of a sculpture won't be made, isn't there, or isn't what it was.
    ///
    /// # Errors
    /// `UnknownId`; `WrongState` where it is lost already.
    pub fn note_parcel_missing(&mut self, id: SculptureId) -> Result<(), OutboxRefusal> {
        self.apply(id, EntryEvent::ParcelMissing)
    }

    /// Takes a receipt. It may be late, and may be there twice.
    ///
    /// # Errors
    /// `UnknownId`; `WrongReceipt` where it isn't this parcel's; `WrongState` where one was taken, or no parcel is
    /// here.
    pub fn take_receipt(&mut self, receipt: &Receipt) -> Result<(), OutboxRefusal> {
        let entry = self.find(receipt.id).ok_or(OutboxRefusal::UnknownId)?;
        let is_own = receipt.site == self.owner.site && receipt.headset == self.owner.headset;
        if !is_own || Some(receipt.hash) != entry.hash || receipt.badge != entry.badge {
            return Err(OutboxRefusal::WrongReceipt);
        }
        self.apply(receipt.id, EntryEvent::SignedFor(receipt.outcome))?;
        let now_ms = self.elapsed_ms;
        let entry = self.find_mut(receipt.id)?;
        (entry.confirmed_ms, entry.is_asked_for) = (Some(now_ms), false);
        Ok(())
    }

    /// Lets time pass, up to `now_ms` of the shell's clock: what was signed for long enough ago becomes deletable, and what
    /// takes the room of what comes.
    pub fn pass_time(&mut self, now_ms: u64) {
        let before = self.last_told_ms.replace(now_ms).unwrap_or(now_ms);
        if now_ms < before {
            // How long ago a heartbeat was sent can't be told any more.
            self.heartbeats.forget_sent();
        }
        let passed_ms = now_ms.saturating_sub(before);
        self.elapsed_ms = self.elapsed_ms.saturating_add(passed_ms);
        let part_ms = passed_ms.saturating_add(u64::from(self.part_ms));
        self.part_ms = (part_ms % 1000) as u32;
        let seconds = u32::try_from(part_ms / 1000).unwrap_or(u32::MAX);
        if seconds > 0 {
            self.pass_seconds(seconds);
        }
        self.make_room();
    }

    fn pass_seconds(&mut self, seconds: u32) {
        let event = EntryEvent::SecondsPassed { seconds, grace: self.settings.grace_seconds };
        let mut has_receipts = false;
        for entry in &mut self.entries {
            if let Some(next) = entry.state.next(event) {
                has_receipts = true;
                self.is_journal_due |= next == EntryState::Deletable;
                entry.enter(next);
            }
        }
        if has_receipts {
            self.unsaved_seconds = self.unsaved_seconds.saturating_add(seconds);
            self.is_journal_due |= self.unsaved_seconds >= SAVED_EVERY_SECONDS;
        }
    }

    /// The parcels to delete, the oldest first: of those that are deletable what the journal on the disk calls signed
    /// for, so that it is known as such whenever the program starts again. That the journal is behind otherwise holds up
    /// nothing: on a full disk it is what is deleted that makes room for it.
    pub fn parcels_to_delete(&self) -> impl Iterator<Item = SculptureId> {
        let deletable =
            |entry: &&OutboxEntry| entry.state == EntryState::Deletable && entry.is_signed_on_disk;
        self.entries.iter().filter(deletable).map(|entry| entry.id)
    }

    /// The parcel of a deletable sculpture isn't on the disk any more.
    ///
    /// # Errors
    /// `UnknownId`; `WrongState` where it isn't deletable.
    pub fn note_deleted(&mut self, id: SculptureId) -> Result<(), OutboxRefusal> {
        self.apply(id, EntryEvent::ParcelDeleted)
    }

    pub(super) fn find_mut(&mut self, id: SculptureId) -> Result<&mut OutboxEntry, OutboxRefusal> {
        self.entries.iter_mut().find(|entry| entry.id == id).ok_or(OutboxRefusal::UnknownId)
    }

    /// Leads an entry to its next state, and out of the table where nothing is left of it.
    pub(super) fn apply(
        &mut self,
        id: SculptureId,
        event: EntryEvent,
    ) -> Result<(), OutboxRefusal> {
        let at = self.entries.iter().position(|entry| entry.id == id);
        let at = at.ok_or(OutboxRefusal::UnknownId)?;
        let entry = &mut self.entries[at];
        let next = entry.state.next(event).ok_or(OutboxRefusal::WrongState)?;
        // What the booth holds of a parcel is asked anew in each start.
        let is_saved_alike = matches!(
            (entry.state, next),
            (EntryState::Kept | EntryState::Sending { .. }, EntryState::Sending { .. })
        );
        self.is_journal_due |= !is_saved_alike;
        entry.enter(next);
        if next == EntryState::Gone {
            self.entries.remove(at);
        }
        Ok(())
    }
}

impl fmt::Display for OutboxRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            OutboxRefusal::Full => "the outbox is full with what the booth hasn't signed for",
            OutboxRefusal::KnownId => "there is a sculpture of this id",
            OutboxRefusal::UnknownId => "there is no sculpture of this id",
            OutboxRefusal::WrongState => "the sculpture isn't where this can happen",
            OutboxRefusal::WrongReceipt => "the receipt is of another parcel",
        })
    }
}

impl core::error::Error for OutboxRefusal {}
