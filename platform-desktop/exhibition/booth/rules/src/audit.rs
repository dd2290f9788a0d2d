//! The audit: who did what, when. Addresses are never in it.

use crate::booth::{Booth, Tx};
use crate::limits::SWEEP_BATCH;
use crate::records::AuditEntry;
use crate::refusal::Refusal;
use crate::store::{Query, RowOrder, StoreError};
use crate::time::BoothTime;
use crate::value::Field as _;

/// What an entry is about.
#[derive(Clone, Copy, Default, Debug)]
pub(crate) struct Subject {
    pub(crate) headset: Option<u32>,
    pub(crate) sculpture: Option<[u8; 16]>,
    pub(crate) badge: Option<u32>,
}

impl Booth {
    /// The newest entries, the last one first.
    ///
    /// # Errors
    /// Those of the store.
    pub fn list_audit(&self, limit: usize) -> Result<Vec<AuditEntry>, Refusal> {
        self.list_audit_before(BoothTime(u64::MAX), limit)
    }

    /// The newest entries of before a time, the last one first.
    ///
    /// # Errors
    /// Those of the store.
    pub fn list_audit_before(
        &self,
        before: BoothTime,
        limit: usize,
    ) -> Result<Vec<AuditEntry>, Refusal> {
        let query = Query::all::<AuditEntry>().below("at", &before);
        self.view(|tx| tx.find(&query.ordered("at", RowOrder::Descending).first(limit)))
    }
}

/// Takes the badge out of what was done with a sculpture: it is another's soon.
pub(crate) fn forget_badge(tx: &mut Tx<'_>, sculpture: &[u8; 16]) -> Result<(), StoreError> {
    let of_sculpture = Query::all::<AuditEntry>().equal("sculpture", &Some(*sculpture));
    for mut entry in tx.find::<AuditEntry>(&of_sculpture)? {
        if entry.badge.take().is_some() {
            tx.put(&entry)?;
        }
    }
    Ok(())
}

/// Removes the oldest entries that are from before a time, and returns how many.
pub(crate) fn drop_old_entries(tx: &mut Tx<'_>, before: BoothTime) -> Result<usize, StoreError> {
    let old = Query::all::<AuditEntry>().below("at", &before).first(SWEEP_BATCH);
    let old: Vec<AuditEntry> = tx.find(&old)?;
    for entry in &old {
        tx.remove::<AuditEntry>(&[entry.at.to_value(), entry.number.to_value()])?;
    }
    Ok(old.len())
}

/// Notes that something was done; by nobody where the booth did it by itself.
pub(crate) fn note(
    tx: &mut Tx<'_>,
    now: BoothTime,
    account: Option<&str>,
    action: &str,
    subject: Subject,
) -> Result<(), StoreError> {
    // The first number of this time that is free.
    let mut number = 0u64;
    while tx.get::<AuditEntry>(&[now.to_value(), number.to_value()])?.is_some() {
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
