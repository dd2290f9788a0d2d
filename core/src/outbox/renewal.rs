//! A sculpture whose id the booth knows as another's gets a new one.

use crate::outbox::entry::{EntryEvent, EntryState, OutboxEntry};
use crate::outbox::machine::{Outbox, OutboxRefusal};
use crate::outbox::messages::{ContentHash, SculptureId};

impl Outbox {
    /// The booth knows `old` as another's. The sculpture goes on as `new`, whose parcel, otherwise the same, is on the
    /// disk. Where `new` is here already, as after a start in between, the two become one; so they do where `new` was
    /// given up for a third id in its turn.
    ///
    /// # Errors
    /// `UnknownId`; `WrongState` where `old` isn't waiting to be sent; `KnownId` where `new` is `old`.
    pub fn renew(
        &mut self,
        old: SculptureId,
        new: SculptureId,
        new_hash: ContentHash,
    ) -> Result<(), OutboxRefusal> {
        let entry = *self.find(old).ok_or(OutboxRefusal::UnknownId)?;
        entry.state.next(EntryEvent::Renewed).ok_or(OutboxRefusal::WrongState)?;
        if new == old {
            return Err(OutboxRefusal::KnownId);
        }
        if self.successor_of(new).is_some() {
            return self.apply(old, EntryEvent::Renewed);
        }
        // One that gave it up and was lost since.
        let lost = self.entries.iter_mut().filter(|entry| entry.replaced == Some(new));
        lost.for_each(|entry| entry.replaced = None);
        if let Some(other) = self.find(new).copied() {
            if !other.state.has_parcel() {
                self.keep(new, entry.badge, new_hash, entry.parcel_bytes)?;
            }
            self.apply(old, EntryEvent::Renewed)?;
            self.find_mut(new)?.replaced = Some(old);
        } else {
            let parcel_bytes = entry.parcel_bytes;
            let renewed = self.find_mut(old)?;
            *renewed = OutboxEntry::announced(new, entry.badge);
            (renewed.state, renewed.replaced) = (EntryState::Kept, Some(old));
            (renewed.hash, renewed.parcel_bytes) = (Some(new_hash), parcel_bytes);
        }
        self.is_journal_due = true;
        Ok(())
    }

    /// The sculpture that gave an id up and is still to come, or came.
    #[must_use]
    pub fn successor_of(&self, id: SculptureId) -> Option<&OutboxEntry> {
        let is_successor =
            |entry: &&OutboxEntry| entry.replaced == Some(id) && entry.state.has_parcel();
        self.entries.iter().find(is_successor)
    }
}
