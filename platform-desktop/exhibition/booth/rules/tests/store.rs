//! The store in memory does what every store does; and what is in conflict is tried again.

use std::sync::atomic::{AtomicU32, Ordering};

use paros_booth_rules::records::{WorkKind, WorkLease};
use paros_booth_rules::{
    Access, BoothTime, MemoryStore, Query, Reason, Refusal, Row, Store, StoreError, Table,
    Transaction, Value, check_store, update, view,
};

#[test]
fn the_store_in_memory_is_one() {
    check_store(MemoryStore::new);
}

/// A store in which so many transactions are in conflict with others, at the first row that they put.
struct BusyStore {
    inner: MemoryStore,
    conflicts: AtomicU32,
}

struct BusyTransaction<'a> {
    inner: Box<dyn Transaction + 'a>,
    conflicts: &'a AtomicU32,
    is_in_conflict: bool,
}

impl Store for BusyStore {
    fn begin(&self, access: Access) -> Result<Box<dyn Transaction + '_>, StoreError> {
        let (inner, conflicts) = (self.inner.begin(access)?, &self.conflicts);
        Ok(Box::new(BusyTransaction { inner, conflicts, is_in_conflict: false }))
    }
}

impl Transaction for BusyTransaction<'_> {
    fn get_row(&mut self, table: &'static Table, key: &[Value]) -> Result<Option<Row>, StoreError> {
        self.inner.get_row(table, key)
    }

    fn find_rows(&mut self, query: &Query) -> Result<Vec<Row>, StoreError> {
        self.inner.find_rows(query)
    }

    fn count_rows(&mut self, query: &Query) -> Result<u64, StoreError> {
        self.inner.count_rows(query)
    }

    fn put_row(&mut self, table: &'static Table, row: Row) -> Result<(), StoreError> {
        let left = self.conflicts.load(Ordering::Relaxed);
        if left > 0 {
            self.conflicts.store(left - 1, Ordering::Relaxed);
            self.is_in_conflict = true;
            return Err(StoreError::Conflict);
        }
        self.inner.put_row(table, row)
    }

    fn remove_row(&mut self, table: &'static Table, key: &[Value]) -> Result<(), StoreError> {
        self.inner.remove_row(table, key)
    }

    fn commit(self: Box<Self>) -> Result<(), StoreError> {
        if self.is_in_conflict { Err(StoreError::Conflict) } else { self.inner.commit() }
    }

    fn is_in_conflict(&self) -> bool {
        self.is_in_conflict
    }
}

/// Puts a row, and says how often that was tried and what came of it.
fn put_once(conflicts: u32, passes_over: bool) -> (u32, Result<(), Refusal>, u64) {
    let store = BusyStore { inner: MemoryStore::new(), conflicts: AtomicU32::new(conflicts) };
    let (kind, subject, until) = (WorkKind::Export, vec![1], BoothTime(0));
    let row = WorkLease { kind, subject, worker: 1, until };
    let mut tries = 0;
    let done = update(&store, |tx| {
        tries += 1;
        match tx.put(&row) {
            Err(_) if passes_over => Ok(()),
            // Rules make something else of what a store says.
            Err(_) => Err(Refusal::Conflict(Reason::NoSculpture)),
            Ok(()) => Ok(()),
        }
    });
    let rows =
        view(&store, |tx| tx.count_rows(&Query::all::<WorkLease>())).expect("it is in memory");
    (tries, done, rows)
}

#[test]
fn work_in_conflict_is_tried_again_whatever_it_made_of_it() {
    for passes_over in [false, true] {
        let (tries, done, rows) = put_once(5, passes_over);
        done.expect("the sixth time nobody was in its way");
        assert_eq!((tries, rows), (6, 1));
        let (tries, done, rows) = put_once(1000, passes_over);
        assert!(done.is_err());
        assert!((2..100).contains(&tries), "{tries} tries");
        assert_eq!(rows, 0);
    }
}
