//! The outbox by what is true of each sculpture: no states, no table of what leads to what, no saved waits.

use paros_core::badge::BadgeNumber;
use paros_core::limits::{
    CONFIRM_MS, MAX_CHUNK_BYTES, MAX_OUTBOX_ENTRIES, MAX_SIGNED_BYTES_PERCENT, MAX_SIGNED_PERCENT,
    MAX_UNASKED_PERCENT,
};
use paros_core::outbox::messages::{
    Announcement, AnnouncementState, ContentHash, Receipt, ReceiptOutcome, SculptureId,
};
use paros_core::outbox::{EntryState, OutboxOwner, OutboxSettings};

/// What is true of a sculpture.
#[derive(Clone, PartialEq, Debug)]
pub struct ModelSculpture {
    /// Its id.
    pub id: SculptureId,
    /// Its badge.
    pub badge: Option<BadgeNumber>,
    /// Hash and length of the parcel, of the last one if it is missing now.
    pub parcel: Option<(ContentHash, u32)>,
    /// Whether that is on the disk.
    pub is_parcel_here: bool,
    /// Whether it will come.
    pub is_lost: bool,
    /// Whether the booth refused it.
    pub is_refused: bool,
    /// Since when; `None` for a start before.
    pub refused_ms: Option<u64>,
    /// What the booth holds, once it was sent.
    pub held: Option<u32>,
    /// What the booth signed, and when.
    pub signed: Option<(ReceiptOutcome, u64)>,
    /// Milliseconds that had passed since the receipt when the program started.
    pub signed_before_ms: u64,
    /// Whether it makes room for others.
    pub makes_room: bool,
    /// Whether the booth is being asked whether it has it.
    pub is_asked: bool,
    /// The id that it gave up.
    pub replaced: Option<SculptureId>,
    /// What the booth noted.
    pub noted: Option<Announcement>,
    /// Requests in a row that came to nothing.
    pub failures: u32,
    /// When the booth last said that it has it, after it signed; `None` in this start.
    pub confirmed_ms: Option<u64>,
    /// Whether the journal on the disk says that the booth signed.
    pub is_signed_on_disk: bool,
}

/// All sculptures, in the order of their coming.
#[derive(Clone, Debug)]
pub struct OutboxModel {
    /// Whose it is.
    pub owner: OutboxOwner,
    /// Seconds that a parcel stays after its receipt.
    pub grace_seconds: u64,
    /// Bytes that all parcels may take together.
    pub max_bytes: u64,
    /// The sculptures.
    pub sculptures: Vec<ModelSculpture>,
    /// Milliseconds of this start.
    pub now_ms: u64,
}

impl ModelSculpture {
    fn new(id: SculptureId, badge: Option<BadgeNumber>) -> Self {
        ModelSculpture {
            id,
            badge,
            parcel: None,
            is_parcel_here: false,
            is_lost: false,
            is_refused: false,
            refused_ms: None,
            held: None,
            signed: None,
            signed_before_ms: 0,
            makes_room: false,
            is_asked: false,
            replaced: None,
            noted: None,
            failures: 0,
            confirmed_ms: None,
            is_signed_on_disk: false,
        }
    }

    /// Whether it waits to be sent, now or later.
    pub fn waits(&self) -> bool {
        self.is_parcel_here && self.signed.is_none()
    }

    fn seconds_since_receipt(&self, now_ms: u64) -> u64 {
        let (_, signed_ms) = self.signed.expect("a receipt");
        self.signed_before_ms / 1000 + now_ms / 1000 - signed_ms / 1000
    }

