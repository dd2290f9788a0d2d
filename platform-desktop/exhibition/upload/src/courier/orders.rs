//! The orders of a courier.

use paros_core::badge::BadgeNumber;
use paros_protocol::{CommandOutcome, ContentHash, Parcel, SculptureId, UploadFacts};

/// A finished sculpture: its id, and the hash that identifies it in a saved session.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub struct FinishedSculpture {
    /// The id of the sculpture.
    pub id: SculptureId,
    /// The SHA-256 of its volume's `.rmap`.
    pub volume_hash: ContentHash,
    /// `true` if its parcel is stored in the outbox.
    pub is_kept: bool,
}

/// The content of a parcel to pack.
#[derive(Clone, PartialEq, Debug)]
pub struct ParcelDraft {
    /// The facts, whose lengths are set when the parcel is packed.
    pub facts: UploadFacts,
    /// The volume, an `.rmap`.
    pub volume: Vec<u8>,
    /// The trace, if one is sent.
    pub trace: Option<Vec<u8>>,
}

/// An order to the courier.
#[derive(Debug)]
pub(super) enum CourierOrder {
    /// Announce a finished sculpture.
    Announce { id: SculptureId, volume: Vec<u8> },
    /// Assign a badge to a sculpture.
    TakeBadge { id: SculptureId },
    /// Record the badge that a sculpture's visitor is shown.
    NoteBadge { id: SculptureId, badge: BadgeNumber },
    /// Pack a parcel and store it.
    Keep(Box<ParcelDraft>),
    /// Store a parcel for which another courier found no room.
    KeepParcel(Box<Parcel>),
    /// Give up a sculpture whose parcel won't be made.
    Abandon { id: SculptureId },
    /// Report the outcome of a command.
    CommandDone { id: u64, outcome: CommandOutcome },
}
