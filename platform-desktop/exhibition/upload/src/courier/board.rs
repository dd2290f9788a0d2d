//! The board: state that a courier and its owner share.

use std::collections::VecDeque;

use paros_core::badge::BadgeNumber;
use paros_protocol::{HeadsetStatus, SculptureId, UploadStatus};

use super::CourierLink;
use crate::events::{BoothContact, RemoteCommand};
use crate::folder::DiskFolder;
use crate::sender::Sender;

/// Largest number of badges on the board: of the last sculpture, and some that weren't requested again.
const MAX_BADGES: usize = 8;

/// Largest number of sent sculptures whose status stays visible after they left the spool.
const MAX_SENT: usize = 8;

/// Largest number of waiting messages.
const MAX_NOTES: usize = 64;

/// The state of an outbox.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct CourierSummary {
    /// Sculptures that the booth doesn't have.
    pub owed: u32,
    /// `true` if the outbox is nearly full with these sculptures.
    pub is_nearly_full: bool,
    /// The booth's response to this device.
    pub contact: BoothContact,
}

/// The state of the last finished sculpture on its way to the booth.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BoothState {
    /// The sculpture's id; `None` before there is one.
    pub id: Option<SculptureId>,
    /// The badge of the sculpture, once it may be shown.
    pub badge: Option<BadgeNumber>,
    /// The status of its upload; `None` before there is one.
    pub status: Option<UploadStatus>,
    /// The state of the whole outbox.
    pub outbox: CourierSummary,
}

/// The state that a courier and its owner share.
#[derive(Debug)]
pub(super) struct Board {
    pub(super) summary: CourierSummary,
    pub(super) status: HeadsetStatus,
    /// The last finished sculpture.
    pub(super) last: Option<SculptureId>,
    /// Commands with the ends of their lives in milliseconds.
    pub(super) commands: VecDeque<(RemoteCommand, u64)>,
    pub(super) notes: VecDeque<String>,
    /// The sculptures of the spool.
    spooled: Vec<(SculptureId, UploadStatus)>,
    /// The sculptures whose parcels are being made, or couldn't be stored.
    under_way: Vec<(SculptureId, UploadStatus)>,
    badges: VecDeque<(SculptureId, BadgeNumber)>,
    /// The sculptures that the booth has, which may have left the spool.
    sent: VecDeque<SculptureId>,
}

impl Board {
    pub(super) fn new() -> Self {
        let contact = BoothContact::Silent;
        Board {
            summary: CourierSummary { owed: 0, is_nearly_full: false, contact },
            status: HeadsetStatus::default(),
            last: None,
            commands: VecDeque::new(),
            notes: VecDeque::new(),
            spooled: Vec::new(),
            under_way: Vec::new(),
            badges: VecDeque::new(),
            sent: VecDeque::new(),
        }
    }

    pub(super) fn note_making(&mut self, id: SculptureId) {
        self.note_under_way(id, Some(UploadStatus::Making));
    }

    /// Sets the status of a sculpture that isn't stored in the outbox yet; `None` once it is stored.
    pub(super) fn note_under_way(&mut self, id: SculptureId, status: Option<UploadStatus>) {
        self.under_way.retain(|(other, _)| *other != id);
        self.under_way.extend(status.map(|status| (id, status)));
    }

    pub(super) fn badge_of(&self, id: SculptureId) -> Option<BadgeNumber> {
        self.badges.iter().find(|(other, _)| *other == id).map(|(_, badge)| *badge)
    }

    pub(super) fn add_badge(&mut self, id: SculptureId, badge: BadgeNumber) {
        self.badges.push_back((id, badge));
        if self.badges.len() > MAX_BADGES {
            self.badges.pop_front();
        }
    }

    /// Records that the booth has a sculpture, which may leave the spool at once.
    pub(super) fn note_sent(&mut self, id: SculptureId) {
        self.sent.retain(|other| *other != id);
        self.sent.push_back(id);
        if self.sent.len() > MAX_SENT {
            self.sent.pop_front();
        }
    }

    pub(super) fn add_note(&mut self, note: String) {
        if self.notes.len() < MAX_NOTES && self.notes.back() != Some(&note) {
            self.notes.push_back(note);
        }
    }

    /// Records how the booth responds. Adds one message when the booth starts to refuse this device.
    fn note_contact(&mut self, contact: BoothContact) {
        let before = std::mem::replace(&mut self.summary.contact, contact);
        let note = match contact {
            BoothContact::Forgotten => {
                "the booth doesn't know this device: it must be enrolled anew"
            }
            BoothContact::ShutOut => "the booth's staff have shut this device out",
            BoothContact::Silent | BoothContact::Open => return,
        };
        if before != contact {
            self.add_note(note.into());
        }
    }

    /// Publishes the state of the outbox.
    pub(super) fn show(&mut self, sender: &Sender<DiskFolder, CourierLink>) {
        let spool = sender.spool();
        // A parcel without room in the spool isn't at the booth either.
        let is_outside = |(id, _): &&(SculptureId, UploadStatus)| spool.find(*id).is_none();
        let owed = spool.depth() + self.under_way.iter().filter(is_outside).count();
        self.summary.owed = u32::try_from(owed).unwrap_or(u32::MAX);
        self.summary.is_nearly_full = spool.is_nearly_full();
        self.note_contact(sender.contact());
        self.spooled.clear();
        self.spooled.extend(spool.entries().iter().map(|entry| (entry.id, entry.status)));
    }

    /// Returns the status of a sculpture; `None` if it is unknown.
    pub(super) fn status_of(&self, id: SculptureId) -> Option<UploadStatus> {
        let known = self.under_way.iter().chain(&self.spooled);
        let status = known.clone().find(|(other, _)| *other == id).map(|(_, status)| *status);
        status.or(self.sent.contains(&id).then_some(UploadStatus::Sent))
    }
}
