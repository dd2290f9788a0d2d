//! What a courier tells, and is told without an order.

use std::collections::VecDeque;

use paros_core::badge::BadgeNumber;
use paros_core::outbox::messages::{CommandKind, HeatLevel, SculptureId};
use paros_core::outbox::{EntryState, HeadsetStatus, Outbox, OutboxEntry, OutboxLevel};
use paros_core::visit::VisitPhase;

/// Badges that wait to be looked at: of the last sculpture, and some that nobody asked for again.
const MAX_BADGES: usize = 8;

/// Sculptures that the booth signed for, and that may be looked at once more.
const MAX_SIGNED: usize = 8;

/// Lines that wait to be told.
const MAX_NOTES: usize = 64;

/// Where a sculpture stands.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Keeping {
    /// Its parcel is being made.
    Making,
    /// Its parcel couldn't be kept, as the disk or the outbox is full. It is tried again.
    Waiting,
    /// *Kept here*: the parcel is on the disk.
    KeptHere,
    /// *Kept here*, and the booth can't take it: the staff must look.
    Refused,
    /// *Kept at the booth*: it signed.
    KeptAtBooth,
    /// It won't come.
    Lost,
}

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
    /// Sculptures that the booth hasn't signed for.
    pub owed: u32,
    /// How full it is.
    pub level: OutboxLevel,
    /// Whether the booth answers.
    pub hears_booth: bool,
    /// Leased badges that could be shown now.
    pub badges_left: u32,
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
    /// Commands with the ends of their lives, in milliseconds.
    pub(super) commands: VecDeque<(RemoteCommand, u64)>,
    pub(super) notes: VecDeque<String>,
    /// Until it answers again.
    pub(super) refused: Option<DeviceRefusal>,
    entries: Vec<OutboxEntry>,
    /// Those whose parcels are being made, or couldn't be kept.
    under_way: Vec<(SculptureId, Keeping)>,
    badges: VecDeque<(SculptureId, BadgeNumber)>,
    /// Sculptures that the booth signed for, with the ids that they had before.
    signed: VecDeque<(SculptureId, Option<SculptureId>)>,
}

/// A headset of which nothing is known yet.
const NO_STATUS: HeadsetStatus = HeadsetStatus {
    session_id: 0,
    is_charging: false,
    is_worn: false,
    is_glowing: false,
    battery_percent: None,
    heat: HeatLevel::Normal,
    phase: VisitPhase::Closed,
    worn_seconds: 0,
    app_version: [0; 3],
};

impl Board {
    pub(super) const fn new() -> Self {
        let level = OutboxLevel::Fine;
        Board {
            summary: CourierSummary { owed: 0, level, hears_booth: false, badges_left: 0 },
            status: NO_STATUS,
            commands: VecDeque::new(),
            notes: VecDeque::new(),
            refused: None,
            entries: Vec::new(),
            under_way: Vec::new(),
            badges: VecDeque::new(),
            signed: VecDeque::new(),
        }
    }

    pub(super) fn note_making(&mut self, id: SculptureId) {
        self.note_under_way(id, Some(Keeping::Making));
    }

    /// Notes where a sculpture stands that the outbox doesn't have whole; `None` once it has.
    pub(super) fn note_under_way(&mut self, id: SculptureId, keeping: Option<Keeping>) {
        self.under_way.retain(|(other, _)| *other != id);
        self.under_way.extend(keeping.map(|keeping| (id, keeping)));
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

    /// Notes that the booth signed for a sculpture, which may leave the outbox at once.
    pub(super) fn note_signed(&mut self, id: SculptureId) {
        self.forget_signed(id);
        let entry = self.entries.iter().find(|entry| entry.id == id);
        self.signed.push_back((id, entry.and_then(|entry| entry.replaced)));
        if self.signed.len() > MAX_SIGNED {
            self.signed.pop_front();
        }
    }

    /// Notes that what the booth signed for isn't known there any more, nor here.
    pub(super) fn forget_signed(&mut self, id: SculptureId) {
        self.signed.retain(|(other, _)| *other != id);
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
    pub(super) fn show(&mut self, outbox: &Outbox, badges_left: u32) {
        // What has no room in the outbox isn't at the booth either.
        let is_outside = |(id, _): &&(SculptureId, Keeping)| outbox.find(*id).is_none();
        let owed = outbox.depth() + self.under_way.iter().filter(is_outside).count();
        self.summary = CourierSummary {
            owed: u32::try_from(owed).unwrap_or(u32::MAX),
            level: outbox.level(),
            hears_booth: outbox.hears_booth(),
            badges_left,
        };
        if self.summary.hears_booth {
            self.refused = None;
        }
        self.entries.clear();
        self.entries.extend_from_slice(outbox.entries());
    }

    /// A sculpture that has another id now is found by its first one, too.
    pub(super) fn keeping(&self, id: SculptureId) -> Option<Keeping> {
        if let Some((_, keeping)) = self.under_way.iter().find(|(other, _)| *other == id) {
            return Some(*keeping);
        }
        let entry = self.entries.iter().find(|entry| entry.id == id || entry.replaced == Some(id));
        let is_it =
            |(new, old): &(SculptureId, Option<SculptureId>)| *new == id || *old == Some(id);
        let signed = || self.signed.iter().any(is_it).then_some(Keeping::KeptAtBooth);
        entry.map(|entry| keeping_of(entry.state)).or_else(signed)
    }
}

pub(super) const fn keeping_of(state: EntryState) -> Keeping {
    match state {
        EntryState::Announced => Keeping::Making,
        EntryState::Kept | EntryState::Sending { .. } => Keeping::KeptHere,
        EntryState::Refused => Keeping::Refused,
        EntryState::Lost => Keeping::Lost,
        EntryState::Receipted { .. } | EntryState::Deletable | EntryState::Gone => {
            Keeping::KeptAtBooth
        }
    }
}
