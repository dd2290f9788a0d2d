//! The ground truth of an exhibition, which no simulated party can see.

use std::collections::{BTreeMap, BTreeSet};

use paros_core::badge::BadgeNumber;
use paros_core::session::SessionMode;
use paros_protocol::{AgeGroup, BlockSerial, CommandKind, FinishCause, SculptureId, UploadFacts};

/// A finished sculpture.
#[derive(Clone, Debug)]
pub struct Made {
    /// The index of its headset.
    pub headset: usize,
    /// Its id.
    pub id: SculptureId,
    /// Its badge.
    pub badge: Option<BadgeNumber>,
    /// The serial of its badge's block.
    pub serial: Option<BlockSerial>,
    /// `true` if its visitor read *kept here*.
    pub was_kept_here: bool,
    /// `true` if its visitor read *kept at the booth*.
    pub was_signed: bool,
    /// `true` if the staff deleted it.
    pub was_deleted: bool,
    /// `true` if it may be lost: the headset was wiped, or its file was corrupted.
    pub is_excused: bool,
    /// `true` if the booth can't decode it.
    pub is_poison: bool,
    /// `true` if a thief's parcel arrived under its id first.
    pub is_stolen: bool,
}

impl Made {
    /// Creates a sculpture that its visitor has just finished.
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

/// A command given by the staff.
#[derive(Clone, Copy, Debug)]
pub struct Asked {
    /// When it was given, in milliseconds.
    pub asked_ms: u64,
    /// The command.
    pub kind: CommandKind,
    /// The id of the visit that it is meant for.
    pub session_id: u64,
    /// The id of the start that it is meant for.
    pub boot_id: u64,
    /// Number of times that it was carried out.
    pub done: u32,
}

/// The ground truth of an exhibition.
#[derive(Debug, Default)]
pub struct Truth {
    /// The sculptures, by number.
    pub made: Vec<Made>,
    /// Ids that the booth acknowledged as announced.
    pub noted: BTreeSet<(u32, SculptureId)>,
    /// Commands by headset and id.
    pub commands: BTreeMap<(usize, u64), Asked>,
    /// Number of sculptures that a headset knows to be at the booth.
    pub heard: u32,
    /// Number of ids that a thief took.
    pub stolen: u32,
    /// Number of restores from a backup.
    pub restores: u32,
    /// Number of sculptures that the booth lost in a restore and has to receive again.
    pub to_return: u32,
}

impl Truth {
    /// Returns the number of the sculpture with an id.
    pub fn number_of(&self, id: SculptureId) -> Option<usize> {
        self.made.iter().position(|made| made.id == id)
    }

    /// Returns the sculpture with an id.
    pub fn find(&mut self, id: SculptureId) -> Option<&mut Made> {
        self.made.iter_mut().find(|made| made.id == id)
    }
}

/// The height of a print in tenths of a millimetre, and the height that marks an undecodable sculpture.
const HEIGHT: u16 = 1200;
const POISON_HEIGHT: u16 = 1201;

/// Returns the number of a sculpture by its facts, whatever its id is. The unused field `sculpting_seconds`
/// carries the number.
#[must_use]
pub const fn number_of_facts(facts: &UploadFacts) -> usize {
    facts.sculpting_seconds as usize
}

/// Returns `true` if the booth is to treat the sculpture as undecodable.
#[must_use]
pub const fn is_poison(facts: &UploadFacts) -> bool {
    facts.height_mm_tenths == POISON_HEIGHT
}

/// Returns the facts of a sculpture.
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
