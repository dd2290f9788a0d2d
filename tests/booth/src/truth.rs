//! What really happened, as nobody in the exhibition knows it.

use std::collections::{BTreeMap, BTreeSet};

use paros_core::badge::BadgeNumber;
use paros_core::session::SessionMode;
use paros_protocol::{AgeGroup, BlockSerial, CommandKind, FinishCause, SculptureId, UploadFacts};

/// A sculpture that somebody made.
#[derive(Clone, Debug)]
pub struct Made {
    /// In which headset.
    pub headset: usize,
    /// Its id.
    pub id: SculptureId,
    /// Its badge.
    pub badge: Option<BadgeNumber>,
    /// The serial of its badge's block.
    pub serial: Option<BlockSerial>,
    /// Whether its visitor read *kept here*.
    pub was_kept_here: bool,
    /// Whether its visitor read *kept at the booth*.
    pub was_signed: bool,
    /// Whether the staff deleted it.
    pub was_deleted: bool,
    /// Whether it may be lost: the headset was wiped, or its file rotted.
    pub is_excused: bool,
    /// Whether the booth can't read it.
    pub is_poison: bool,
    /// Whether a thief's parcel came under its id before.
    pub is_stolen: bool,
}

impl Made {
    /// One that its visitor has just finished.
    pub const fn new(headset: usize, id: SculptureId, badge: Option<BadgeNumber>) -> Self {
        Made {
            headset,
            id,
            badge,
            serial: None,
            was_kept_here: false,
            was_signed: false,
            was_deleted: false,
            is_excused: false,
            is_poison: false,
            is_stolen: false,
        }
    }
}

/// A command that the staff gave.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// When.
    pub asked_ms: u64,
    /// What.
    pub kind: CommandKind,
    /// For which visit.
    pub session_id: u64,
    /// For which start.
    pub boot_id: u64,
    /// How often it was carried out.
    pub done: u32,
}

/// All of it.
#[derive(Debug, Default)]
pub struct Truth {
    /// The sculptures, by number.
    pub made: Vec<Made>,
    /// Ids that the booth said it had noted.
    pub noted: BTreeSet<(u32, SculptureId)>,
    /// Commands by headset and id.
    pub commands: BTreeMap<(usize, u64), Asked>,
    /// Sculptures of which a headset heard that the booth has them.
    pub heard: u32,
    /// Ids that a thief took.
    pub stolen: u32,
    /// How often the booth came back from a backup.
    pub restores: u32,
    /// Sculptures that the booth lost by that, and that it has to get again.
    pub to_return: u32,
}

impl Truth {
    /// The number of the sculpture that has an id.
    pub fn number_of(&self, id: SculptureId) -> Option<usize> {
        self.made.iter().position(|made| made.id == id)
    }

    /// The sculpture that has an id.
    pub fn find(&mut self, id: SculptureId) -> Option<&mut Made> {
        self.made.iter_mut().find(|made| made.id == id)
    }
}

/// The height of a sculpture's print in tenths of a millimetre, and that of one that the booth is to find undecodable.
const HEIGHT: u16 = 1200;
const POISON_HEIGHT: u16 = 1201;

/// The number of the sculpture with such facts, whatever its id is: nobody looks at how long it took.
#[must_use]
pub const fn number_of_facts(facts: &UploadFacts) -> usize {
    facts.sculpting_seconds as usize
}

/// Whether the booth is to find it undecodable.
#[must_use]
pub const fn is_poison(facts: &UploadFacts) -> bool {
    facts.height_mm_tenths == POISON_HEIGHT
}

/// Facts of a sculpture.
#[must_use]
pub fn facts_of(number: usize, made: &Made) -> UploadFacts {
    UploadFacts {
        id: made.id,
        badge: made.badge,
        badge_serial: made.serial,
        core_version: 1,
        side: 128,
        cause: FinishCause::Finished,
        language: *b"el",
        mode: SessionMode::FreeForm,
        age_group: AgeGroup::Unknown,
        sculpting_seconds: number as u32,
        finished_at: 1_790_000_000,
        height_mm_tenths: if made.is_poison { POISON_HEIGHT } else { HEIGHT },
        volume_bytes: 0,
        volume_raw_bytes: 0,
        trace_bytes: 0,
        trace_raw_bytes: 0,
    }
}
