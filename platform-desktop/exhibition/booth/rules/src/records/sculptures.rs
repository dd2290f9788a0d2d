//! Sculptures, and what is left of those that were deleted.

use paros_core::badge::{BadgeNumber, Language};
use paros_core::session::SessionMode;

use crate::record::record;
use crate::time::BoothTime;
use crate::value::stored_enum;

stored_enum! {
    /// The state of a sculpture's mesh at the booth.
    pub enum ExportState {
        /// It wasn't tried yet.
        Queued = 0,
        /// It can, and the mesh is closed.
        Made = 1,
        /// It can't make one, or one that isn't closed or of a sane size.
        Failed = 2,
    }
}

record! {
    /// A sculpture that is kept.
    pub struct Sculpture in "sculptures", key 1 {
        /// Its random id.
        pub id: [u8; 16],
        /// Who made it.
        pub headset: u32,
        /// SHA-256 of the parcel that it came in.
        pub hash: [u8; 32],
        /// The number of its badge, if its visitor was shown one.
        pub badge: Option<u32>,
        /// The same number if the badge is its own: it was leased to the headset that sent it, and no other sculpture that is
        /// kept has it.
        pub claimed_badge: Option<u32>,
        /// The pictures of its badge, a bit for each pictogram's number: none without a badge.
        pub pictures: u64,
        /// The visit's language, two small letters of ISO 639-1.
        pub language: [u8; 2],
        /// The start of its session.
        pub mode: SessionMode,
        /// `UploadFacts`, as they came.
        pub facts: Vec<u8>,
        /// When it was whole.
        pub received_at: BoothTime,
        /// The last day on which it is kept.
        pub keep_day: u32,
        /// When it was withdrawn.
        pub withdrawn_at: Option<BoothTime>,
        /// Whether the trace that came with it is here.
        pub has_trace: bool,
        /// What the booth makes of it.
        pub export: ExportState,
        /// Which of its visitor's links is the valid one.
        pub link_generation: u32,
        /// Whether that one was taken back.
        pub is_link_revoked: bool,
    }
}

record! {
    /// A sculpture that was deleted.
    pub struct Tombstone in "tombstones", key 1 {
        /// Its id.
        pub id: [u8; 16],
        /// Who made it.
        pub headset: u32,
        /// Of the parcel that it came in.
        pub hash: [u8; 32],
        /// The number of its badge, if its visitor was shown one.
        pub badge: Option<u32>,
        /// When it was deleted.
        pub deleted_at: BoothTime,
        /// The first day on which no headset can have it any more.
        pub ends_on: u32,
        /// Whether its files are yet to be removed.
        pub has_files: bool,
    }
}

impl Sculpture {
    /// `true` if it has a leased badge that isn't its own, or isn't any more: it is found by its picture and its hour.
    #[must_use]
    pub fn is_badge_lapsed(&self) -> bool {
        let badge = self.badge.and_then(BadgeNumber::new);
        self.claimed_badge.is_none() && badge.is_some_and(|badge| !badge.is_provisional())
    }

    /// The language that its visitor chose, if the booth has texts in that; else English.
    #[must_use]
    pub fn visit_language(&self) -> Language {
        if &self.language == b"el" { Language::Greek } else { Language::English }
    }
}
