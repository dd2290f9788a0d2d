//! The audit: who did what, when. Addresses are never in it.

use crate::booth::{Booth, Tx};
use crate::records::AuditEntry;
use crate::refusal::Refusal;
use crate::store::{Order, Query, StoreError};
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
        let query = Query::all::<AuditEntry>().ordered("at", Order::Descending).first(limit);
        self.view(|tx| tx.find(&query))
    }
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
