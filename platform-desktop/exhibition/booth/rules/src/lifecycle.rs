//! What becomes of sculptures: withdrawn, brought back, kept for longer, deleted by hand or by age.

use std::io::ErrorKind;

use paros_protocol::{ContentHash, SculptureId};

use crate::audit::{Subject, drop_old_entries, note};
use crate::booth::{Booth, Tx};
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

/// What a sweep did.
#[derive(Clone, Copy, PartialEq, Eq, Default, Debug)]
pub struct SweepReport {
    /// Sculptures past their last day, or withdrawn for too long.
    pub deleted: usize,
    /// Traces that were too old.
    pub traces: usize,
    /// Tombstones past their end.
    pub tombstones: usize,
    /// Announcements of which nobody waits for the sculpture any more.
    pub announcements: usize,
}

impl Booth {
    /// Hides a sculpture, for its visitor. It can be brought back until it is deleted by age.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or those of the store.
    pub fn withdraw(&self, id: &SculptureId, account: &str, now: BoothTime) -> Result<(), Refusal> {
        self.set_withdrawn(id, Some(now), account, now)
    }

    /// Brings a withdrawn sculpture back.
    ///
    /// # Errors
    /// [`Refusal::NotFound`] where there is none, or it was withdrawn for too long; or those of the store.
    pub fn bring_back(
        &self,
        id: &SculptureId,
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.set_withdrawn(id, None, account, now)
    }

    /// Until when a sculpture can be brought back; `None` where it isn't withdrawn.
    #[must_use]
    pub fn withdrawn_until(&self, sculpture: &Sculpture) -> Option<BoothTime> {
        let by_age = BoothTime::of_day(sculpture.keep_day.saturating_add(1));
        let days = DAY * u32::from(self.plan.withdrawn_days);
        sculpture.withdrawn_at.map(|withdrawn_at| withdrawn_at.after(days).min(by_age))
    }

