//! The spool: the parcels in an outbox's folder. The folder is the state: the name of a file gives the status
//! of its sculpture.

use std::collections::BTreeSet;
use std::io;

use paros_core::badge::BadgeNumber;
use paros_protocol::limits::MAX_PARCEL_FILE_BYTES;
use paros_protocol::{
    Announcement, Parcel, ParcelFault, SculptureId, UploadStatus, parcel_name, parse_parcel_name,
};

use super::folder::OutboxFolder;

/// Largest number of sculptures in a spool: five days of 50 visits without the booth, and some spare.
pub const MAX_SPOOL_ENTRIES: usize = 256;

/// Interval in milliseconds at which unloadable files are tried again: a bad sector takes long to read.
const LOOK_AGAIN_MS: u64 = 60_000;

/// The outbox settings of an exhibition.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct OutboxSettings {
    /// Seconds for which a parcel is kept here after the booth has it.
    pub grace_seconds: u32,
    /// Largest size of all parcels together in bytes.
    pub max_bytes: u64,
}

/// The reason why an operation failed. Every sculpture that the booth doesn't have still has its parcel.
#[derive(Debug, thiserror::Error)]
pub enum SpoolError {
    /// The spool is full, and nothing may be deleted.
    #[error("the outbox is full with sculptures that the booth doesn't have")]
    Full,
    /// A sculpture of this id already exists.
    #[error("there is a sculpture of this id")]
    KnownId,
    /// There is no sculpture of this id whose parcel is still to be made.
    #[error("there is no sculpture of this id whose parcel is to be made")]
    UnknownId,
    /// The disk refused.
    #[error("the outbox's {name}: {source}")]
    Disk {
        /// The name of the file.
        name: String,
        /// The error of the system.
        source: io::Error,
    },
}

/// A sculpture in the spool.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SpoolEntry {
    /// The sculpture's id.
    pub id: SculptureId,
    /// The badge that the visitor was shown, once there is one.
    pub badge: Option<BadgeNumber>,
    /// The upload status of the sculpture.
    pub status: UploadStatus,
    /// Size of its file in bytes; 0 if there is no file.
    pub bytes: u64,
    /// Seconds since 1970 by the headset's wall clock. The entries are sorted by it.
    finished_at: u64,
    /// The time when the booth accepted the parcel, in milliseconds of the sender; negative if that was
    /// before this start.
    sent_ms: i64,
    /// The last announcement that the booth acknowledged.
    pub(super) noted: Option<Announcement>,
    /// Number of consecutive failed requests.
    pub(super) failures: u8,
    /// The time of the next try of a refused parcel, in milliseconds of the sender.
    pub(super) retry_ms: u64,
    /// The time when the booth last confirmed that it has the sent parcel, in milliseconds of the sender;
    /// `None` if it hasn't in this start.
    pub(super) confirmed_ms: Option<u64>,
    /// `true` if the heartbeat under way asks for this confirmation.
    pub(super) is_asked_for: bool,
}

/// The parcels of a folder.
#[derive(Debug)]
pub struct Spool<F> {
    folder: F,
    settings: OutboxSettings,
    /// The sculptures, the oldest first.
    entries: Vec<SpoolEntry>,
    /// `true` if the folder has parcels that don't fit in the table, or that couldn't be read.
    has_unlisted: bool,
    /// The time of the next try to load them, in milliseconds of the sender.
    next_look_ms: u64,
}

impl SpoolEntry {
    fn new(id: SculptureId, badge: Option<BadgeNumber>, status: UploadStatus) -> Self {
        SpoolEntry {
            id,
            badge,
            status,
            bytes: 0,
            finished_at: u64::MAX,
            sent_ms: 0,
            noted: None,
            failures: 0,
            retry_ms: 0,
            confirmed_ms: None,
            is_asked_for: false,
        }
    }

    /// Returns the seconds since the booth accepted the parcel. `now_ms` is the sender's time.
    #[must_use]
    pub(super) fn sent_seconds(&self, now_ms: u64) -> u64 {
        let now_ms = i64::try_from(now_ms).unwrap_or(i64::MAX);
        u64::try_from(now_ms.saturating_sub(self.sent_ms) / 1000).unwrap_or(0)
    }

    /// Returns the announcement of the sculpture; `None` if the booth has it.
    #[must_use]
    pub fn announcement(&self) -> Option<Announcement> {
        let SpoolEntry { id, badge, status, .. } = *self;
        (status != UploadStatus::Sent).then_some(Announcement { id, badge, status })
    }
}

