//! Stores: possible differences between databases; and conflicts, after which work is retried.

use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use paros_booth_rules::records::{
    Account, BadgeCursor, Device, EnrolToken, ExportState, MailOrder, MailState, Sculpture,
    StaffRole, WorkKind, WorkLease,
};
use paros_booth_rules::{
    Access, BoothTime, Reason, Refusal, Row, Store, StoreError, Transaction, Value, update, view,
};
use paros_core::session::SessionMode;

fn must<T>(done: Result<T, StoreError>) -> T {
    done.unwrap_or_else(|error| panic!("a store that works: {error}"))
}

fn sculpture(number: u8, claimed_badge: Option<u32>) -> Sculpture {
    Sculpture {
        id: [number; 16],
        headset: 1,
        hash: [7; 32],
        badge: Some(1),
        claimed_badge,
        pictures: u64::MAX,
        language: *b"el",
        mode: SessionMode::Constrained { figure: number },
        facts: vec![number, 0, 255],
        received_at: BoothTime(1000),
        keep_day: 100,
        withdrawn_at: None,
        has_trace: false,
        export: ExportState::Queued,
        link_generation: 0,
        is_link_revoked: false,
    }
}

fn token(number: u8, note: &str) -> EnrolToken {
    EnrolToken {
        token_hash: [number; 32],
        note: note.into(),
        expires_at: BoothTime(0),
        uses_left: 0,
        is_revoked: true,
    }
}

fn all_sculptures(store: &dyn Store) -> Vec<Sculpture> {
    must(view(store, |tx| tx.find("ORDER BY id", &[])))
}

#[test]
fn the_least_and_the_greatest_values_are_kept() {
    let store = crate::new_store();
    for order in [0, 1, u64::MAX, u64::MAX / 2, u64::MAX / 2 + 1] {
        let mail = MailOrder {
            order,
            sculpture: [255; 16],
            address: None,
            language: 255,
            asked_at: BoothTime(i64::MAX as u64),
            state: MailState::Queued,
            tries: u32::MAX,
            next_try_at: BoothTime(0),
            why: String::new(),
            keeps_address: false,
        };
        must(update(store.as_ref(), |tx| tx.put(&mail)));
        assert_eq!(must(view(store.as_ref(), |tx| tx.get(&[&order]))), Some(mail));
    }
    let device = Device {
        headset: 0,
        token_hash: [0; 32],
        hint: [0; 16],
        name: String::new(),
        enrolled_at: BoothTime(0),
        revoked_at: None,
        wiped_at: Some(BoothTime(0)),
        seen_at: None,
        status: (0..200_000u32).map(|k| k as u8).collect(),
    };
    must(update(store.as_ref(), |tx| tx.put(&device)));
    assert_eq!(must(view(store.as_ref(), |tx| tx.get(&[&0u32]))), Some(device));
}

#[test]
fn hostile_text_is_text_and_one_with_a_nul_is_nowhere() {
    let store = crate::new_store();
    for (k, text) in ["'; DROP TABLE devices; --", "\" OR 1=1", "<b>&amp;", "\u{fffd}%_\\?1", "ά"]
        .into_iter()
        .enumerate()
    {
        let token = token(k as u8, text);
        must(update(store.as_ref(), |tx| tx.put(&token)));
        let found = view(store.as_ref(), |tx| tx.find("WHERE note = ?1", &[&text]));
        assert_eq!(must::<Vec<EnrolToken>>(found), [token], "{text}");
    }
    let put = update(store.as_ref(), |tx| tx.put(&token(9, "a\0b")));
    assert!(put.is_err(), "a text with a NUL");
    must(update(store.as_ref(), |tx| {
        assert_eq!(tx.count::<EnrolToken>("WHERE note = ?1", &[&"a\0b"])?, 0);
        assert_eq!(tx.get::<Account>(&[&"a\0b"])?, None);
        tx.run("DELETE FROM accounts WHERE name = ?1", &[&"a\0b"])?;
        assert_eq!(tx.count::<EnrolToken>("", &[])?, 5);
        Ok::<_, StoreError>(())
    }));
}

#[test]
fn text_is_ordered_by_its_bytes() {
    let store = crate::new_store();
    let names = ["B", "Z", "a", "b", "z", "ά"];
    for name in names.into_iter().rev() {
        let (name, password_hash) = (name.to_owned(), String::new());
        let account = Account { name, password_hash, role: StaffRole::Admin, is_disabled: false };
        must(update(store.as_ref(), |tx| tx.put(&account)));
    }
    let sorted: Vec<Account> = must(view(store.as_ref(), |tx| tx.find("ORDER BY name", &[])));
    assert!(sorted.iter().map(|account| account.name.as_str()).eq(names), "{sorted:?}");
}

