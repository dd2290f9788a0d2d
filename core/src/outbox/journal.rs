//! The outbox's journal: all that a start must know of it, in bytes of fixed width with a checksum.
//!
//! It is written whole, whenever it is due, and is never ahead of the folder: parcels are on the disk before it says
//! so, and gone before it forgets them. Where it is damaged, the parcels themselves say what they are, and only what
//! was signed for is forgotten: it is sent again, and gets the same receipt.

use heapless::Vec;

use crate::codec::bytes::{BadBytes, ByteReader, ByteWriter};
use crate::codec::digest::checksum;
use crate::limits::{MAX_OUTBOX_ENTRIES, MAX_PARCEL_BYTES};
use crate::outbox::entry::{EntryEvent, EntryState, OutboxEntry};
use crate::outbox::machine::{Outbox, OutboxOwner, OutboxSettings};
use crate::outbox::messages::{ContentHash, SculptureId, SiteId, UploadFacts};
use crate::outbox::messages::{
    read_badge, read_flags, read_headset, read_zeros, write_badge, write_zeros,
};

/// The first bytes of a journal.
const MAGIC: [u8; 4] = *b"PBOX";

/// Changes with every change of the journal's format.
const JOURNAL_VERSION: u16 = 1;

/// Length of a written entry in bytes.
const ENTRY_BYTES: usize = 2 * SculptureId::BYTES + 1 + 4 + ContentHash::BYTES + 4 + 4;

/// The length of what the checksum is of.
const BODY_BYTES: usize = 6 + SiteId::BYTES + 4 + 1 + 2 + MAX_OUTBOX_ENTRIES * ENTRY_BYTES;

impl Outbox {
    /// Length of a journal in bytes.
    pub const JOURNAL_BYTES: usize = BODY_BYTES + 8;

    /// Writes the journal. Once it is on the disk: [`Outbox::note_journal_written`].
    pub fn save(&self, bytes: &mut [u8; Self::JOURNAL_BYTES]) {
        let (body, sum) = bytes.split_at_mut(BODY_BYTES);
        let mut to = ByteWriter::new(body);
        to.bytes(&MAGIC);
        to.u16(JOURNAL_VERSION);
        self.owner.site.write(&mut to);
        to.u32(self.owner.headset);
        to.u8(u8::from(self.was_wiped));
        to.u16(self.entries.len() as u16);
        self.entries.iter().for_each(|entry| write_entry(&mut to, entry));
        write_zeros(&mut to, (MAX_OUTBOX_ENTRIES - self.entries.len()) * ENTRY_BYTES);
        sum.copy_from_slice(&checksum(body).to_le_bytes());
    }

    /// Reads what [`Outbox::save`] wrote. Where the journal is of another site, nothing counts that was signed for
    /// there. `boot_id` is random bits of this start, not 0.
    ///
    /// # Errors
    /// [`BadBytes`] for other bytes, or damaged ones. Begin a new outbox then, and take the parcels in that are there.
    pub fn load(
        bytes: &[u8],
        owner: OutboxOwner,
        settings: OutboxSettings,
        boot_id: u64,
    ) -> Result<Self, BadBytes> {
        let from = &mut ByteReader::new(bytes);
        let bad = from.error_here("the magic PBOX");
        if from.bytes(4)? != MAGIC {
            return Err(bad);
        }
        let bad = from.error_here("version 1 of an outbox's journal");
        if from.u16()? != JOURNAL_VERSION {
            return Err(bad);
        }
        let (site, _) = (SiteId::read(from)?, read_headset(from)?);
        let mut outbox = Outbox::new(owner, settings, boot_id);
        outbox.was_wiped = read_flags(from, 1, "0 or 1 for a wipe that is to be told")? == 1;
        outbox.entries = read_entries(from)?;
        let bad = from.error_here("the checksum of the bytes before");
        if Some(from.u64()?) != bytes.get(..BODY_BYTES).map(checksum) {
            return Err(bad);
        }
        from.expect_end()?;
        outbox.note_journal_written();
        if site != owner.site {
            outbox.leave_site();
        }
        Ok(outbox)
    }

    fn leave_site(&mut self) {
        self.is_journal_due = true;
        for entry in &mut self.entries {
            entry.enter(entry.state.next(EntryEvent::SiteChanged).unwrap_or(entry.state));
        }
    }