    /// The state that this is.
    pub fn state(&self, now_ms: u64, grace_seconds: u64) -> EntryState {
        match (self.signed, self.is_lost, self.is_parcel_here) {
            (Some((ReceiptOutcome::Deleted, _)), ..) => EntryState::Deletable,
            (Some(_), ..) if self.makes_room => EntryState::Deletable,
            (Some((ReceiptOutcome::Kept, _)), ..) => match self.seconds_since_receipt(now_ms) {
                seconds if seconds > grace_seconds => EntryState::Deletable,
                seconds => EntryState::Receipted { seconds: seconds as u32 },
            },
            (None, true, _) => EntryState::Lost,
            (None, false, false) => EntryState::Announced,
            (None, false, true) => match (self.is_refused, self.held) {
                (true, _) => EntryState::Refused,
                (false, Some(held)) => EntryState::Sending { held },
                (false, None) => EntryState::Kept,
            },
        }
    }

    /// As it is announced.
    pub fn announcement(&self) -> Option<Announcement> {
        if self.signed.is_some() {
            return None;
        }
        let state = match self.state(0, u64::MAX) {
            EntryState::Announced => AnnouncementState::Announced,
            EntryState::Kept => AnnouncementState::Kept,
            EntryState::Sending { .. } => AnnouncementState::Sending,
            EntryState::Refused => AnnouncementState::Refused,
            _ => AnnouncementState::Lost,
        };
        Some(Announcement { id: self.id, badge: self.badge, state })
    }
}

impl OutboxModel {
    /// Those of which it is asked whether the booth has what it signed for, if there is room.
    pub fn questions(&self) -> impl Iterator<Item = Announcement> {
        let is_due = |sculpture: &&ModelSculpture| {
            let state = sculpture.state(self.now_ms, self.grace_seconds);
            let before = self.now_ms.checked_sub(CONFIRM_MS);
            matches!(state, EntryState::Receipted { .. })
                && sculpture.confirmed_ms.is_none_or(|confirmed| Some(confirmed) <= before)
        };
        self.sculptures.iter().filter(is_due).map(|sculpture| Announcement {
            id: sculpture.id,
            badge: sculpture.badge,
            state: AnnouncementState::SignedFor,
        })
    }

    /// The booth says whether it has what it signed for.
    pub fn note_question(&mut self, id: SculptureId, has_it: bool) {
        let now_ms = self.now_ms;
        let Some(sculpture) = self.at(id) else { return };
        sculpture.is_asked = false;
        if has_it {
            sculpture.confirmed_ms = Some(now_ms);
        } else {
            (sculpture.signed, sculpture.signed_before_ms, sculpture.held) = (None, 0, None);
            (sculpture.is_refused, sculpture.refused_ms) = (false, None);
            sculpture.is_signed_on_disk = false;
        }
    }

    /// The model of an empty outbox.
    pub fn new(owner: OutboxOwner, settings: OutboxSettings) -> Self {
        let (grace_seconds, max_bytes) = (u64::from(settings.grace_seconds), settings.max_bytes);
        OutboxModel { owner, grace_seconds, max_bytes, sculptures: Vec::new(), now_ms: 0 }
    }

    /// Time passes.
    pub fn pass_time(&mut self, ms: u64) {
        self.now_ms += ms;
        let (now_ms, grace) = (self.now_ms, self.grace_seconds);
        let [wanted, last] = [
            [MAX_SIGNED_PERCENT, MAX_SIGNED_BYTES_PERCENT],
            [MAX_UNASKED_PERCENT, MAX_UNASKED_PERCENT],
        ];
        // Who may leave changes with each that does: from the oldest on again.
        while self.is_beyond(wanted) {
            let is_short = self.is_beyond(last);
            let leaves = self.sculptures.iter_mut().find(|sculpture| {
                let is_known_there = sculpture.confirmed_ms.is_some() && !sculpture.is_asked;
                let state = sculpture.state(now_ms, grace);
                matches!(state, EntryState::Receipted { .. }) && (is_known_there || is_short)
            });
            let Some(sculpture) = leaves else { return };
            sculpture.makes_room = true;
        }
    }

