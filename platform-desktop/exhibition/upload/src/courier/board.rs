//! What a courier tells, and is told without an order.

use std::collections::VecDeque;

use paros_core::badge::BadgeNumber;
use paros_protocol::{CommandKind, HeadsetStatus, SculptureId, UploadStatus};

use super::CourierLink;
use crate::folder::DiskFolder;
use crate::sender::Sender;
use crate::spool::OutboxLevel;

/// Badges that wait to be looked at: of the last sculpture, and some that nobody asked for again.
const MAX_BADGES: usize = 8;

/// Sent sculptures whose status may be looked at after they left the spool.
const MAX_SENT: usize = 8;

/// Lines that wait to be told.
const MAX_NOTES: usize = 64;

/// Why the booth answers a device nothing else.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum DeviceRefusal {
    /// It doesn't know it.
    Forgotten,
    /// Staff shut it out.
    ShutOut,
}

/// What is to be told of an outbox.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct CourierSummary {
    /// Sculptures that the booth doesn't have.
    pub owed: u32,
    /// How full it is.
    pub level: OutboxLevel,
    /// Whether the booth answers.
    pub hears_booth: bool,
    /// Leased badges that are left.
    pub badges_left: u32,
}

/// The state of the last finished sculpture on its way to the booth.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct BoothState {
    /// The sculpture's id; `None` before there is one.
    pub id: Option<SculptureId>,
    /// The badge that it is to have, once that may be shown.
    pub badge: Option<BadgeNumber>,
    /// The status of its upload; `None` before there is one.
    pub status: Option<UploadStatus>,
    /// The whole outbox.
    pub outbox: CourierSummary,
}

/// A command of the booth's, to be carried out in its visit alone.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct RemoteCommand {
    /// Of the booth's command.
    pub id: u64,
    /// What is asked.
    pub kind: CommandKind,
    /// The visit that was under way as it came.
    pub session_id: u64,
}

/// The board.
#[derive(Debug)]
pub(super) struct Board {
    pub(super) summary: CourierSummary,
    pub(super) status: HeadsetStatus,
    /// The sculpture that was finished last.
    pub(super) last: Option<SculptureId>,
    /// Commands with the ends of their lives, in milliseconds.
    pub(super) commands: VecDeque<(RemoteCommand, u64)>,
    pub(super) notes: VecDeque<String>,
    /// Until it answers again.
    pub(super) refused: Option<DeviceRefusal>,
    /// The spool's sculptures.
    spooled: Vec<(SculptureId, UploadStatus)>,
    /// Sculptures whose parcels are being made, or couldn't be kept.
    under_way: Vec<(SculptureId, UploadStatus)>,
    badges: VecDeque<(SculptureId, BadgeNumber)>,
    /// Sculptures that the booth has, which may have left the spool.
    sent: VecDeque<SculptureId>,
}

impl Board {
    pub(super) fn new() -> Self {
        let level = OutboxLevel::Fine;
        Board {
            summary: CourierSummary { owed: 0, level, hears_booth: false, badges_left: 0 },
            status: HeadsetStatus::default(),
            last: None,
            commands: VecDeque::new(),
            notes: VecDeque::new(),
            refused: None,
            spooled: Vec::new(),
            under_way: Vec::new(),
            badges: VecDeque::new(),
            sent: VecDeque::new(),
        }
    }

    pub(super) fn note_making(&mut self, id: SculptureId) {
        self.note_under_way(id, Some(UploadStatus::Making));
    }

    /// Notes where a sculpture stands that the outbox doesn't have whole; `None` once it has.
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

    /// Notes that the booth has a sculpture, which may leave the spool at once.
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

    /// Notes that the booth refuses this device. That it does is told once until it answers again, however often it is
    /// asked.
    pub(super) fn note_refused(&mut self, refused: DeviceRefusal) {
        if self.refused.replace(refused) != Some(refused) {
            self.add_note(match refused {
                DeviceRefusal::Forgotten => {
                    "the booth doesn't know this device: it must be enrolled anew".into()
                }
                DeviceRefusal::ShutOut => "the booth's staff have shut this device out".into(),
            });
        }
    }

    /// Takes the outbox as it is.
    pub(super) fn show(&mut self, sender: &Sender<DiskFolder, CourierLink>) {
        let spool = sender.spool();
        // What has no room in the spool isn't at the booth either.
        let is_outside = |(id, _): &&(SculptureId, UploadStatus)| spool.find(*id).is_none();
        let owed = spool.depth() + self.under_way.iter().filter(is_outside).count();
        self.summary = CourierSummary {
            owed: u32::try_from(owed).unwrap_or(u32::MAX),
            level: spool.level(),
            hears_booth: sender.hears_booth(),
            badges_left: sender.badges_left(),
        };
        if self.summary.hears_booth {
            self.refused = None;
        }
        self.spooled.clear();
        self.spooled.extend(spool.entries().iter().map(|entry| (entry.id, entry.status)));
    }

    /// Where a sculpture stands; `None` where nothing is known of it.
    pub(super) fn status_of(&self, id: SculptureId) -> Option<UploadStatus> {
        let known = self.under_way.iter().chain(&self.spooled);
        let status = known.clone().find(|(other, _)| *other == id).map(|(_, status)| *status);
        status.or(self.sent.contains(&id).then_some(UploadStatus::Sent))
    }
}
