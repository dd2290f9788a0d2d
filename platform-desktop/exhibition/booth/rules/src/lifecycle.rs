//! The life cycle of sculptures: withdrawn, brought back, kept for longer, deleted by hand or by age.

use std::io::ErrorKind;
use std::time::Duration;

use paros_protocol::{ContentHash, SculptureId};

use crate::audit::{Subject, drop_old_entries, note};
use crate::booth::{Booth, Tx};
use crate::clock::seen_time;
use crate::deletions::Deletion;
use crate::find::NO_SCULPTURE;
use crate::limits::{AUDIT_DAYS, MAX_WORKERS, SWEEP_BATCH};
use crate::mail::withdraw_mails;
use crate::parcel_files::{KeptName, KeptPart};
use crate::prints::withdraw_prints;
use crate::records::{ExportState, Sculpture, Tombstone, WorkKind};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::{BoothTime, DAY};
use crate::upload::remove_announcements;
use crate::value::ToValue;
use crate::work::{drop_old_leases, end_work};

/// The result of a sweep.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct SweepReport {
    /// Number of expired sculptures that were withdrawn.
    pub withdrawn: usize,
    /// Number of withdrawn sculptures that were deleted.
    pub deleted: usize,
    /// Number of old traces that were deleted.
    pub traces: usize,
    /// Number of tombstones that were removed after their end.
    pub tombstones: usize,
    /// Number of old announcements that were removed.
    pub announcements: usize,
}

impl Booth {
    /// Hides a sculpture from its visitor. It can be brought back for `withdrawn_days`, and is then deleted.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or a store error.
    pub fn withdraw(&self, id: &SculptureId, account: &str, now: BoothTime) -> Result<(), Refusal> {
        self.update(|tx| {
            let sculpture = get_sculpture(tx, id)?;
            let seen_at = seen_time(tx, now)?;
            withdraw(tx, sculpture, (Some(account), "withdraw"), (seen_at, now))
        })
    }