impl<F: OutboxFolder> Spool<F> {
    /// Opens a folder: renames damaged files, and removes the remains of interrupted writes.
    ///
    /// # Errors
    /// Returns `Disk` if the folder can't be listed.
    pub fn open(folder: F, settings: OutboxSettings) -> Result<Self, SpoolError> {
        let mut spool = Spool {
            folder,
            settings,
            entries: Vec::new(),
            has_unlisted: false,
            next_look_ms: LOOK_AGAIN_MS,
        };
        let names = spool.list()?;
        for name in names.iter().filter(|name| name.starts_with(".paros-")) {
            // No other process writes here. If the removal fails, the next start tries again.
            let _ = spool.folder.remove(name);
        }
        spool.take_in(&names);
        Ok(spool)
    }

    pub(super) const fn folder(&self) -> &F {
        &self.folder
    }

    pub(super) const fn folder_mut(&mut self) -> &mut F {
        &mut self.folder
    }

    /// `true` if the folder has no files: the device is new, or its data was wiped.
    #[must_use]
    pub fn is_new(&self) -> bool {
        self.entries.is_empty() && self.list().is_ok_and(|names| names.is_empty())
    }

    fn list(&self) -> Result<Vec<String>, SpoolError> {
        let listed = self.folder.list();
        listed.map_err(|source| SpoolError::Disk { name: "folder".into(), source })
    }

    /// Loads files that aren't in the table: first those that the booth doesn't have.
    fn take_in(&mut self, names: &[String]) {
        self.has_unlisted = false;
        // If a sculpture has two files, a damaged file comes last.
        let is_last = |status| status == UploadStatus::Lost;
        let files: BTreeSet<_> = names
            .iter()
            .filter_map(|name| parse_parcel_name(name))
            .map(|(id, status)| (is_last(status), status, id))
            .collect();
        for (_, status, id) in files {
            if self.find(id).is_some() {
                // An interrupted rename left both names. The first file is sent again, which is idempotent.
                continue;
            }
            if self.entries.len() >= MAX_SPOOL_ENTRIES {
                self.has_unlisted = true;
                continue;
            }
            let entry = self.read_entry(id, status);
            self.entries.extend(entry);
        }
        self.entries.sort_by_key(|entry| (entry.finished_at, entry.id));
    }

    fn read_entry(&mut self, id: SculptureId, status: UploadStatus) -> Option<SpoolEntry> {
        let mut entry = SpoolEntry::new(id, None, status);
        let name = parcel_name(id, status);
        if status == UploadStatus::Lost {
            return Some(entry);
        }
        let Ok(bytes) = self.folder.read(&name, MAX_PARCEL_FILE_BYTES) else {
            // A later sweep tries again.
            self.has_unlisted = true;
            return None;
        };
        entry.bytes = bytes.len() as u64;
        let parcel = match Parcel::read(bytes) {
            Ok(parcel) if parcel.facts().id == id => parcel,
            Err(ParcelFault::Damaged { .. }) => {
                entry.status = self.set_aside(id, status)?;
                entry.bytes = 0;
                return Some(entry);
            }
            // The file belongs to another version, and stays for that version.
            _ => return None,
        };
        (entry.badge, entry.finished_at) = (parcel.facts().badge, parcel.facts().finished_at);
        if status == UploadStatus::Sent {
            let age_ms = self.folder.age_seconds(&name).saturating_mul(1000);
            entry.sent_ms = i64::try_from(age_ms).map_or(i64::MIN, |age_ms| -age_ms);
        }
        Some(entry)
    }

    /// Renames a damaged file, or removes it if it was sent. Returns the new status; `None` if removed.
    fn set_aside(&mut self, id: SculptureId, status: UploadStatus) -> Option<UploadStatus> {
        let name = parcel_name(id, status);
        if status == UploadStatus::Sent {
            return self.folder.remove(&name).is_err().then_some(status);
        }
        let renamed = self.folder.rename(&name, &parcel_name(id, UploadStatus::Lost));
        Some(if renamed.is_ok() { UploadStatus::Lost } else { status })
    }

    /// Returns all sculptures, the oldest first.
    #[must_use]
    pub fn entries(&self) -> &[SpoolEntry] {
        &self.entries
    }

    pub(super) fn entries_mut(&mut self) -> &mut [SpoolEntry] {
        &mut self.entries
    }

    /// Finds the sculpture of an id.
    #[must_use]
    pub fn find(&self, id: SculptureId) -> Option<&SpoolEntry> {
        self.entries.iter().find(|entry| entry.id == id)
    }

    pub(super) fn find_mut(&mut self, id: SculptureId) -> Option<&mut SpoolEntry> {
        self.entries.iter_mut().find(|entry| entry.id == id)
    }

    fn owed(&self) -> impl Iterator<Item = &SpoolEntry> {
        self.entries.iter().filter(|entry| entry.status != UploadStatus::Sent)
    }

