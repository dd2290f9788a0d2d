//! All that is known of a badge, and its deletion.

use paros_core::badge::BadgeNumber;
use paros_protocol::SculptureId;

use crate::audit::note;
use crate::booth::{Booth, Tx};
use crate::lifecycle::subject_of_buried;
use crate::limits::MAX_LISTED;
use crate::records::{Announcement, AuditEntry, MailOrder, PrintOrder, Sculpture, Tombstone};
use crate::refusal::Refusal;
use crate::store::{Query, RowOrder, StoreError};
use crate::time::BoothTime;
use crate::value::Field as _;

/// What is known under a badge.
#[derive(Clone, PartialEq, Eq, Default, Debug)]
pub struct BadgeRecords {
    /// What is kept, withdrawn or not, the newest first.
    pub sculptures: Vec<SculptureRecords>,
    /// What headsets told of and haven't sent.
    pub announced: Vec<Announcement>,
    /// What is left of those that were deleted.
    pub deleted: Vec<Tombstone>,
}

/// What is known of a sculpture.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct SculptureRecords {
    /// Itself.
    pub sculpture: Sculpture,
    /// Its mails, with addresses that their visitors agreed to, or that wait.
    pub mails: Vec<MailOrder>,
    /// Its prints.
    pub prints: Vec<PrintOrder>,
    /// What was done with it.
    pub audit: Vec<AuditEntry>,
}

impl Booth {
    /// All that is known under a badge, up to [`MAX_LISTED`] of each kind.
    ///
    /// # Errors
    /// Those of the store.
    pub fn list_known(&self, badge: BadgeNumber) -> Result<BadgeRecords, Refusal> {
        let number = badge.get();
        self.view(|tx| {
            let kept = Query::all::<Sculpture>().equal("badge", &number);
            let kept = kept.ordered("received_at", RowOrder::Descending).first(MAX_LISTED);
            let mut sculptures = Vec::new();
            for sculpture in tx.find::<Sculpture>(&kept)? {
                sculptures.push(list_of(tx, sculpture)?);
            }
            let announced = Query::all::<Announcement>().equal("badge", &number);
            let deleted = Query::all::<Tombstone>().equal("badge", &number);
            Ok(BadgeRecords {
                sculptures,
                announced: tx.find(&announced.first(MAX_LISTED))?,
                deleted: tx.find(&deleted.first(MAX_LISTED))?,
            })
        })
    }

    /// Deletes all that is kept under a badge. Returns the ids of the sculptures.
    ///
    /// # Errors
    /// Those of store and disk.
    pub fn delete_known(
        &self,
        badge: BadgeNumber,
        account: &str,
        now: BoothTime,
    ) -> Result<Vec<SculptureId>, Refusal> {
        let deleted = self.update(|tx| {
            let kept: Vec<Sculpture> =
                tx.find(&Query::all::<Sculpture>().equal("badge", &badge.get()))?;
            for sculpture in &kept {
                self.bury(tx, sculpture, now)?;
                note(tx, now, Some(account), "delete", subject_of_buried(sculpture))?;
            }
            let announced = Query::all::<Announcement>().equal("badge", &badge.get());
            for announced in tx.find::<Announcement>(&announced)? {
                let key = [announced.headset.to_value(), announced.sculpture.to_value()];
                tx.remove::<Announcement>(&key)?;
            }
            Ok(kept.iter().map(|sculpture| SculptureId(sculpture.id)).collect())
        })?;
        self.remove_buried_files()?;
        Ok(deleted)
    }
}

fn list_of(tx: &mut Tx<'_>, sculpture: Sculpture) -> Result<SculptureRecords, StoreError> {
    let mails = Query::all::<MailOrder>().equal("sculpture", &sculpture.id);
    let prints = Query::all::<PrintOrder>().equal("sculpture", &sculpture.id);
    let audit = Query::all::<AuditEntry>().equal("sculpture", &Some(sculpture.id));
    Ok(SculptureRecords {
        mails: tx.find(&mails)?,
        prints: tx.find(&prints)?,
        audit: tx.find(&audit.ordered("at", RowOrder::Ascending).first(MAX_LISTED))?,
        sculpture,
    })
}
