//! A start: the journal is compared with the folder, and what the folder says is right.

use std::collections::HashSet;
use std::io;
use std::mem;

use paros_core::outbox::messages::SculptureId;
use paros_core::outbox::{EntryState, Outbox, OutboxEntry, OutboxOwner, OutboxSettings};

use super::driver::{JOURNAL, OutboxDriver, damaged_name, parcel_name};
use super::events::{OutboxError, OutboxEvent};
use super::folder::OutboxFolder;
use super::link::BoothLink;
use super::parcel::{MAX_FILE_BYTES, Parcel};

impl<F: OutboxFolder, L: BoothLink> OutboxDriver<F, L> {
    /// Opens the outbox in a folder. `boot_id` is random bits of this start, not 0.
    ///
    /// # Errors
    /// `Disk` where the folder can't be listed.
    pub fn open(
        folder: F,
        link: L,
        owner: OutboxOwner,
        settings: OutboxSettings,
        boot_id: u64,
    ) -> Result<Self, OutboxError> {
        let disk_error = |source| OutboxError::Disk { name: "folder".into(), source };
        let names = folder.list().map_err(disk_error)?;
        let mut events = Vec::new();
        let outbox = match folder.read(JOURNAL, Outbox::JOURNAL_BYTES as u64) {
            Ok(bytes) => Outbox::load(&bytes, owner, settings, boot_id).ok().map(Box::new),
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                Some(Box::new(Outbox::new(owner, settings, boot_id)))
            }
            Err(_) => None,
        };
        let outbox = outbox.unwrap_or_else(|| {
            events.push(OutboxEvent::JournalDamaged);
            let mut outbox = Box::new(Outbox::new(owner, settings, boot_id));
            outbox.note_not_wiped();
            outbox
        });
        let mut driver = OutboxDriver::new(outbox, folder, link, events);
        driver.compare_with_folder(&names);
        driver.renew_foreign();
        // Where it fails, the first step says so.
        let _ = driver.write_journal();
        Ok(driver)
    }

    fn compare_with_folder(&mut self, names: &[String]) {
        let mut here = HashSet::new();
        for name in names {
            if name.starts_with(".paros-") && name.ends_with(".part") {
                // A write that was cut off: nobody else writes here. If it stays, the next start tries again.
                let _ = self.folder.remove(name);
            }
            let id = name.strip_suffix(".parcel").and_then(SculptureId::parse_hex);
            if let Some(id) = id.filter(|id| parcel_name(*id) == *name)
                && self.compare_parcel(id)
            {
                here.insert(id);
            }
        }
        let known: Vec<SculptureId> = self.outbox.entries().iter().map(|entry| entry.id).collect();
        for id in known.into_iter().filter(|id| !here.contains(id)) {
            // One that was made again isn't among the names.
            let read = self.folder.read(&parcel_name(id), MAX_FILE_BYTES);
            if read.is_err_and(|error| error.kind() == io::ErrorKind::NotFound) {
                self.note_missing(id);
            }
        }
    }

    /// Compares one parcel with what is known of it. Returns whether its file stays where it is.
    pub(super) fn compare_parcel(&mut self, id: SculptureId) -> bool {
        let name = parcel_name(id);
        let is_successor = |entry: &&OutboxEntry| entry.replaced == Some(id);
        if let Some(successor) = self.outbox.entries().iter().find(is_successor).copied() {
            let is_given_up = self.has_successor(id, &successor);
            if is_given_up {
                self.given_up.push(id);
            }
            return !is_given_up;
        }
        let Ok(bytes) = self.folder.read(&name, MAX_FILE_BYTES) else {
            // Whether it can be read again shows when it is sent.
            return true;
        };
        let parcel = Parcel::read_file(bytes).ok().filter(|parcel| parcel.facts().id == id);
        let own = self.outbox.owner().headset;
        self.has_foreign |= parcel.as_ref().is_some_and(|parcel| parcel.facts().headset != own);
        if self.outbox.find(id).is_none_or(|entry| !entry.state.has_parcel()) {
            self.outbox.note_not_wiped();
            return match parcel {
                Some(parcel) => {
                    let badge = parcel.facts().badge;
                    let kept = self.outbox.keep(id, badge, parcel.hash(), parcel.len());
                    // The table is full: it is taken in once something has left it.
                    self.has_unlisted |= kept.is_err();
                    true
                }
                None => self.set_aside(id),
            };
        }
        let known = self.outbox.find(id).and_then(|entry| entry.hash);
        if parcel.is_some_and(|parcel| Some(parcel.hash()) == known) {
            return true;
        }
        self.set_aside(id)
    }

    /// What the headset owes from when it had another number goes on as one of this headset before the booth hears of it:
    /// under its old id it would be waited for in vain.
    fn renew_foreign(&mut self) {
        if !mem::take(&mut self.has_foreign) {
            return;
        }
        let owed = self.outbox.entries().iter().filter(|entry| entry.state.is_owed());
        let owed: Vec<_> = owed.filter_map(|entry| Some((entry.id, entry.hash?))).collect();
        for (id, hash) in owed {
            let parcel = self.read_parcel(id);
            let own = self.outbox.owner().headset;
            if parcel.is_some_and(|parcel| parcel.facts().headset != own) {
                // Where that can't be written now, it is done when it is sent.
                self.renew(id, hash);
            }
        }
    }

    /// Whether the parcel that goes on in an old one's place is whole, or signed for. One that isn't is made again of the old
    /// one.
    fn has_successor(&mut self, old: SculptureId, successor: &OutboxEntry) -> bool {
        let OutboxEntry { id: new, hash, state, .. } = *successor;
        if state.has_parcel() && !state.is_owed() {
            return true;
        }
        let read = |id| self.read_parcel(id).filter(|parcel| parcel.facts().id == id);
        let is_its = |parcel: &Parcel| parcel.facts().id == new && Some(parcel.hash()) == hash;
        if read(new).is_some_and(|parcel| is_its(&parcel)) {
            return true;
        }
        let renewed = read(old).and_then(|parcel| parcel.renew(self.outbox.owner().headset).ok());
        let Some(renewed) = renewed.filter(is_its) else { return false };
        let is_written = self.folder.write(&parcel_name(new), &renewed.to_file()).is_ok();
        if is_written {
            // Where it isn't missed yet, it won't be.
            self.events.retain(|event| *event != OutboxEvent::Lost(new));
            let _ = self.outbox.keep(new, renewed.facts().badge, renewed.hash(), renewed.len());
        }
        is_written
    }

    /// A parcel as it is on the disk; `None` where it isn't there, can't be read, or is damaged.
    pub(super) fn read_parcel(&self, id: SculptureId) -> Option<Parcel> {
        let read = self.folder.read(&parcel_name(id), MAX_FILE_BYTES);
        read.ok().and_then(|bytes| Parcel::read_file(bytes).ok())
    }

    /// Gives a damaged parcel a name by which nothing takes it for one. What is signed for is deleted instead. Returns
    /// whether it has its name still.
    pub(super) fn set_aside(&mut self, id: SculptureId) -> bool {
        let is_owed = self.outbox.find(id).is_none_or(|entry| entry.state.is_owed());
        let name = parcel_name(id);
        let done = match is_owed {
            true => self.folder.rename(&name, &damaged_name(id)),
            false => self.folder.remove(&name),
        };
        if done.is_ok() {
            self.note_missing(id);
        }
        done.is_err()
    }

    /// A parcel that is known isn't there. One that is still to be made isn't missed.
    fn note_missing(&mut self, id: SculptureId) {
        let has_parcel = self.outbox.find(id).is_some_and(|entry| entry.state.has_parcel());
        if has_parcel && self.outbox.note_parcel_missing(id).is_ok() {
            let is_lost = |entry: &OutboxEntry| entry.state == EntryState::Lost;
            if self.outbox.find(id).is_some_and(is_lost) {
                self.events.push(OutboxEvent::Lost(id));
            }
        }
    }
}
