//! Work leases, for several booth processes on the same records. A process leases each piece of work, so that
//! it is done once. If a process dies, its leases expire and others take over.

use crate::booth::{Booth, Tx};
use crate::limits::WORK_LIFE;
use crate::records::{WorkKind, WorkLease};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;

impl Booth {
    /// Makes the booth one of several processes on the same records, identified by random `worker` bits.
    #[must_use]
    pub fn as_worker(mut self, worker: u64) -> Self {
        self.worker = worker;
        self
    }

    /// Deletes all leases, at the start of a booth that runs alone: the previous holders are dead.
    ///
    /// # Errors
    /// Store errors.
    pub fn drop_leases(&self) -> Result<(), Refusal> {
        self.update(|tx| {
            tx.run("DELETE FROM work_leases", &[])?;
            Ok(())
        })
    }

    /// Renews the lease of work that takes longer than [`WORK_LIFE`]. Returns `true` if this process still
    /// holds the lease.
    ///
    /// # Errors
    /// Store errors.
    pub fn renew_work(
        &self,
        kind: WorkKind,
        subject: &[u8],
        now: BoothTime,
    ) -> Result<bool, Refusal> {
        self.update(|tx| {
            let is_own = self.is_own_work(tx, kind, subject)?;
            Ok(is_own && self.begin_work(tx, kind, subject, now)?)
        })
    }

    /// Gives up the lease of work that this process can't do now.
    ///
    /// # Errors
    /// Store errors.
    pub fn leave_work(&self, kind: WorkKind, subject: &[u8]) -> Result<(), Refusal> {
        self.update(|tx| Ok(self.end_own_work(tx, kind, subject)?))
    }

    /// Ends the lease of some work if this process holds it.
    pub(crate) fn end_own_work(
        &self,
        tx: &mut Tx<'_>,
        kind: WorkKind,
        subject: &[u8],
    ) -> Result<(), StoreError> {
        if self.is_own_work(tx, kind, subject)? { end_work(tx, kind, subject) } else { Ok(()) }
    }

    fn is_own_work(
        &self,
        tx: &mut Tx<'_>,
        kind: WorkKind,
        subject: &[u8],
    ) -> Result<bool, StoreError> {
        let lease: Option<WorkLease> = tx.get(&[&kind, &subject])?;
        Ok(lease.is_some_and(|lease| lease.worker == self.worker))
    }

    /// Leases some work to this process for [`WORK_LIFE`]; `false` if another process holds the lease.
    pub(crate) fn begin_work(
        &self,
        tx: &mut Tx<'_>,
        kind: WorkKind,
        subject: &[u8],
        now: BoothTime,
    ) -> Result<bool, StoreError> {
        let until = now.after(WORK_LIFE);
        let lease: Option<WorkLease> = tx.get(&[&kind, &subject])?;
        // Clocks of machines differ a little. A lease that ends much later was written with a wrong clock,
        // and is ignored.
        let latest = until.after(WORK_LIFE);
        let is_anothers = |lease: &WorkLease| {
            lease.worker != self.worker && now < lease.until && lease.until <= latest
        };
        if lease.as_ref().is_some_and(is_anothers) {
            return Ok(false);
        }
        tx.put(&WorkLease { kind, subject: subject.to_vec(), worker: self.worker, until })?;
        Ok(true)
    }
}

/// Deletes expired leases, such as those of deleted records.
pub(crate) fn drop_old_leases(tx: &mut Tx<'_>, now: BoothTime) -> Result<(), StoreError> {
    tx.run("DELETE FROM work_leases WHERE until < ?1", &[&now]).map(drop)
}

/// Ends the lease of some work, whoever holds it.
pub(crate) fn end_work(tx: &mut Tx<'_>, kind: WorkKind, subject: &[u8]) -> Result<(), StoreError> {
    tx.run("DELETE FROM work_leases WHERE kind = ?1 AND subject = ?2", &[&kind, &subject]).map(drop)
}