    /// Whether what isn't to be deleted takes more than so many percent of the table or of the bytes.
    fn is_beyond(&self, percents: [u8; 2]) -> bool {
        let stays = |sculpture: &&ModelSculpture| {
            sculpture.state(self.now_ms, self.grace_seconds) != EntryState::Deletable
        };
        let staying = self.sculptures.iter().filter(stays);
        let bytes_here = staying.clone().filter(|sculpture| sculpture.is_parcel_here);
        let bytes: u64 = bytes_here.map(|here| u64::from(here.parcel.expect("it is here").1)).sum();
        let parts = [(staying.count() as u64, MAX_OUTBOX_ENTRIES as u64), (bytes, self.max_bytes)];
        // Whole percents count.
        let is_beyond = |((taken, all), percent): ((u64, u64), u8)| {
            taken * 100 >= all * (u64::from(percent) + 1)
        };
        parts.into_iter().zip(percents).any(is_beyond)
    }

    fn at(&mut self, id: SculptureId) -> Option<&mut ModelSculpture> {
        self.sculptures.iter_mut().find(|sculpture| sculpture.id == id)
    }

    fn is_given_up(&self, id: SculptureId) -> bool {
        self.sculptures.iter().any(|sculpture| sculpture.replaced == Some(id))
    }

    /// Each returns whether it is done.
    pub fn announce(&mut self, id: SculptureId, badge: Option<BadgeNumber>) -> bool {
        let is_known = self.at(id).is_some() || self.is_given_up(id);
        let is_done = !is_known && self.sculptures.len() < MAX_OUTBOX_ENTRIES;
        if is_done {
            self.sculptures.push(ModelSculpture::new(id, badge));
        }
        is_done
    }

    /// A parcel is on the disk.
    pub fn keep(
        &mut self,
        id: SculptureId,
        badge: Option<BadgeNumber>,
        hash: ContentHash,
        bytes: u32,
    ) -> bool {
        if self.at(id).is_none() && !self.announce(id, badge) {
            return false;
        }
        let sculpture = self.at(id).expect("it is there now");
        if sculpture.is_parcel_here {
            return false;
        }
        let (replaced, noted) = (sculpture.replaced, sculpture.noted);
        *sculpture = ModelSculpture { replaced, noted, ..ModelSculpture::new(id, badge) };
        (sculpture.parcel, sculpture.is_parcel_here) = (Some((hash, bytes)), true);
        true
    }

    /// A parcel isn't there, or never was.
    pub fn lose(&mut self, id: SculptureId) -> bool {
        let Some(sculpture) = self.at(id).filter(|sculpture| !sculpture.is_lost) else {
            return false;
        };
        if sculpture.signed.is_some() {
            self.sculptures.retain(|sculpture| sculpture.id != id);
            return true;
        }
        sculpture.is_lost = true;
        sculpture.is_parcel_here = false;
        true
    }

    /// The booth signed.
    pub fn sign(&mut self, receipt: &Receipt) -> bool {
        let (owner, now_ms) = (self.owner, self.now_ms);
        let Some(sculpture) = self.at(receipt.id) else { return false };
        let is_own = (receipt.site, receipt.headset) == (owner.site, owner.headset);
        let is_same = sculpture.parcel.is_some_and(|(hash, _)| hash == receipt.hash)
            && sculpture.badge == receipt.badge;
        let is_done = is_own && is_same && sculpture.waits();
        if is_done {
            sculpture.signed = Some((receipt.outcome, now_ms));
            (sculpture.confirmed_ms, sculpture.is_asked) = (Some(now_ms), false);
        }
        is_done
    }