    /// Parcels were found where there was no journal: this is no new headset.
    pub fn note_not_wiped(&mut self) {
        self.was_wiped = false;
    }
}

/// The number of a state, and the seconds that belong to it. What is on its way is kept here, no more.
const fn state_to_bytes(state: EntryState) -> (u8, u32) {
    match state {
        EntryState::Announced => (0, 0),
        EntryState::Kept | EntryState::Sending { .. } => (1, 0),
        EntryState::Refused => (2, 0),
        EntryState::Lost => (3, 0),
        EntryState::Receipted { seconds } => (4, seconds),
        // Nothing that is gone is in the table.
        EntryState::Deletable | EntryState::Gone => (5, 0),
    }
}

const fn state_from_bytes(number: u8, seconds: u32) -> Option<EntryState> {
    Some(match (number, seconds) {
        (0, 0) => EntryState::Announced,
        (1, 0) => EntryState::Kept,
        (2, 0) => EntryState::Refused,
        (3, 0) => EntryState::Lost,
        (4, seconds) => EntryState::Receipted { seconds },
        (5, 0) => EntryState::Deletable,
        _ => return None,
    })
}

fn write_entry(to: &mut ByteWriter<'_>, entry: &OutboxEntry) {
    let (number, seconds) = state_to_bytes(entry.state);
    entry.id.write(to);
    to.u8(number);
    to.u32(seconds);
    write_badge(to, entry.badge);
    to.bytes(&entry.hash.map_or([0; ContentHash::BYTES], |hash| hash.0));
    to.u32(entry.parcel_bytes);
    to.bytes(&entry.replaced.map_or([0; SculptureId::BYTES], |id| id.0));
}

fn read_entries(
    from: &mut ByteReader<'_>,
) -> Result<Vec<OutboxEntry, MAX_OUTBOX_ENTRIES>, BadBytes> {
    let bad = from.error_here("up to 256 sculptures");
    let count = usize::from(from.u16()?);
    if count > MAX_OUTBOX_ENTRIES {
        return Err(bad);
    }
    let mut entries: Vec<OutboxEntry, MAX_OUTBOX_ENTRIES> = Vec::new();
    for _ in 0..count {
        let bad = from.error_here("another sculpture than those before");
        let entry = read_entry(from)?;
        let names = [Some(entry.id), entry.replaced];
        let is_known = |name: &SculptureId| {
            entries.iter().any(|other| other.id == *name || other.replaced == Some(*name))
        };
        if names.iter().flatten().any(is_known) || entry.replaced == Some(entry.id) {
            return Err(bad);
        }
        entries.push(entry).map_err(|_| bad)?;
    }
    let unused = (MAX_OUTBOX_ENTRIES - count) * ENTRY_BYTES;
    read_zeros(from, unused, "zeros after the last sculpture")?;
    Ok(entries)
}

fn read_entry(from: &mut ByteReader<'_>) -> Result<OutboxEntry, BadBytes> {
    let id = SculptureId::read(from)?;
    let bad = from.error_here("where a sculpture stands, 0 to 5, and seconds of a receipt");
    let state = state_from_bytes(from.u8()?, from.u32()?).ok_or(bad)?;
    let badge = read_badge(from)?;
    let bad = from.error_here("a parcel's hash and length, where there is one");
    let mut hash = [0; ContentHash::BYTES];
    hash.copy_from_slice(from.bytes(ContentHash::BYTES)?);
    let hash = Some(ContentHash(hash)).filter(|hash| hash.0 != [0; ContentHash::BYTES]);
    let parcel_bytes = from.u32()?;
    let is_parcel = u64::from(parcel_bytes) <= MAX_PARCEL_BYTES
        && parcel_bytes as usize >= UploadFacts::BYTES
        && hash.is_some();
    let is_none = parcel_bytes == 0 && hash.is_none();
    let is_sound = match state {
        EntryState::Announced => is_none,
        EntryState::Lost => is_none || is_parcel,
        _ => is_parcel,
    };
    if !is_sound {
        return Err(bad);
    }
    let mut replaced = [0; SculptureId::BYTES];
    replaced.copy_from_slice(from.bytes(SculptureId::BYTES)?);
    let replaced = Some(SculptureId(replaced)).filter(|id| id.0 != [0; SculptureId::BYTES]);
    Ok(OutboxEntry { hash, parcel_bytes, state, replaced, ..OutboxEntry::announced(id, badge) })
}
