//! What has to be done to a store that comes back from a copy, before anybody is served: what happened since is unknown.

use std::io::ErrorKind;

use crate::audit::{Subject, note};
use crate::badges::restore_badges;
use crate::booth::{Booth, Tx};
use crate::deletions::Deletion;
use crate::lifecycle::kept_name;
use crate::mail::fail_queued_mails;
use crate::parcel_files::KeptPart;
use crate::reason::Reason;
use crate::records::{Sculpture, Tombstone};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;
use crate::upload::remove_announcements;

/// What was done to a copy.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct RestoreReport {
    /// Sculptures in it.
    pub sculptures: u64,
    /// Of them, those that were deleted since.
    pub deleted: usize,
    /// Deleted sculptures that it didn't know.
    pub tombstones: usize,
    /// Mails that waited, and have to be asked for anew: they may have been sent since.
    pub mails: usize,
}

/// Said of a mail that waited when the copy was made.
const MAYBE_SENT: &str = "it may have been sent before the booth was restored";

impl Booth {
    /// Makes a copy of `copied_at` fit for use: applies what was deleted since; passes over the blocks of badges' numbers
    /// that may have been leased since; ends all logins, and takes back mails that waited.
    ///
    /// # Errors
    /// Those of store and disk; [`Refusal::Conflict`] where a file of a sculpture is missing that is kept.
    pub fn make_restored(
        &self,
        deletions: &[Deletion],
        copied_at: BoothTime,
        now: BoothTime,
    ) -> Result<RestoreReport, Refusal> {
        let report = self.update(|tx| {
            let mut report = RestoreReport {
                sculptures: tx.count::<Sculpture>("", &[])?,
                ..RestoreReport::default()
            };
            for deletion in deletions {
                self.apply_deletion(tx, deletion, &mut report)?;
            }
            restore_badges(tx, copied_at, now)?;
            report.mails = fail_queued_mails(tx, MAYBE_SENT)?;
            tx.run("DELETE FROM staff_sessions", &[])?;
            self.check_files(tx)?;
            note(tx, now, None, "restore", Subject::default())?;
            Ok(report)
        })?;
        self.remove_buried_files()?;
        Ok(report)
    }

    fn apply_deletion(
        &self,
        tx: &mut Tx<'_>,
        deletion: &Deletion,
        report: &mut RestoreReport,
    ) -> Result<(), StoreError> {
        let id = deletion.id.0;
        if let Some(sculpture) = tx.get::<Sculpture>(&[&id])? {
            report.deleted += 1;
            return self.bury(tx, &sculpture, deletion.deleted_at);
        }
        // In the copy it may not have come yet.
        remove_announcements(tx, &id)?;
        if tx.get::<Tombstone>(&[&id])?.is_none() {
            report.tombstones += 1;
            tx.put(&self.make_tombstone(deletion))?;
        }
        Ok(())
    }

    /// Checks that the files of all sculptures are there. Traces may have been too old while the copy was made.
    fn check_files(&self, tx: &mut Tx<'_>) -> Result<(), Refusal> {
        let is_there = |name| match self.files.read_kept(&name) {
            Ok(_) => Ok(true),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(false),
            Err(error) => Err(Refusal::Files(error)),
        };
        for mut sculpture in tx.find::<Sculpture>("", &[])? {
            let name = |part| kept_name(&sculpture.id, &sculpture.hash, part);
            if !is_there(name(KeptPart::Sculpture))? {
                return Err(Refusal::Conflict(Reason::FileMissing));
            }
            if sculpture.has_trace && !is_there(name(KeptPart::Trace))? {
                sculpture.has_trace = false;
                tx.put(&sculpture)?;
            }
        }
        Ok(())
    }
}
