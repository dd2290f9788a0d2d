//! Work that is done once though several booths are at the same records: each takes a lease of what it does, and of
//! one that dies the others take it over.

use crate::booth::{Booth, Tx};
use crate::limits::WORK_LIFE;
use crate::records::{WorkKind, WorkLease};
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;

impl Booth {
    /// The same booth as one of several on the same records. `worker` is random bits.
    #[must_use]
    pub fn as_worker(mut self, worker: u64) -> Self {
        self.worker = worker;
        self
    }

    /// Forgets all leases, at the start of one that is alone: who had them is dead.
    ///
    /// # Errors
    /// Those of the store.
    pub fn drop_leases(&self) -> Result<(), Refusal> {
        self.update(|tx| {
            tx.run("DELETE FROM work_leases", &[])?;
            Ok(())
        })
    }

    /// Goes on with work that takes longer than [`WORK_LIFE`]. Returns whether it is this process' still.
    ///
    /// # Errors
    /// Those of the store.
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

    /// Leaves work that this process has taken to others, as it can't do it now.
    ///
    /// # Errors
    /// Those of the store.
    pub fn leave_work(&self, kind: WorkKind, subject: &[u8]) -> Result<(), Refusal> {
        self.update(|tx| Ok(self.end_own_work(tx, kind, subject)?))
    }

    /// Ends some work if this process has it.
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

    /// Takes some work upon this process for [`WORK_LIFE`], unless another one has it.
    pub(crate) fn begin_work(
        &self,
        tx: &mut Tx<'_>,
        kind: WorkKind,
        subject: &[u8],
        now: BoothTime,
    ) -> Result<bool, StoreError> {
        let until = now.after(WORK_LIFE);
        let lease: Option<WorkLease> = tx.get(&[&kind, &subject])?;
        // Clocks of machines differ a little; one that ends far later was taken by a clock that went wrong.
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

/// Forgets leases that are over: of what is deleted nobody asks any more.
pub(crate) fn drop_old_leases(tx: &mut Tx<'_>, now: BoothTime) -> Result<(), StoreError> {
    tx.run("DELETE FROM work_leases WHERE until < ?1", &[&now]).map(drop)
}

/// Ends some work, whoever did it.
pub(crate) fn end_work(tx: &mut Tx<'_>, kind: WorkKind, subject: &[u8]) -> Result<(), StoreError> {
    tx.run("DELETE FROM work_leases WHERE kind = ?1 AND subject = ?2", &[&kind, &subject]).map(drop)
}