    /// Brings a withdrawn sculpture back. An expired sculpture is shown for `withdrawn_days` more, and then
    /// withdrawn again.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] if there is no such sculpture; or a store error.
    pub fn bring_back(
        &self,
        id: &SculptureId,
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let mut sculpture = get_sculpture(tx, id)?;
            let days = 2 * u32::from(self.plan.withdrawn_days);
            let keep_day = seen_time(tx, now)?.day().saturating_add(days);
            sculpture.keep_day = sculpture.keep_day.max(keep_day);
            sculpture.withdrawn_at = None;
            tx.put(&sculpture)?;
            Ok(note(tx, now, Some(account), "bring back", subject_of(&sculpture))?)
        })
    }

    /// Returns the last day on which lists and its visitor's page show a sculpture.
    #[must_use]
    pub fn last_shown_day(&self, sculpture: &Sculpture) -> u32 {
        sculpture.keep_day.saturating_sub(u32::from(self.plan.withdrawn_days))
    }

    /// Returns until when a sculpture can be brought back; `None` if it isn't withdrawn.
    #[must_use]
    pub fn withdrawn_until(&self, sculpture: &Sculpture) -> Option<BoothTime> {
        let days = DAY * u32::from(self.plan.withdrawn_days);
        sculpture.withdrawn_at.map(|withdrawn_at| withdrawn_at.after(days))
    }

    /// Keeps a sculpture at least until the end of a day.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or a store error.
    pub fn keep_until(
        &self,
        id: &SculptureId,
        last_day: u32,
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let mut sculpture = get_sculpture(tx, id)?;
            sculpture.keep_day = sculpture.keep_day.max(last_day);
            tx.put(&sculpture)?;
            Ok(note(tx, now, Some(account), "keep longer", subject_of(&sculpture))?)
        })
    }

    /// Deletes a sculpture and all records under its badge. A tombstone remains, so that a headset that
    /// uploads it later deletes it too.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or an error of the store or the disk. A later sweep removes files that couldn't
    /// be removed now.
    pub fn delete(&self, id: &SculptureId, account: &str, now: BoothTime) -> Result<(), Refusal> {
        self.delete_as(id, (Some(account), "delete"), now)
    }

    /// Deletes a sculpture, as an account's or a visitor's action.
    pub(crate) fn delete_as(
        &self,
        id: &SculptureId,
        (account, action): (Option<&str>, &str),
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let sculpture = get_sculpture(tx, id)?;
            self.bury(tx, &sculpture, now)?;
            Ok(note(tx, now, account, action, subject_of_buried(&sculpture))?)
        })?;
        self.remove_buried_files()
    }

    /// Withdraws expired sculptures. Deletes those that were withdrawn for `withdrawn_days`, and all other
    /// records past their time. Call it every few minutes. If the clock jumped by more than `most` since the
    /// last sweep, nothing ages until an admin confirms the clock, or it is corrected.
    ///
    /// # Errors
    /// Errors of the store or the disk. Steps before the error stay done.
    pub fn sweep(&self, now: BoothTime, most: Duration) -> Result<SweepReport, Refusal> {
        let seen_at = self.follow_clock(now, most)?;
        let mut report = SweepReport {
            withdrawn: self.withdraw_expired((seen_at, now))?,
            deleted: self.bury_withdrawn((seen_at, now))?,
            traces: self.drop_old_traces(seen_at)?,
            ..SweepReport::default()
        };
        self.remove_buried_files()?;
        let horizon = seen_at.days_before(self.plan.horizon_days);
        self.files.forget_deletions_before(horizon)?;
        (report.tombstones, report.announcements) = self.update(|tx| {
            let ended = "DELETE FROM tombstones WHERE id IN
                (SELECT id FROM tombstones WHERE ends_on <= ?1 AND has_files = 0 LIMIT ?2)
                RETURNING id";
            let ended = tx.run(ended, &[&seen_at.day(), &SWEEP_BATCH])?;
            let old = "DELETE FROM announcements WHERE (headset, sculpture) IN
                (SELECT headset, sculpture FROM announcements WHERE heard_at < ?1 LIMIT ?2)
                RETURNING headset";
            let old = tx.run(old, &[&horizon, &SWEEP_BATCH])?;
            drop_old_entries(tx, seen_at.days_before(AUDIT_DAYS))?;
            drop_old_leases(tx, now)?;
            Ok((ended.len(), old.len()))
        })?;
        self.sweep_badges(seen_at)?;
        Ok(report)
    }

    /// Returns the sculpture that waits longest for its mesh check, and that no other process works on.
    ///
    /// # Errors
    /// Store errors.
    pub fn next_export(&self, now: BoothTime) -> Result<Option<Sculpture>, Refusal> {
        let find_queued = |tx: &mut Tx<'_>| {
            let queued = "WHERE export = ?1 ORDER BY received_at, id LIMIT ?2";
            tx.find::<Sculpture>(queued, &[&ExportState::Queued, &MAX_WORKERS])
        };
        if self.view(find_queued)?.is_empty() {
            return Ok(None);
        }
        self.update(|tx| {
            for sculpture in find_queued(tx)? {
                if self.begin_work(tx, WorkKind::Export, &sculpture.id, now)? {
                    return Ok(Some(sculpture));
                }
            }
            Ok(None)
        })
    }

    /// Stores the result of a sculpture's mesh check. Does nothing if the sculpture was deleted meanwhile.
    ///
    /// # Errors
    /// Store errors.
    pub fn note_export(&self, id: &SculptureId, state: ExportState) -> Result<(), Refusal> {
        self.update(|tx| {
            tx.run("UPDATE sculptures SET export = ?1 WHERE id = ?2", &[&state, &id.0])?;
            Ok(end_work(tx, WorkKind::Export, &id.0)?)
        })
    }

    /// Reads the head and the packed volume of a sculpture.
    ///
    /// # Errors
    /// Errors of the disk.
    pub fn read_kept(&self, sculpture: &Sculpture) -> Result<Vec<u8>, Refusal> {
        let name = kept_name(&sculpture.id, &sculpture.hash, KeptPart::Sculpture);
        Ok(self.files.read_kept(&name)?)
    }

    /// Stores a picture of a sculpture. Does nothing if the sculpture was deleted meanwhile.
    ///
    /// # Errors
    /// Errors of the store or the disk.
    pub fn keep_picture(&self, sculpture: &Sculpture, png: &[u8]) -> Result<(), Refusal> {
        let name = kept_name(&sculpture.id, &sculpture.hash, KeptPart::Picture);
        self.files.keep(&name, png)?;
        if self.view(|tx| tx.get::<Sculpture>(&[&sculpture.id]))?.is_none() {
            self.files.remove_kept(&name)?;
        }
        Ok(())
    }

    /// Reads the picture of a sculpture; `None` if none was drawn.
    ///
    /// # Errors
    /// Errors of the disk.
    pub fn read_picture(&self, sculpture: &Sculpture) -> Result<Option<Vec<u8>>, Refusal> {
        self.read_part(sculpture, KeptPart::Picture)
    }

    /// Reads the packed trace of a sculpture; `None` if it has none.
    ///
    /// # Errors
    /// Errors of the disk.
    pub fn read_trace(&self, sculpture: &Sculpture) -> Result<Option<Vec<u8>>, Refusal> {
        self.read_part(sculpture, KeptPart::Trace)
    }

    fn read_part(&self, of: &Sculpture, part: KeptPart) -> Result<Option<Vec<u8>>, Refusal> {
        match self.files.read_kept(&kept_name(&of.id, &of.hash, part)) {
            Ok(bytes) => Ok(Some(bytes)),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error.into()),
        }
    }

    /// Replaces a sculpture's record by a tombstone.
    pub(crate) fn bury(
        &self,
        tx: &mut Tx<'_>,
        sculpture: &Sculpture,
        now: BoothTime,
    ) -> Result<(), StoreError> {
        let id: &[&dyn ToValue] = &[&sculpture.id];
        tx.run("DELETE FROM sculptures WHERE id = ?1", id)?;
        tx.run("DELETE FROM mail_orders WHERE sculpture = ?1", id)?;
        tx.run("DELETE FROM print_orders WHERE sculpture = ?1", id)?;
        // The badge will soon belong to another sculpture.
        tx.run("UPDATE audit SET badge = NULL WHERE sculpture = ?1", id)?;
        remove_announcements(tx, &sculpture.id)?;
        tx.put(&self.make_tombstone(&Deletion {
            id: SculptureId(sculpture.id),
            headset: sculpture.headset,
            hash: ContentHash(sculpture.hash),
            badge: sculpture.badge,
            deleted_at: now,
        }))
    }

    /// Makes the tombstone of a deleted sculpture whose files are still to be removed.
    pub(crate) fn make_tombstone(&self, deletion: &Deletion) -> Tombstone {
        let Deletion { id, headset, hash, badge, deleted_at } = *deletion;
        Tombstone {
            id: id.0,
            headset,
            hash: hash.0,
            badge,
            deleted_at,
            ends_on: deleted_at.day().saturating_add(u32::from(self.plan.horizon_days)),
            has_files: true,
        }
    }

    /// Withdraws the sculptures whose last `withdrawn_days` have begun. Returns their number.
    fn withdraw_expired(&self, (seen_at, now): (BoothTime, BoothTime)) -> Result<usize, Refusal> {
        let expired = "WHERE keep_day < ?1 AND withdrawn_at IS NULL ORDER BY id LIMIT ?2";
        let before = seen_at.day().saturating_add(u32::from(self.plan.withdrawn_days));
        self.in_batches(|tx| {
            let expired: Vec<Sculpture> = tx.find(expired, &[&before, &SWEEP_BATCH])?;
            let count = expired.len();
            for sculpture in expired {
                withdraw(tx, sculpture, (None, "withdraw by age"), (seen_at, now))?;
            }
            Ok(count)
        })
    }

    /// Buries the sculptures that have been withdrawn for `withdrawn_days`. Returns their number.
    fn bury_withdrawn(&self, (seen_at, now): (BoothTime, BoothTime)) -> Result<usize, Refusal> {
        let old = "WHERE withdrawn_at <= ?1 ORDER BY id LIMIT ?2";
        let before = seen_at.days_before(self.plan.withdrawn_days);
        self.in_batches(|tx| {
            let old: Vec<Sculpture> = tx.find(old, &[&before, &SWEEP_BATCH])?;
            for sculpture in &old {
                self.bury(tx, sculpture, now)?;
                note(tx, now, None, "delete by age", subject_of_buried(sculpture))?;
            }
            Ok(old.len())
        })
    }

    /// Repeats `work` on batches of [`SWEEP_BATCH`] records, each in a transaction, until a batch isn't full.
    /// Returns the total.
    fn in_batches(
        &self,
        mut work: impl FnMut(&mut Tx<'_>) -> Result<usize, Refusal>,
    ) -> Result<usize, Refusal> {
        let mut sum = 0;
        loop {
            let count = self.update(&mut work)?;
            sum += count;
            if count < SWEEP_BATCH {
                return Ok(sum);
            }
        }
    }

    fn drop_old_traces(&self, seen_at: BoothTime) -> Result<usize, Refusal> {
        let before = seen_at.days_before(self.plan.trace_days);
        let old = "WHERE received_at < ?1 AND has_trace = 1 ORDER BY id LIMIT ?2";
        let old: Vec<Sculpture> = self.view(|tx| tx.find(old, &[&before, &SWEEP_BATCH]))?;
        for Sculpture { id, hash, .. } in &old {
            // Remove the file first: a record without a trace is then always right.
            self.files.remove_kept(&kept_name(id, hash, KeptPart::Trace))?;
            self.update(|tx| {
                tx.run("UPDATE sculptures SET has_trace = 0 WHERE id = ?1", &[id])?;
                Ok(())
            })?;
        }
        Ok(old.len())
    }

    /// Logs the deleted sculptures, then removes their files. A copy of the booth that lacks a file therefore
    /// has the log line.
    pub(crate) fn remove_buried_files(&self) -> Result<(), Refusal> {
        let buried: Vec<Tombstone> =
            self.view(|tx| tx.find("WHERE has_files = 1 ORDER BY id", &[]))?;
        if buried.is_empty() {
            return Ok(());
        }
        let deletions: Vec<Deletion> = buried.iter().map(Deletion::of).collect();
        self.files.log_deletions(&deletions)?;
        for mut tombstone in buried {
            for part in KeptPart::ALL {
                self.files.remove_kept(&kept_name(&tombstone.id, &tombstone.hash, part))?;
            }
            tombstone.has_files = false;
            self.update(|tx| Ok(tx.put(&tombstone)?))?;
        }
        Ok(())
    }
}