    /// Keeps a sculpture until the end of a day at least.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or those of the store.
    pub fn keep_until(
        &self,
        id: &SculptureId,
        last_day: u32,
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let mut sculpture = get_kept(tx, id, now)?;
            sculpture.keep_day = sculpture.keep_day.max(last_day);
            tx.put(&sculpture)?;
            Ok(note(tx, now, Some(account), "keep longer", subject_of(&sculpture))?)
        })
    }

    /// Deletes a sculpture and all that is known under its badge. A tombstone stays, so that a headset that comes late
    /// with it deletes it too.
    ///
    /// # Errors
    /// [`Refusal::NotFound`], or those of store and disk. Files that the disk doesn't give back are removed by a
    /// later sweep.
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
            let sculpture: Sculpture = tx.get(&[&id.0])?.ok_or(NO_SCULPTURE)?;
            self.bury(tx, &sculpture, now)?;
            Ok(note(tx, now, account, action, subject_of_buried(&sculpture))?)
        })?;
        self.remove_buried_files()
    }

    /// Deletes all that is past its time; to be called every few minutes. It does so many at once as its limits say.
    ///
    /// # Errors
    /// Those of store and disk. What was done before stays done.
    pub fn sweep(&self, now: BoothTime) -> Result<SweepReport, Refusal> {
        let mut report = SweepReport {
            deleted: self.bury_old(now)?,
            traces: self.drop_old_traces(now)?,
            ..SweepReport::default()
        };
        self.remove_buried_files()?;
        self.files.forget_deletions_before(days_before(now, self.plan.horizon_days))?;
        (report.tombstones, report.announcements) = self.update(|tx| {
            let ended = "DELETE FROM tombstones WHERE id IN
                (SELECT id FROM tombstones WHERE ends_on <= ?1 AND has_files = 0 LIMIT ?2)
                RETURNING id";
            let ended = tx.run(ended, &[&now.day(), &SWEEP_BATCH])?;
            let horizon = days_before(now, self.plan.horizon_days);
            let old = "DELETE FROM announcements WHERE (headset, sculpture) IN
                (SELECT headset, sculpture FROM announcements WHERE heard_at < ?1 LIMIT ?2)
                RETURNING headset";
            let old = tx.run(old, &[&horizon, &SWEEP_BATCH])?;
            drop_old_entries(tx, days_before(now, AUDIT_DAYS))?;
            drop_old_leases(tx, now)?;
            Ok((ended.len(), old.len()))
        })?;
        self.sweep_badges(now)?;
        Ok(report)
    }

    /// The sculpture that waits longest for its mesh to be checked, of those that no other process is at.
    ///
    /// # Errors
    /// Those of the store.
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

    /// Notes what came of a sculpture's mesh; nothing where it was deleted meanwhile.
    ///
    /// # Errors
    /// Those of the store.
    pub fn note_export(&self, id: &SculptureId, state: ExportState) -> Result<(), Refusal> {
        self.update(|tx| {
            tx.run("UPDATE sculptures SET export = ?1 WHERE id = ?2", &[&state, &id.0])?;
            Ok(end_work(tx, WorkKind::Export, &id.0)?)
        })
    }

    /// The packed first file of a sculpture, with its head before it.
    ///
    /// # Errors
    /// What the disk says.
    pub fn read_kept(&self, sculpture: &Sculpture) -> Result<Vec<u8>, Refusal> {
        let name = kept_name(&sculpture.id, &sculpture.hash, KeptPart::Sculpture);
        Ok(self.files.read_kept(&name)?)
    }

    /// Keeps a picture of a sculpture; nothing where it was deleted meanwhile.
    ///
    /// # Errors
    /// Those of store and disk.
    pub fn keep_picture(&self, sculpture: &Sculpture, png: &[u8]) -> Result<(), Refusal> {
        let name = kept_name(&sculpture.id, &sculpture.hash, KeptPart::Picture);
        self.files.keep(&name, png)?;
        if self.view(|tx| tx.get::<Sculpture>(&[&sculpture.id]))?.is_none() {
            self.files.remove_kept(&name)?;
        }
        Ok(())
    }

    /// The picture of a sculpture, if one was drawn.
    ///
    /// # Errors
    /// What the disk says.
    pub fn read_picture(&self, sculpture: &Sculpture) -> Result<Option<Vec<u8>>, Refusal> {
        self.read_part(sculpture, KeptPart::Picture)
    }

    /// The packed trace of a sculpture, if it has one.
    ///
    /// # Errors
    /// What the disk says.
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

    fn set_withdrawn(
        &self,
        id: &SculptureId,
        withdrawn_at: Option<BoothTime>,
        account: &str,
        now: BoothTime,
    ) -> Result<(), Refusal> {
        self.update(|tx| {
            let mut sculpture = get_kept(tx, id, now)?;
            if is_withdrawn_too_long(&sculpture, self.plan.withdrawn_days, now) {
                return Err(NO_SCULPTURE);
            }
            // Withdrawn twice, it doesn't stay for longer.
            sculpture.withdrawn_at = withdrawn_at.map(|now| sculpture.withdrawn_at.unwrap_or(now));
            tx.put(&sculpture)?;
            if withdrawn_at.is_some() {
                withdraw_mails(tx, &id.0)?;
                withdraw_prints(tx, &id.0, now)?;
            }
            let action = if withdrawn_at.is_some() { "withdraw" } else { "bring back" };
            Ok(note(tx, now, Some(account), action, subject_of(&sculpture))?)
        })
    }

    /// Puts a tombstone in a sculpture's place.
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
        // The badge is another's soon.
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

    /// What stays of a deleted sculpture whose files are yet to be removed.
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

    fn bury_old(&self, now: BoothTime) -> Result<usize, Refusal> {
        let old = "WHERE keep_day < ?1 OR withdrawn_at < ?2 ORDER BY id LIMIT ?3";
        let withdrawn_before = days_before(now, self.plan.withdrawn_days);
        let mut count = 0;
        loop {
            let buried = self.update(|tx| {
                let values: [&dyn ToValue; 3] = [&now.day(), &withdrawn_before, &SWEEP_BATCH];
                let old: Vec<Sculpture> = tx.find(old, &values)?;
                for sculpture in &old {
                    self.bury(tx, sculpture, now)?;
                    note(tx, now, None, "delete by age", subject_of_buried(sculpture))?;
                }
                Ok(old.len())
            })?;
            count += buried;
            if buried < SWEEP_BATCH {
                return Ok(count);
            }
        }
    }

    fn drop_old_traces(&self, now: BoothTime) -> Result<usize, Refusal> {
        let before = days_before(now, self.plan.trace_days);
        let old = "WHERE received_at < ?1 AND has_trace = 1 ORDER BY id LIMIT ?2";
        let old: Vec<Sculpture> = self.view(|tx| tx.find(old, &[&before, &SWEEP_BATCH]))?;
        for Sculpture { id, hash, .. } in &old {
            // The file first: a record that says there is none is never wrong.
            self.files.remove_kept(&kept_name(id, hash, KeptPart::Trace))?;
            self.update(|tx| {
                tx.run("UPDATE sculptures SET has_trace = 0 WHERE id = ?1", &[id])?;
                Ok(())
            })?;
        }
        Ok(old.len())
    }

    /// Logs what was deleted, and removes its files. A copy of the booth that lacks a file lacks no line of the log then.
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

/// The time so many days ago.
fn days_before(now: BoothTime, days: u16) -> BoothTime {
    BoothTime(now.0.saturating_sub((DAY * u32::from(days)).as_millis() as u64))
}

fn is_withdrawn_too_long(sculpture: &Sculpture, days: u16, now: BoothTime) -> bool {
    sculpture.withdrawn_at.is_some_and(|withdrawn_at| withdrawn_at < days_before(now, days))
}

pub(crate) fn get_kept(
    tx: &mut Tx<'_>,
    id: &SculptureId,
    now: BoothTime,
) -> Result<Sculpture, Refusal> {
    let found: Option<Sculpture> = tx.get(&[&id.0])?;
    found.filter(|found| found.keep_day >= now.day()).ok_or(NO_SCULPTURE)
}

pub(crate) fn subject_of(sculpture: &Sculpture) -> Subject {
    Subject {
        headset: Some(sculpture.headset),
        sculpture: Some(sculpture.id),
        badge: sculpture.badge,
    }
}

/// Of a sculpture that was deleted: its badge is another's soon.
pub(crate) fn subject_of_buried(sculpture: &Sculpture) -> Subject {
    Subject { badge: None, ..subject_of(sculpture) }
}
