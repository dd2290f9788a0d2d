//! Restore: prepares a store that comes from a copy, before it serves requests. Later changes are unknown.

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

/// The result of a restore.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct RestoreReport {
    /// Number of sculptures in the copy.
    pub sculptures: u64,
    /// Number of those that were deleted after the copy.
    pub deleted: usize,
    /// Number of deleted sculptures that the copy didn't contain.
    pub tombstones: usize,
    /// Number of waiting mails. They must be ordered again, as they may have been sent since.
    pub mails: usize,
}

/// The failure text of a mail that waited when the copy was made.
const MAYBE_SENT: &str = "it may have been sent before the booth was restored";

impl Booth {
    /// Prepares a copy of the time `copied_at` for use: applies later deletions, passes over badge blocks
    /// that may have been leased since, ends all logins, and fails waiting mails.
    ///
    /// # Errors
    /// Errors of the store or the disk; [`Refusal::Conflict`] if a file of a kept sculpture is missing.
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
        // The sculpture may have arrived after the copy.
        remove_announcements(tx, &id)?;
        if tx.get::<Tombstone>(&[&id])?.is_none() {
            report.tombstones += 1;
            tx.put(&self.make_tombstone(deletion))?;
        }
        Ok(())
    }

    /// Checks that the files of all sculptures exist. A missing trace is accepted: it may have expired while
    /// the copy was made.
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
