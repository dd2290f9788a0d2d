//! The audit log: who did what, and when. Addresses are never in it.

use crate::booth::{Booth, Tx};
use crate::limits::SWEEP_BATCH;
use crate::records::AuditEntry;
use crate::refusal::Refusal;
use crate::store::StoreError;
use crate::time::BoothTime;

/// The subject of an audit entry.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct Subject {
    pub(crate) headset: Option<u32>,
    pub(crate) sculpture: Option<[u8; 16]>,
    pub(crate) badge: Option<u32>,
}

impl Booth {
    /// Returns the newest entries, the latest first.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_audit(&self, limit: usize) -> Result<Vec<AuditEntry>, Refusal> {
        self.list_audit_before(BoothTime(u64::MAX), limit)
    }

    /// Returns the newest entries before a time, the latest first.
    ///
    /// # Errors
    /// Store errors.
    pub fn list_audit_before(
        &self,
        before: BoothTime,
        limit: usize,
    ) -> Result<Vec<AuditEntry>, Refusal> {
        let newest = "WHERE at < ?1 ORDER BY at DESC, number LIMIT ?2";
        self.view(|tx| tx.find(newest, &[&before, &limit]))
    }
}

/// Removes the oldest entries before a time, up to [`SWEEP_BATCH`] of them.
pub(crate) fn drop_old_entries(tx: &mut Tx<'_>, before: BoothTime) -> Result<(), StoreError> {
    let oldest = "DELETE FROM audit WHERE (at, number) IN
        (SELECT at, number FROM audit WHERE at < ?1 ORDER BY at LIMIT ?2)";
    tx.run(oldest, &[&before, &SWEEP_BATCH]).map(drop)
}

/// Adds an entry to the audit log. `account` is `None` if the booth acted by itself.
pub(crate) fn note(
    tx: &mut Tx<'_>,
    now: BoothTime,
    account: Option<&str>,
    action: &str,
    subject: Subject,
) -> Result<(), StoreError> {
    // Find the first free number of this time.
    let mut number = 0u64;
    while tx.get::<AuditEntry>(&[&now, &number])?.is_some() {
        number += 1;
    }
    let Subject { headset, sculpture, badge } = subject;
    tx.put(&AuditEntry {
        at: now,
        number,
        account: account.map(str::to_owned),
        action: action.to_owned(),
        headset,
        sculpture,
        badge,
    })
}