    /// A sculpture goes on under another id.
    pub fn renew(&mut self, old: SculptureId, new: SculptureId, hash: ContentHash) -> bool {
        let Some(sculpture) = self.at(old).filter(|old| old.waits()).cloned() else { return false };
        if old == new {
            return false;
        }
        let is_later = |other: &ModelSculpture| {
            other.replaced == Some(new) && (other.is_parcel_here || other.signed.is_some())
        };
        if self.sculptures.iter().any(is_later) {
            self.delete(old);
            return true;
        }
        let lost = self.sculptures.iter_mut().filter(|other| other.replaced == Some(new));
        lost.for_each(|other| other.replaced = None);
        let (_, bytes) = sculpture.parcel.expect("it waits");
        if self.at(new).is_some() {
            self.keep(new, sculpture.badge, hash, bytes);
            self.sculptures.retain(|sculpture| sculpture.id != old);
            self.at(new).expect("it stays").replaced = Some(old);
        } else {
            *self.at(old).expect("it is there") = ModelSculpture {
                parcel: Some((hash, bytes)),
                is_parcel_here: true,
                replaced: Some(old),
                ..ModelSculpture::new(new, sculpture.badge)
            };
        }
        true
    }

    /// The journal is on the disk as it is.
    pub fn note_journal_written(&mut self) {
        for sculpture in &mut self.sculptures {
            sculpture.is_signed_on_disk = sculpture.signed.is_some();
        }
    }

    /// Parcels that may be deleted now.
    pub fn list_parcels_to_delete(&self) -> Vec<SculptureId> {
        let may_be = |sculpture: &&ModelSculpture| {
            sculpture.is_signed_on_disk
                && sculpture.state(self.now_ms, self.grace_seconds) == EntryState::Deletable
        };
        self.sculptures.iter().filter(may_be).map(|sculpture| sculpture.id).collect()
    }

    /// The deletable parcel is gone.
    pub fn delete(&mut self, id: SculptureId) {
        self.sculptures.retain(|sculpture| sculpture.id != id);
    }

    /// What would be sent: of those that failed least the newest, and its part.
    pub fn next_upload(
        &self,
        may_retry: impl Fn(&ModelSculpture) -> bool,
    ) -> Option<(SculptureId, u32, u32)> {
        let mut best: Option<&ModelSculpture> = None;
        for sculpture in self.sculptures.iter().filter(|sculpture| sculpture.waits()) {
            let is_ready = !sculpture.is_refused || may_retry(sculpture);
            if is_ready && best.is_none_or(|best| sculpture.failures <= best.failures) {
                best = Some(sculpture);
            }
        }
        let (_, bytes) = best?.parcel.expect("it waits");
        let offset = best?.held.unwrap_or(0);
        Some((best?.id, offset, (bytes - offset).min(MAX_CHUNK_BYTES)))
    }

    /// A request was made.
    pub fn note_sent(&mut self, id: SculptureId) {
        let sculpture = self.at(id).expect("it was chosen");
        (sculpture.is_refused, sculpture.refused_ms) = (false, None);
        sculpture.held = sculpture.held.or(Some(0));
    }

    /// What the booth said of a request's sculpture, if it still waits.
    pub fn note_answer(&mut self, id: SculptureId, change: impl FnOnce(&mut ModelSculpture)) {
        if let Some(sculpture) = self.at(id) {
            change(sculpture);
        }
    }

    /// The booth noted an announcement.
    pub fn note(&mut self, noted: &Announcement) {
        let Some(sculpture) = self.at(noted.id) else { return };
        if sculpture.announcement() == Some(*noted) {
            sculpture.noted = Some(*noted);
            if sculpture.is_lost {
                self.delete(noted.id);
            }
        }
    }

    /// The program starts again, from what the journal said.
    pub fn restart(&mut self) {
        for sculpture in &mut self.sculptures {
            (sculpture.confirmed_ms, sculpture.is_asked) = (None, false);
            if sculpture.signed.is_some() {
                // Whole seconds are kept.
                sculpture.signed_before_ms = sculpture.seconds_since_receipt(self.now_ms) * 1000;
            }
            sculpture.refused_ms = None;
            sculpture.signed = sculpture.signed.map(|(outcome, _)| (outcome, 0));
            (sculpture.held, sculpture.noted, sculpture.failures) = (None, None, 0);
        }
        self.now_ms = 0;
    }
}