#[test]
fn a_transaction_that_is_not_committed_leaves_no_trace() {
    let store = crate::new_store();
    must(update(store.as_ref(), |tx| tx.put(&sculpture(1, Some(1)))));
    let refused: Result<(), StoreError> = update(store.as_ref(), |tx| {
        tx.put(&sculpture(2, Some(2)))?;
        tx.put(&Sculpture { badge: None, ..sculpture(1, None) })?;
        tx.run("DELETE FROM sculptures WHERE id = ?1", &[&[1u8; 16]])?;
        // A transaction sees its own changes.
        assert_eq!(tx.find::<Sculpture>("", &[])?, [sculpture(2, Some(2))]);
        Err(StoreError::Failed("work that fails".into()))
    });
    assert!(refused.is_err());
    assert_eq!(all_sculptures(store.as_ref()), [sculpture(1, Some(1))]);
    let put: Result<(), StoreError> = view(store.as_ref(), |tx| tx.put(&sculpture(3, None)));
    assert!(put.is_err(), "a row was put while reading");
    assert_eq!(all_sculptures(store.as_ref()).len(), 1);
}

#[test]
fn values_of_another_kind_are_refused() {
    let store = crate::new_store();
    must(update(store.as_ref(), |tx| tx.put(&sculpture(1, None))));
    for value in [Value::Null, Value::Text("three".into()), Value::Bytes(vec![3])] {
        let set = "UPDATE sculptures SET headset = ?1";
        let set = update(store.as_ref(), |tx| tx.query(set, std::slice::from_ref(&value)));
        assert!(set.is_err(), "{value:?}");
    }
    assert_eq!(all_sculptures(store.as_ref()), [sculpture(1, None)]);
}

/// No two sculptures can claim the same badge; any number can have no claim.
#[test]
fn a_claimed_badge_is_taken() {
    let store = crate::new_store();
    let put = |sculpture: &Sculpture| update(store.as_ref(), |tx| tx.put(sculpture));
    must(put(&sculpture(1, Some(1))));
    assert!(put(&sculpture(2, Some(1))).is_err(), "a claimed badge is claimed again");
    assert_eq!(
        all_sculptures(store.as_ref()),
        [sculpture(1, Some(1))],
        "the first one is as it was"
    );
    for (number, badge) in [(1, Some(1)), (3, None), (4, None), (1, None), (2, Some(1))] {
        must(put(&sculpture(number, badge)));
    }
}

/// Threads increment a number concurrently: no increment is lost.
#[test]
fn threads_count_in_turn() {
    const THREADS: u16 = 4;
    const COUNTS: u16 = 10;
    let store = crate::new_store();
    must(update(store.as_ref(), |tx| tx.put(&BadgeCursor::new())));
    let count_up = |tx: &mut (dyn Transaction + '_)| -> Result<(), StoreError> {
        let mut cursor: BadgeCursor = tx.get(&[&0u8])?.expect("it was put");
        cursor.turn += 1;
        tx.put(&cursor)
    };
    std::thread::scope(|scope| {
        for _ in 0..THREADS {
            scope.spawn(|| (0..COUNTS).for_each(|_| must(update(store.as_ref(), count_up))));
        }
    });
    let cursor: Option<BadgeCursor> = must(view(store.as_ref(), |tx| tx.get(&[&0u8])));
    assert_eq!(cursor.expect("it was put").turn, THREADS * COUNTS, "a change was lost");
}

/// A store whose first `conflicts` transactions fail with a conflict, at their first `put`.
struct BusyStore {
    inner: Arc<dyn Store>,
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
    fn query(&mut self, sql: &str, values: &[Value]) -> Result<Vec<Row>, StoreError> {
        let left = self.conflicts.load(Ordering::Relaxed);
        if sql.starts_with("INSERT") && left > 0 {
            self.conflicts.store(left - 1, Ordering::Relaxed);
            self.is_in_conflict = true;
            return Err(StoreError::Conflict);
        }
        self.inner.query(sql, values)
    }

    fn commit(self: Box<Self>) -> Result<(), StoreError> {
        if self.is_in_conflict { Err(StoreError::Conflict) } else { self.inner.commit() }
    }

    fn is_in_conflict(&self) -> bool {
        self.is_in_conflict
    }
}

/// Puts a row. Returns the number of tries, the result, and the number of rows.
fn put_once(conflicts: u32, passes_over: bool) -> (u32, Result<(), Refusal>, u64) {
    let store = BusyStore { inner: crate::new_store(), conflicts: AtomicU32::new(conflicts) };
    let (kind, subject, until) = (WorkKind::Export, vec![1], BoothTime(0));
    let row = WorkLease { kind, subject, worker: 1, until };
    let mut tries = 0;
    let done = update(&store, |tx| {
        tries += 1;
        match tx.put(&row) {
            Err(_) if passes_over => Ok(()),
            // Rules map store errors to other errors.
            Err(_) => Err(Refusal::Conflict(Reason::NoSculpture)),
            Ok(()) => Ok(()),
        }
    });
    (tries, done, must(view(&store, |tx| tx.count::<WorkLease>("", &[]))))
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
