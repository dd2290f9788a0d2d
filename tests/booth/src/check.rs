//! The invariants of an exhibition.

use std::collections::{BTreeMap, BTreeSet};

use paros_core::badge::BadgeNumber;
use paros_protocol::{SculptureId, UploadFacts, UploadStatus};

use crate::exhibition::Exhibition;
use crate::headset::SimHeadset;
use crate::truth::number_of_facts;

/// The booth's contents.
struct Kept {
    /// Numbers of stored sculptures.
    numbers: BTreeSet<usize>,
    /// Ids of sculptures that are stored or were deleted.
    settled: BTreeSet<SculptureId>,
}

/// Checks all invariants.
///
/// # Panics
/// An invariant is violated.
pub fn check(exhibition: &Exhibition) {
    let kept = check_booth(exhibition);
    let here = list_here(exhibition);
    for (number, made) in exhibition.truth.made.iter().enumerate() {
        let is_at_booth = kept.numbers.contains(&number) || made.was_deleted;
        if made.was_signed {
            assert!(is_at_booth, "{number}: what the booth took is lost: {made:?}");
        } else if made.was_kept_here && !made.is_excused && !is_at_booth {
            assert!(
                here[made.headset].contains(&number),
                "{number}: what was kept here is lost: {made:?}"
            );
        }
    }
    let missing: BTreeSet<_> = exhibition.booth.list_missing().into_iter().collect();
    for (headset, id) in &exhibition.truth.noted {
        let is_listed = missing.contains(&(*headset, id.0)) || kept.settled.contains(id);
        assert!(is_listed, "{id}: it was announced, and is neither kept nor missed");
    }
}

/// Lists the sculptures in the outbox folders, by headset.
fn list_here(exhibition: &Exhibition) -> Vec<BTreeSet<usize>> {
    exhibition.headsets.iter().map(SimHeadset::list_parcels).collect()
}

/// Asserts that no sculpture is stored twice, that no leased badge names two sculptures, and that every
/// record's file exists.
fn check_booth(exhibition: &Exhibition) -> Kept {
    let (sculptures, tombstones) = exhibition.booth.list_all();
    let mut badges = BTreeMap::new();
    let mut kept = Kept { numbers: BTreeSet::new(), settled: BTreeSet::new() };
    kept.settled.extend(tombstones.iter().map(|tombstone| SculptureId(tombstone.id)));
    for sculpture in &sculptures {
        let id = SculptureId(sculpture.id);
        let facts = UploadFacts::from_json(&sculpture.facts).expect("facts that were checked");
        let number = number_of_facts(&facts);
        assert!(kept.numbers.insert(number), "{number}: it is stored twice, as {id} too");
        assert!(kept.settled.insert(id), "{id}: it is kept and deleted");
        let bytes = exhibition.booth.booth.read_kept(sculpture);
        assert!(bytes.is_ok_and(|bytes| bytes.starts_with(&facts.to_head())), "{id}: no file");
        let badge = sculpture.badge.and_then(BadgeNumber::new);
        // The badge of a thief's sculpture is arbitrary.
        let is_leased = badge.is_some_and(|badge| !badge.is_provisional());
        if is_leased && sculpture.headset != exhibition.thief {
            let other = badges.insert(badge, id);
            assert!(other.is_none(), "{badge:?} names {id} and {other:?}");
            // Holds regardless of a thief's claims and of restores.
            assert!(!sculpture.is_badge_lapsed(), "{id}: an honest headset's badge lapsed");
        }
    }
    kept
}

/// Checks that every sculpture is where it belongs once failures have ended.
///
/// # Panics
/// A sculpture is missing or misplaced.
pub fn check_settled(exhibition: &Exhibition) {
    check(exhibition);
    let kept = check_booth(exhibition);
    let here = list_here(exhibition);
    for (number, made) in exhibition.truth.made.iter().enumerate() {
        if !made.was_kept_here || made.is_excused {
            continue;
        }
        let is_at_booth = kept.numbers.contains(&number) || made.was_deleted;
        if made.is_poison || made.is_stolen {
            let is_here = here[made.headset].contains(&number);
            assert!(is_here && !is_at_booth, "{number}: refused, and not here: {made:?}");
        } else {
            assert!(is_at_booth, "{number}: it never came: {made:?}");
        }
    }
}

/// Describes the pending work of each headset, for the failure message.
#[must_use]
pub fn list_unsettled(exhibition: &Exhibition) -> String {
    let mut text = String::new();
    for (h, headset) in exhibition.headsets.iter().enumerate() {
        if let Some(sender) = &headset.sender {
            text += &format!("\n{h}: {}, {:?}", sender.was_wiped(), sender.spool().entries());
        }
    }
    text
}

/// Returns `true` if every headset's pending items are only those that the booth refuses.
#[must_use]
pub fn is_settled(exhibition: &Exhibition) -> bool {
    exhibition.headsets.iter().all(|headset| {
        headset.sender.as_ref().is_some_and(|sender| {
            let is_done = |status| matches!(status, UploadStatus::Sent | UploadStatus::Refused);
            let entries = sender.spool().entries();
            !sender.was_wiped() && entries.iter().all(|entry| is_done(entry.status))
        })
    })
}
