//! The room of an outbox: how much is taken, and what is let go for what comes.

use crate::limits::{
    MAX_OUTBOX_ENTRIES, MAX_SIGNED_BYTES_PERCENT, MAX_SIGNED_PERCENT, MAX_UNASKED_PERCENT,
};
use crate::outbox::entry::{EntryEvent, EntryState, OutboxEntry};
use crate::outbox::machine::Outbox;

/// How full an outbox is with what the booth hasn't signed for.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum OutboxLevel {
    /// There is room.
    Fine,
    /// Four fifths are taken: the staff is told.
    NearlyFull,
    /// Not one sculpture more.
    Full,
}

impl Outbox {
    /// Bytes of all parcels in the folder.
    #[must_use]
    pub fn bytes_here(&self) -> u64 {
        self.entries.iter().map(OutboxEntry::bytes_here).sum()
    }

    /// Whether a parcel of so many bytes has room beside those that are here. Asked before it is written.
    #[must_use]
    pub fn has_room_for(&self, parcel_bytes: u64) -> bool {
        self.bytes_here().saturating_add(parcel_bytes) <= self.settings.max_bytes
    }

    /// How full it is with what the booth hasn't signed for, which alone can't make room, in percent: of the table or of
    /// the bytes, whichever is fuller.
    #[must_use]
    pub fn full_percent(&self) -> u8 {
        let [of_table, of_bytes] = self.percents_of(EntryState::is_owed);
        of_table.max(of_bytes)
    }

    /// The same as a level.
    #[must_use]
    pub fn level(&self) -> OutboxLevel {
        match self.full_percent() {
            0..80 => OutboxLevel::Fine,
            80..100 => OutboxLevel::NearlyFull,
            _ => OutboxLevel::Full,
        }
    }

    /// What is signed for leaves before its grace ends, the oldest first, where all that is here takes more of the table or
    /// of the bytes than it may: what comes finds room. First what the booth said it has, and isn't being asked for.
    pub(super) fn make_room(&mut self) {
        loop {
            let [of_table, of_bytes] = self.percents_of(EntryState::stays);
            if of_table <= MAX_SIGNED_PERCENT && of_bytes <= MAX_SIGNED_BYTES_PERCENT {
                return;
            }
            let is_short = of_table.max(of_bytes) > MAX_UNASKED_PERCENT;
            let may_leave = |entry: &&OutboxEntry| {
                let is_known_there = entry.confirmed_ms.is_some() && !entry.is_asked_for;
                matches!(entry.state, EntryState::Receipted { .. }) && (is_known_there || is_short)
            };
            let Some(id) = self.entries.iter().find(may_leave).map(|entry| entry.id) else {
                return;
            };
            // It can: it is signed for.
            let _ = self.apply(id, EntryEvent::RoomNeeded);
        }
    }

    /// What those of some states take of the table and of the bytes, in percent.
    fn percents_of(&self, counts: impl Fn(EntryState) -> bool) -> [u8; 2] {
        let (mut count, mut bytes) = (0, 0_u64);
        for entry in self.entries.iter().filter(|entry| counts(entry.state)) {
            count += 1;
            bytes += entry.bytes_here();
        }
        let of_table = count * 100 / MAX_OUTBOX_ENTRIES as u64;
        let of_bytes =
            bytes.saturating_mul(100).checked_div(self.settings.max_bytes).unwrap_or(100);
        [of_table, of_bytes].map(|percent| percent.min(100) as u8)
    }
}
