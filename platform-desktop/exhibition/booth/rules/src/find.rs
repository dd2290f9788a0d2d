//! Search by badge, including misread badges.

use paros_core::badge::{Badge, BadgeNumber};
use paros_protocol::SculptureId;

use crate::booth::{Booth, Tx};
use crate::limits::{MAX_LISTED, MAX_NEAREST};
use crate::reason::Reason;
use crate::record::Record;
use crate::records::{Announcement, Device, Sculpture};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::value::ToValue;
use crate::words::HeardBadge;

/// The result of a search by badge.
#[derive(Clone, PartialEq, Eq, Debug)]
pub enum FoundByBadge {
    /// The badge is valid. There may be no matches.
    Exact(BadgeMatches),
    /// The badge is invalid, incomplete or without matches. The valid badges with matches, the nearest first.
    Nearest(Vec<(Badge, BadgeMatches)>),
}

/// The sculptures with a badge.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct BadgeMatches {
    /// The kept sculptures: first those that own the badge, then by age, the newest first. A leased badge is
    /// owned by one sculpture; a provisional badge may be shown on any number of sculptures.
    pub kept: Vec<Sculpture>,
    /// The sculptures that were announced and haven't arrived.
    pub missing: Vec<Announcement>,
}

/// A sculpture that was announced and hasn't arrived.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct MissingSculpture {
    /// The announcement of the sculpture.
    pub announcement: Announcement,
    /// `true` if its headset was wiped after the announcement: the sculpture won't arrive.
    pub is_lost: bool,
}

impl BadgeMatches {
    /// `true` if no sculpture has the badge.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.kept.is_empty() && self.missing.is_empty()
    }
}

impl Booth {
    /// Finds the sculptures with a badge, or with a similar badge if `heard` is wrong or incomplete.
    /// Withdrawn sculptures aren't found.
    ///
    /// # Errors
    /// Store errors.
    pub fn find_by_badge(&self, heard: &HeardBadge) -> Result<FoundByBadge, Refusal> {
        let whole = heard.badge().and_then(|badge| badge.number().ok());
        self.view(|tx| {
            let mut exact = None;
            if let Some(number) = whole {
                let matches = find_matches(tx, number)?;
                if !matches.is_empty() {
                    return Ok(FoundByBadge::Exact(matches));
                }
                exact = Some(matches);
            }
            let mut nearest = Vec::new();
            for candidate in heard.candidates() {
                let Ok(number) = candidate.number() else { continue };
                let matches = find_matches(tx, number)?;
                if !matches.is_empty() {
                    nearest.push((candidate, matches));
                }
                if nearest.len() == MAX_NEAREST {
                    break;
                }
            }
            Ok(match exact {
                Some(exact) if nearest.is_empty() => FoundByBadge::Exact(exact),
                _ => FoundByBadge::Nearest(nearest),
            })
        })
    }

    /// Returns the sculpture of an id, withdrawn or not.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or a store error.
    pub fn find_sculpture(&self, id: &SculptureId) -> Result<Sculpture, Refusal> {
        let found: Option<Sculpture> = self.view(|tx| tx.get(&[&id.0]))?;
        found.ok_or(NO_SCULPTURE)
    }

    /// Returns the sculptures that were announced and haven't arrived, the newest first.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_missing(&self, count: usize) -> Result<Vec<MissingSculpture>, Refusal> {
        let newest = "ORDER BY heard_at DESC, headset, sculpture LIMIT ?1";
        self.view(|tx| {
            let mut missing = Vec::new();
            for announcement in tx.find::<Announcement>(newest, &[&count.min(MAX_LISTED)])? {
                let device: Option<Device> = tx.get(&[&announcement.headset])?;
                let wiped_at = device.and_then(|device| device.wiped_at);
                let is_lost = wiped_at.is_some_and(|wiped_at| wiped_at > announcement.heard_at);
                missing.push(MissingSculpture { announcement, is_lost });
            }
            Ok(missing)
        })
    }

    /// Counts records. `rest` is the SQL after `SELECT count(*) FROM table`.
    ///
    /// # Errors
    /// Store errors.
    pub fn count<R: Record>(&self, rest: &str, values: &[&dyn ToValue]) -> Result<u64, Refusal> {
        self.view(|tx| tx.count::<R>(rest, values))
    }
}

pub(crate) const NO_SCULPTURE: Refusal = Refusal::NotFound(Reason::NoSculpture);

fn find_matches(tx: &mut Tx<'_>, number: BadgeNumber) -> Result<BadgeMatches, StoreError> {
    let shown = "WHERE badge = ?1 AND withdrawn_at IS NULL ORDER BY received_at DESC, id";
    let mut kept: Vec<Sculpture> = tx.find(shown, &[&number.get()])?;
    kept.sort_by_key(Sculpture::is_badge_lapsed);
    let announced = "WHERE badge = ?1 ORDER BY headset, sculpture";
    Ok(BadgeMatches { kept, missing: tx.find(announced, &[&number.get()])? })
}