pub(crate) const fn kept_name(id: &[u8; 16], hash: &[u8; 32], part: KeptPart) -> KeptName {
    KeptName { id: SculptureId(*id), hash: ContentHash(*hash), part }
}

/// Withdraws a sculpture with its mails and prints. A repeated withdrawal doesn't delay its deletion.
fn withdraw(
    tx: &mut Tx<'_>,
    mut sculpture: Sculpture,
    (account, action): (Option<&str>, &str),
    (seen_at, now): (BoothTime, BoothTime),
) -> Result<(), Refusal> {
    sculpture.withdrawn_at.get_or_insert(seen_at);
    tx.put(&sculpture)?;
    withdraw_mails(tx, &sculpture.id)?;
    withdraw_prints(tx, &sculpture.id, now)?;
    Ok(note(tx, now, account, action, subject_of(&sculpture))?)
}

pub(crate) fn get_sculpture(tx: &mut Tx<'_>, id: &SculptureId) -> Result<Sculpture, Refusal> {
    tx.get(&[&id.0])?.ok_or(NO_SCULPTURE)
}

pub(crate) fn subject_of(sculpture: &Sculpture) -> Subject {
    Subject {
        headset: Some(sculpture.headset),
        sculpture: Some(sculpture.id),
        badge: sculpture.badge,
    }
}

/// Returns the audit subject of a deleted sculpture, without its badge, which will be used again.
pub(crate) fn subject_of_buried(sculpture: &Sculpture) -> Subject {
    Subject { badge: None, ..subject_of(sculpture) }
}
