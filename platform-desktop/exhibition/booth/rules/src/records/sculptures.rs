//! Sculptures, and the tombstones of deleted sculptures.

use paros_core::badge::{BadgeNumber, Language};
use paros_core::session::SessionMode;

use crate::record::record;
use crate::time::BoothTime;
use crate::value::stored_enum;

stored_enum! {
    /// The state of a sculpture's mesh at the booth.
    pub enum ExportState {
        /// The mesh wasn't checked yet.
        Queued = 0,
        /// A closed mesh can be made.
        Made = 1,
        /// No mesh can be made, or the mesh isn't closed or has an absurd size.
        Failed = 2,
    }
}

record! {
    /// A kept sculpture.
    pub struct Sculpture in "sculptures", key 1 {
        /// The random id.
        pub id: [u8; 16],
        /// The headset that made it.
        pub headset: u32,
        /// The SHA-256 of its parcel.
        pub hash: [u8; 32],
        /// The number of its badge, if its visitor was shown a badge.
        pub badge: Option<u32>,
        /// The same number if the sculpture owns the badge: it was leased to the sending headset, and no
        /// other kept sculpture has claimed it.
        pub claimed_badge: Option<u32>,
        /// The pictures of its badge, as a bit set by pictogram number; 0 without a badge.
        pub pictures: u64,
        /// The visit's language, two small letters of ISO 639-1.
        pub language: [u8; 2],
        /// The start of its session.
        pub mode: SessionMode,
        /// The bytes of its `UploadFacts`.
        pub facts: Vec<u8>,
        /// The time when the whole parcel had arrived.
        pub received_at: BoothTime,
        /// The last day on which it is kept.
        pub keep_day: u32,
        /// The time of the withdrawal.
        pub withdrawn_at: Option<BoothTime>,
        /// `true` if its trace is stored.
        pub has_trace: bool,
        /// The state of its mesh.
        pub export: ExportState,
        /// The generation of the valid visitor's link. Links of other generations are void.
        pub link_generation: u32,
        /// `true` if the visitor's link was revoked.
        pub is_link_revoked: bool,
    }
}

record! {
    /// The tombstone of a deleted sculpture.
    pub struct Tombstone in "tombstones", key 1 {
        /// The id of the sculpture.
        pub id: [u8; 16],
        /// The headset that made it.
        pub headset: u32,
        /// The SHA-256 of its parcel.
        pub hash: [u8; 32],
        /// The number of its badge, if its visitor was shown a badge.
        pub badge: Option<u32>,
        /// The time of the deletion.
        pub deleted_at: BoothTime,
        /// The first day on which no headset can still have the sculpture.
        pub ends_on: u32,
        /// `true` if its files are still to be removed.
        pub has_files: bool,
    }
}

impl Sculpture {
    /// `true` if the sculpture has a leased badge that it doesn't own, or no longer owns. Staff find it by
    /// picture and time.
    #[must_use]
    pub fn is_badge_lapsed(&self) -> bool {
        let badge = self.badge.and_then(BadgeNumber::new);
        self.claimed_badge.is_none() && badge.is_some_and(|badge| !badge.is_provisional())
    }

    /// Returns the language of the visit, or English if the booth has no texts in that language.
    #[must_use]
    pub fn visit_language(&self) -> Language {
        if &self.language == b"el" { Language::Greek } else { Language::English }
    }
}