    /// Returns the number of sculptures that the booth doesn't have.
    #[must_use]
    pub fn depth(&self) -> usize {
        self.owed().count()
    }

    /// Returns the share of the outbox that is filled with parcels that the booth doesn't have, in percent:
    /// of entries or of bytes, whichever is higher.
    #[must_use]
    pub fn full_percent(&self) -> u8 {
        let bytes: u64 = self.owed().map(|entry| entry.bytes).sum();
        let of_entries = (self.depth() * 100 / MAX_SPOOL_ENTRIES) as u64;
        let of_bytes = bytes.saturating_mul(100).checked_div(self.settings.max_bytes);
        of_entries.max(of_bytes.unwrap_or(100)).min(100) as u8
    }

    /// `true` if at least 80 % of the outbox are filled. Staff see a warning then.
    #[must_use]
    pub fn is_nearly_full(&self) -> bool {
        self.full_percent() >= 80
    }

    /// Adds a finished sculpture whose parcel is being made.
    ///
    /// # Errors
    /// Returns `KnownId` or `Full`. The visit continues in either case.
    pub fn announce(
        &mut self,
        id: SculptureId,
        badge: Option<BadgeNumber>,
    ) -> Result<(), SpoolError> {
        if self.find(id).is_some() {
            return Err(SpoolError::KnownId);
        }
        self.make_room(1, 0)?;
        self.entries.push(SpoolEntry::new(id, badge, UploadStatus::Making));
        Ok(())
    }

    /// Sets the badge of a sculpture whose parcel isn't made yet.
    ///
    /// # Errors
    /// Returns `UnknownId`.
    pub fn note_badge(&mut self, id: SculptureId, badge: BadgeNumber) -> Result<(), SpoolError> {
        self.find_making(id)?.badge = Some(badge);
        Ok(())
    }

    /// Marks a sculpture as lost, because its parcel won't be made.
    ///
    /// # Errors
    /// Returns `UnknownId`.
    pub fn abandon(&mut self, id: SculptureId) -> Result<(), SpoolError> {
        self.find_making(id)?.status = UploadStatus::Lost;
        Ok(())
    }

    fn find_making(&mut self, id: SculptureId) -> Result<&mut SpoolEntry, SpoolError> {
        let found = self.find_mut(id).filter(|entry| entry.status == UploadStatus::Making);
        found.ok_or(SpoolError::UnknownId)
    }

    /// Writes a parcel to the disk: *kept here*. Does nothing if the parcel is already here.
    ///
    /// # Errors
    /// Returns `Full` or `Disk`.
    pub fn keep(&mut self, parcel: &Parcel) -> Result<(), SpoolError> {
        let facts = parcel.facts();
        let known = self.find(facts.id).map(|entry| entry.status);
        if matches!(known, Some(UploadStatus::Kept | UploadStatus::Refused | UploadStatus::Sent)) {
            return Ok(());
        }
        let bytes = parcel.file_bytes().len() as u64;
        self.make_room(usize::from(known.is_none()), bytes)?;
        self.write(&parcel_name(facts.id, UploadStatus::Kept), parcel.file_bytes())?;
        self.entries.retain(|entry| entry.id != facts.id);
        let entry = SpoolEntry::new(facts.id, facts.badge, UploadStatus::Kept);
        self.entries.push(SpoolEntry { bytes, finished_at: facts.finished_at, ..entry });
        Ok(())
    }

    /// Writes a file. If the disk is full, deletes sent parcels, the oldest first.
    fn write(&mut self, name: &str, bytes: &[u8]) -> Result<(), SpoolError> {
        loop {
            let Err(source) = self.folder.write(name, bytes) else { return Ok(()) };
            let kind = source.kind();
            let is_full = matches!(kind, io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded);
            if !is_full || !self.delete_oldest_sent() {
                return Err(SpoolError::Disk { name: name.into(), source });
            }
        }
    }

    /// Deletes the oldest sent parcel that can be deleted. Returns `false` if there is none.
    fn delete_oldest_sent(&mut self) -> bool {
        let sent = self.entries.iter().filter(|entry| entry.status == UploadStatus::Sent);
        let ids: Vec<SculptureId> = sent.map(|entry| entry.id).collect();
        ids.into_iter().any(|id| self.delete(id))
    }

    /// Forgets the oldest lost sculpture, whose loss the booth hasn't acknowledged; `false` if there is none.
    fn forget_oldest_lost(&mut self) -> bool {
        let lost = self.entries.iter().find(|entry| entry.status == UploadStatus::Lost);
        let id = lost.map(|entry| entry.id);
        id.inspect(|id| self.forget(*id)).is_some()
    }

