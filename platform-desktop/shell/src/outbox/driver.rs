//! Carries out what the outbox decides.

use std::io;
use std::mem;

use paros_core::badge::BadgeNumber;
use paros_core::outbox::messages::{CommandOutcome, SculptureId};
use paros_core::outbox::{Outbox, OutboxRefusal, UploadAnswer, UploadRequest};

use super::events::{OutboxError, OutboxEvent, OutboxHost};
use super::folder::OutboxFolder;
use super::link::{BoothLink, BoothRequest};
use super::parcel::{MAX_FILE_BYTES, Parcel};

/// The journal's name.
pub(super) const JOURNAL: &str = "outbox.journal";

/// Milliseconds until a journal that couldn't be written is tried again: a disk that is full stays so for a while.
const JOURNAL_RETRY_MS: u64 = 1000;

/// The name of a parcel's file.
pub(super) fn parcel_name(id: SculptureId) -> String {
    format!("{id}.parcel")
}

/// The name of what was a parcel.
pub(super) fn damaged_name(id: SculptureId) -> String {
    format!("{id}.damaged")
}

/// An outbox with its folder and its link to the booth.
#[derive(Debug)]
pub struct OutboxDriver<F, L> {
    pub(super) outbox: Box<Outbox>,
    pub(super) folder: F,
    link: L,
    /// The part that is under way.
    pub(super) sent: Option<UploadRequest>,
    /// The parcel that is being sent.
    read: Option<Parcel>,
    /// Ids whose parcels are to be removed once the journal says why.
    pub(super) given_up: Vec<SculptureId>,
    /// How many parcels couldn't be removed since one could.
    unremoved: usize,
    /// Whether a parcel was found that is of another number than the headset's.
    pub(super) has_foreign: bool,
    /// Whether there are parcels that the table has no room for.
    pub(super) has_unlisted: bool,
    /// When the last heartbeat was sent.
    pub(super) heartbeat_ms: u64,
    /// When the journal couldn't be written.
    journal_failed_ms: Option<u64>,
    pub(super) events: Vec<OutboxEvent>,
}

impl<F: OutboxFolder, L: BoothLink> OutboxDriver<F, L> {
    pub(super) const fn new(
        outbox: Box<Outbox>,
        folder: F,
        link: L,
        events: Vec<OutboxEvent>,
    ) -> Self {
        OutboxDriver {
            outbox,
            folder,
            link,
            sent: None,
            read: None,
            given_up: Vec::new(),
            unremoved: 0,
            has_foreign: false,
            has_unlisted: false,
            heartbeat_ms: 0,
            journal_failed_ms: None,
            events,
        }
    }

    /// What is known of all sculptures.
    #[must_use]
    pub fn outbox(&self) -> &Outbox {
        &self.outbox
    }

    /// The link, as it is.
    pub const fn link(&mut self) -> &mut L {
        &mut self.link
    }

    /// Takes in a sculpture that is finished. Once it returns the id is on the disk.
    ///
    /// # Errors
    /// `Refused` where the outbox is full or knows the id; `Disk`. The visit goes on without.
    pub fn announce(
        &mut self,
        id: SculptureId,
        badge: Option<BadgeNumber>,
    ) -> Result<(), OutboxError> {
        let before = self.outbox.clone();
        self.outbox.announce(id, badge)?;
        self.write_journal().map_err(|source| {
            self.outbox = before;
            OutboxError::Disk { name: JOURNAL.into(), source }
        })
    }

    /// Notes the badge of a sculpture whose parcel isn't made yet.
    ///
    /// # Errors
    /// Those of [`Outbox::note_badge`].
    pub fn note_badge(&mut self, id: SculptureId, badge: BadgeNumber) -> Result<(), OutboxError> {
        Ok(self.outbox.note_badge(id, badge)?)
    }

    /// Keeps a parcel. Once it returns it is on the disk: *kept here*. One of an id that is kept already changes
    /// nothing.
    ///
    /// # Errors
    /// `Refused` where there is no room, or the id was given up; `Disk`.
    pub fn keep(&mut self, parcel: &Parcel) -> Result<(), OutboxError> {
        let id = parcel.facts().id;
        match self.outbox.find(id) {
            Some(entry) if entry.state.has_parcel() => return Ok(()),
            Some(_) => {}
            None => {
                // It would be announced with it: whether it may be is known before it is written.
                let mut after = self.outbox.clone();
                after.announce(id, parcel.facts().badge)?;
            }
        }
        if !self.outbox.has_room_for(parcel.bytes().len() as u64) {
            return Err(OutboxRefusal::Full.into());
        }
        let name = parcel_name(id);
        let written = self.folder.write(&name, &parcel.to_file());
        written.map_err(|source| OutboxError::Disk { name, source })?;
        self.outbox.keep(id, parcel.facts().badge, parcel.hash(), parcel.len())?;
        self.events.push(OutboxEvent::KeptHere(id));
        // The parcel itself says what it is: the journal may follow later.
        let _ = self.write_journal();
        Ok(())
    }

    /// The parcel of a sculpture won't be made.
    ///
    /// # Errors
    /// `Refused` where there is no such sculpture, or its parcel is kept.
    pub fn abandon(&mut self, id: SculptureId) -> Result<(), OutboxError> {
        if self.outbox.find(id).is_some_and(|entry| entry.state.has_parcel()) {
            return Err(OutboxRefusal::WrongState.into());
        }
        self.outbox.note_parcel_missing(id)?;
        self.events.push(OutboxEvent::Lost(id));
        Ok(())
    }

