//! The deletion log: one line for each deletion, kept apart from the database. After a restore from an older
//! copy it prevents that deleted sculptures reappear.

use std::fmt::Write as _;

use paros_protocol::{ContentHash, SculptureId};

use crate::records::Tombstone;
use crate::time::BoothTime;

/// A deletion: all that a tombstone needs.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Deletion {
    /// The sculpture's id.
    pub id: SculptureId,
    /// The headset that made the sculpture.
    pub headset: u32,
    /// The hash of the parcel.
    pub hash: ContentHash,
    /// The number of its badge, if its visitor was shown a badge.
    pub badge: Option<u32>,
    /// The time of the deletion.
    pub deleted_at: BoothTime,
}

impl Deletion {
    /// Makes the deletion of a tombstone.
    #[must_use]
    pub const fn of(tombstone: &Tombstone) -> Self {
        Deletion {
            id: SculptureId(tombstone.id),
            headset: tombstone.headset,
            hash: ContentHash(tombstone.hash),
            badge: tombstone.badge,
            deleted_at: tombstone.deleted_at,
        }
    }

    /// Returns the log line, with its line end: id, headset, hash, badge or `-`, milliseconds since 1970.
    #[must_use]
    pub fn to_line(&self) -> String {
        let mut line = format!("{} {} {} ", self.id, self.headset, self.hash);
        // Writing to a String doesn't fail.
        let _ = match self.badge {
            Some(badge) => write!(line, "{badge}"),
            None => write!(line, "-"),
        };
        line + &format!(" {}\n", self.deleted_at.0)
    }

    /// Parses a line of [`Deletion::to_line`] without its line end; `None` for any other text.
    #[must_use]
    pub fn parse_line(line: &str) -> Option<Self> {
        let mut words = line.split(' ');
        let id = SculptureId::parse_hex(words.next()?)?;
        let headset = words.next()?.parse().ok()?;
        let hash = ContentHash::parse_hex(words.next()?)?;
        let badge = match words.next()? {
            "-" => None,
            number => Some(number.parse().ok()?),
        };
        let deleted_at = BoothTime(words.next()?.parse().ok()?);
        let is_all = words.next().is_none();
        is_all.then_some(Deletion { id, headset, hash, badge, deleted_at })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_read_as_it_was_written_and_no_other() {
        let (id, hash) = (SculptureId([0xab; 16]), ContentHash([7; 32]));
        for badge in [None, Some(77)] {
            let deletion = Deletion { id, headset: 3, hash, badge, deleted_at: BoothTime(99) };
            let line = deletion.to_line();
            assert_eq!(Deletion::parse_line(line.trim_end_matches('\n')), Some(deletion));
            assert_eq!(Deletion::parse_line(&line), None, "with its end");
            for cut in 0..line.len() - 3 {
                assert_eq!(Deletion::parse_line(&line[..cut]), None, "{cut}");
            }
            assert_eq!(Deletion::parse_line(&format!("{} 1", line.trim_end())), None);
        }
    }
}
