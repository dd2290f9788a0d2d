//! What a courier is told to do.

use paros_core::badge::BadgeNumber;
use paros_protocol::{CommandOutcome, ContentHash, Parcel, SculptureId, UploadFacts};

/// A sculpture that was finished: its id, and by what it is found again in a saved session.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FinishedSculpture {
    /// Its id.
    pub id: SculptureId,
    /// SHA-256 of its volume's `.rmap`.
    pub volume_hash: ContentHash,
    /// Whether its parcel was kept.
    pub is_kept: bool,
}

/// What a parcel is packed of.
#[derive(Clone, PartialEq, Debug)]
pub struct ParcelDraft {
    /// Its facts, but for the lengths.
    pub facts: UploadFacts,
    /// The volume, an `.rmap`.
    pub volume: Vec<u8>,
    /// The trace, where one is sent.
    pub trace: Option<Vec<u8>>,
}

/// An order.
#[derive(Debug)]
pub(super) enum CourierOrder {
    /// A sculpture is finished.
    Announce { id: SculptureId, volume: Vec<u8> },
    /// It is to have a badge.
    TakeBadge { id: SculptureId },
    /// It has this one.
    NoteBadge { id: SculptureId, badge: BadgeNumber },
    /// Its parcel is to be kept.
    Keep(Box<ParcelDraft>),
    /// It is made, and another courier found no room for it.
    KeepParcel(Box<Parcel>),
    /// It won't be made.
    Abandon { id: SculptureId },
    /// What came of a command.
    CommandDone { id: u64, outcome: CommandOutcome },
}