    /// What came of a command.
    pub fn note_command_done(&mut self, id: u64, outcome: CommandOutcome) {
        self.outbox.note_command_done(id, outcome);
    }

    /// Does what there is to do: takes answers, writes the journal, removes a file, sends a part and a heartbeat. To be
    /// called ten times a second or so.
    pub fn step(&mut self, host: &mut impl OutboxHost) {
        let now_ms = host.now_ms();
        self.outbox.pass_time(now_ms);
        while let Some(answer) = self.link.poll() {
            self.take_answer(&answer, host);
        }
        self.write_journal_or_wait(now_ms);
        self.remove_one();
        self.send_part(host.random());
        if self.outbox.is_heartbeat_due() {
            self.send_heartbeat(host);
        }
        for event in mem::take(&mut self.events) {
            host.on_event(event);
        }
    }

    pub(super) fn write_journal(&mut self) -> io::Result<()> {
        if self.outbox.is_journal_due() {
            let mut bytes = Box::new([0; Outbox::JOURNAL_BYTES]);
            self.outbox.save(&mut bytes);
            self.folder.write(JOURNAL, &bytes[..])?;
            self.outbox.note_journal_written();
        }
        Ok(())
    }

    fn write_journal_or_wait(&mut self, now_ms: u64) {
        let passed_ms = self.journal_failed_ms.and_then(|failed| now_ms.checked_sub(failed));
        if passed_ms.is_some_and(|passed| passed < JOURNAL_RETRY_MS) {
            return;
        }
        self.journal_failed_ms = None;
        if let Err(error) = self.write_journal() {
            self.journal_failed_ms = Some(now_ms);
            self.events.push(OutboxEvent::JournalUnwritten(error.kind()));
        }
    }

    /// Removes a parcel that the journal says is given up or signed for. One that can't be removed waits until the others
    /// were tried.
    fn remove_one(&mut self) {
        let mut ids = self.outbox.parcels_to_delete().collect::<Vec<_>>();
        if !self.outbox.is_journal_due() {
            ids.extend(&self.given_up);
        }
        let turn = self.unremoved.checked_rem(ids.len()).unwrap_or_default();
        let Some(&id) = ids.get(turn) else { return };
        if self.folder.remove(&parcel_name(id)).is_err() {
            self.unremoved = turn + 1;
            return;
        }
        self.unremoved = 0;
        self.given_up.retain(|other| *other != id);
        // One that was given up isn't in the table.
        if self.outbox.note_deleted(id).is_ok() && mem::take(&mut self.has_unlisted) {
            self.take_in_unlisted();
        }
    }

    /// Takes in parcels that there was no room for.
    fn take_in_unlisted(&mut self) {
        let Ok(names) = self.folder.list() else {
            self.has_unlisted = true;
            return;
        };
        for name in names {
            let id = name.strip_suffix(".parcel").and_then(SculptureId::parse_hex);
            if let Some(id) = id.filter(|&id| self.outbox.find(id).is_none()) {
                let _ = self.compare_parcel(id);
            }
        }
    }

    fn send_part(&mut self, random: u32) {
        let Some(request) = self.outbox.begin_upload(random) else { return };
        let UploadRequest { number, id, hash, parcel_bytes, offset, len } = request;
        self.sent = Some(request);
        let Some(part) = self.read_part(&request) else {
            self.sent = None;
            // There is no answer to take.
            let _ = self.outbox.take_upload_answer(number, UploadAnswer::Failed, random);
            return;
        };
        debug_assert_eq!(part.len(), len as usize);
        self.link.send(BoothRequest::Put { number, id, hash, parcel_bytes, offset, part });
    }

    /// The bytes of a part; `None` where the parcel can't be read now, or is damaged.
    fn read_part(&mut self, request: &UploadRequest) -> Option<Vec<u8>> {
        if self.read.as_ref().is_none_or(|parcel| parcel.hash() != request.hash) {
            self.read = None;
            let read = self.folder.read(&parcel_name(request.id), MAX_FILE_BYTES);
            if let Err(error) = &read
                && error.kind() != io::ErrorKind::NotFound
            {
                return None;
            }
            let parcel = read.ok().and_then(|bytes| Parcel::read_file(bytes).ok());
            let parcel = parcel.filter(|parcel| parcel.hash() == request.hash);
            if parcel.is_none() {
                self.set_aside_or_lose(request.id);
            }
            let headset = self.outbox.owner().headset;
            if parcel.as_ref().is_some_and(|parcel| parcel.facts().headset != headset) {
                // The booth takes what is of this headset alone.
                self.renew(request.id, request.hash);
                return None;
            }
            self.read = parcel;
        }
        let (start, len) = (request.offset as usize, request.len as usize);
        self.read.as_ref()?.bytes().get(start..start + len).map(<[u8]>::to_vec)
    }

    /// A parcel that was there at the start is gone or damaged now.
    fn set_aside_or_lose(&mut self, id: SculptureId) {
        if self.set_aside(id) && self.outbox.note_parcel_missing(id).is_ok() {
            self.events.push(OutboxEvent::Lost(id));
        }
    }

    fn send_heartbeat(&mut self, host: &mut impl OutboxHost) {
        self.heartbeat_ms = host.now_ms();
        let (status, lease, random) = (host.status(), host.lease_report(), host.random());
        let heartbeat = self.outbox.begin_heartbeat(&status, lease, random);
        let (number, body) = (heartbeat.number, Box::new(heartbeat.to_bytes()));
        self.link.send(BoothRequest::Heartbeat { number, body });
    }
}
