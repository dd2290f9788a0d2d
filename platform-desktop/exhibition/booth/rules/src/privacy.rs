//! Data protection: export and deletion of all records of a badge.

use paros_core::badge::BadgeNumber;
use paros_protocol::SculptureId;

use crate::audit::note;
use crate::booth::{Booth, Tx};
use crate::lifecycle::subject_of_buried;
use crate::limits::MAX_LISTED;
use crate::records::{Announcement, AuditEntry, MailOrder, PrintOrder, Sculpture, Tombstone};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;
use crate::value::ToValue;

/// The records of a badge.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct BadgeRecords {
    /// The kept sculptures, withdrawn or not, the newest first.
    pub sculptures: Vec<SculptureRecords>,
    /// The announced sculptures that haven't arrived.
    pub announced: Vec<Announcement>,
    /// The tombstones of deleted sculptures.
    pub deleted: Vec<Tombstone>,
}

/// The records of a sculpture.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SculptureRecords {
    /// The sculpture.
    pub sculpture: Sculpture,
    /// The mails, with addresses that are needed for sending or that visitors agreed to keep.
    pub mails: Vec<MailOrder>,
    /// The prints.
    pub prints: Vec<PrintOrder>,
    /// The audit entries about the sculpture.
    pub audit: Vec<AuditEntry>,
}

impl Booth {
    /// Returns all records of a badge, up to [`MAX_LISTED`] of each kind.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_known(&self, badge: BadgeNumber) -> Result<BadgeRecords, Refusal> {
        self.view(|tx| {
            let values: [&dyn ToValue; 2] = [&badge.get(), &MAX_LISTED];
            let kept = "WHERE badge = ?1 ORDER BY received_at DESC, id LIMIT ?2";
            let mut sculptures = Vec::new();
            for sculpture in tx.find::<Sculpture>(kept, &values)? {
                sculptures.push(list_of(tx, sculpture)?);
            }
            let announced = "WHERE badge = ?1 ORDER BY headset, sculpture LIMIT ?2";
            let deleted = "WHERE badge = ?1 ORDER BY id LIMIT ?2";
            Ok(BadgeRecords {
                sculptures,
                announced: tx.find(announced, &values)?,
                deleted: tx.find(deleted, &values)?,
            })
        })
    }

    /// Deletes all kept sculptures of a badge and its announcements. Returns the ids of the sculptures.
    ///
    /// # Errors
    /// Errors of the store or the disk.
    pub fn delete_known(
        &self,
        badge: BadgeNumber,
        account: &str,
        now: BoothTime,
    ) -> Result<Vec<SculptureId>, Refusal> {
        let deleted = self.update(|tx| {
            let kept: Vec<Sculpture> = tx.find("WHERE badge = ?1 ORDER BY id", &[&badge.get()])?;
            for sculpture in &kept {
                self.bury(tx, sculpture, now)?;
                note(tx, now, Some(account), "delete", subject_of_buried(sculpture))?;
            }
            tx.run("DELETE FROM announcements WHERE badge = ?1", &[&badge.get()])?;
            Ok(kept.iter().map(|sculpture| SculptureId(sculpture.id)).collect())
        })?;
        self.remove_buried_files()?;
        Ok(deleted)
    }
}

fn list_of(tx: &mut Tx<'_>, sculpture: Sculpture) -> Result<SculptureRecords, StoreError> {
    let orders = r#"WHERE sculpture = ?1 ORDER BY "order""#;
    let audit = "WHERE sculpture = ?1 ORDER BY at, number LIMIT ?2";
    Ok(SculptureRecords {
        mails: tx.find(orders, &[&sculpture.id])?,
        prints: tx.find(orders, &[&sculpture.id])?,
        audit: tx.find(audit, &[&sculpture.id, &MAX_LISTED])?,
        sculpture,
    })
}