    /// Counts the entries that can't be removed, and the bytes of their files.
    fn count_owed(&self) -> (usize, u64) {
        let may_leave = |status| matches!(status, UploadStatus::Sent | UploadStatus::Lost);
        let owed = self.entries.iter().filter(|entry| !may_leave(entry.status));
        owed.fold((0, 0), |(count, bytes), entry| (count + 1, bytes + entry.bytes))
    }

    /// Makes room: deletes sent parcels, the oldest first, then forgets lost sculptures.
    fn make_room(&mut self, more_entries: usize, more_bytes: u64) -> Result<(), SpoolError> {
        let (owed, owed_bytes) = self.count_owed();
        let has_room = owed_bytes.saturating_add(more_bytes) <= self.settings.max_bytes;
        if !has_room || owed + more_entries > MAX_SPOOL_ENTRIES {
            return Err(SpoolError::Full);
        }
        loop {
            let bytes: u64 = self.entries.iter().map(|entry| entry.bytes).sum();
            let fits = bytes.saturating_add(more_bytes) <= self.settings.max_bytes;
            if fits && self.entries.len() + more_entries <= MAX_SPOOL_ENTRIES {
                return Ok(());
            }
            if !self.delete_oldest_sent() && !self.forget_oldest_lost() {
                return Err(SpoolError::Full);
            }
        }
    }

    /// Reads a sculpture's parcel; `None` if it can't be read now. Marks missing or damaged parcels as lost.
    pub(super) fn read(&mut self, id: SculptureId) -> Option<Parcel> {
        let status = self.find(id)?.status;
        let bytes = match self.folder.read(&parcel_name(id, status), MAX_PARCEL_FILE_BYTES) {
            Ok(bytes) => bytes,
            Err(error) => {
                if error.kind() == io::ErrorKind::NotFound {
                    self.note_lost(id);
                }
                return None;
            }
        };
        match Parcel::read(bytes) {
            Ok(parcel) => Some(parcel),
            Err(_) => {
                if self.set_aside(id, status) == Some(UploadStatus::Lost) {
                    self.note_lost(id);
                }
                None
            }
        }
    }

    fn note_lost(&mut self, id: SculptureId) {
        if let Some(entry) = self.find_mut(id) {
            (entry.status, entry.bytes) = (UploadStatus::Lost, 0);
        }
    }

    /// Sets the status of a parcel, and renames its file accordingly. Returns `false` if the disk refuses.
    pub(super) fn rename(&mut self, id: SculptureId, status: UploadStatus, now_ms: u64) -> bool {
        let Some(before) = self.find(id).map(|entry| entry.status) else { return false };
        let names = [before, status].map(|status| parcel_name(id, status));
        let is_done = before == status || self.folder.rename(&names[0], &names[1]).is_ok();
        if let Some(entry) = self.find_mut(id).filter(|_| is_done) {
            (entry.status, entry.failures, entry.noted) = (status, 0, None);
            entry.sent_ms = i64::try_from(now_ms).unwrap_or(i64::MAX);
            (entry.confirmed_ms, entry.is_asked_for) = (Some(now_ms), false);
        }
        is_done
    }

    /// Deletes a sculpture's file. Returns `false` if the disk refuses.
    pub(super) fn delete(&mut self, id: SculptureId) -> bool {
        let Some(status) = self.find(id).map(|entry| entry.status) else { return true };
        let is_done = self.folder.remove(&parcel_name(id, status)).is_ok();
        if is_done {
            self.forget(id);
        }
        is_done
    }

    /// Removes a sculpture from the table. Its file, if there is one, stays for people to examine.
    pub(super) fn forget(&mut self, id: SculptureId) {
        self.entries.retain(|entry| entry.id != id);
    }

    /// Deletes sent parcels after their grace period, and loads files that aren't in the table.
    pub(super) fn sweep(&mut self, now_ms: u64) {
        let grace_seconds = u64::from(self.settings.grace_seconds);
        let is_over = |entry: &&SpoolEntry| {
            // The booth may have been restored and lack the parcel: its confirmation is needed first.
            let is_confirmed = entry.confirmed_ms.is_some() && !entry.is_asked_for;
            let is_sent = entry.status == UploadStatus::Sent && is_confirmed;
            is_sent && entry.sent_seconds(now_ms) > grace_seconds
        };
        let ids: Vec<SculptureId> =
            self.entries.iter().filter(is_over).map(|entry| entry.id).collect();
        for id in ids {
            // A failed deletion is retried by the next sweep.
            self.delete(id);
        }
        if self.has_unlisted
            && now_ms >= self.next_look_ms
            && self.entries.len() < MAX_SPOOL_ENTRIES
            && let Ok(names) = self.list()
        {
            self.next_look_ms = now_ms + LOOK_AGAIN_MS;
            self.take_in(&names);
        }
    }
}
