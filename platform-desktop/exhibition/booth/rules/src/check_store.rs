//! What every store has to do: the suite that each one's tests call.

use crate::records::{
    Account, BadgeCursor, Device, EnrolToken, ExportState, MailOrder, MailState, Sculpture, TABLES,
};
use crate::store::{Access, Query, RowOrder, Store, StoreError, Transaction, update, view};
use crate::table::{Record, Row, Table};
use crate::time::BoothTime;
use crate::value::{ColumnKind, Field, Value};

/// Checks a store; `make` makes one without rows.
///
/// # Panics
/// With what the store did wrong.
pub fn check_store<S: Store>(mut make: impl FnMut() -> S) {
    keeps_every_table(&make());
    keeps_extremes(&make());
    keeps_hostile_text(&make());
    replaces_by_key(&make());
    drops_what_is_not_committed(&make());
    refuses_changes_while_reading(&make());
    refuses_rows_of_other_tables(&make());
    refuses_what_is_taken(&make());
    finds_what_is_asked_for(&make());
    never_takes_nothing_for_something(&make());
    counts_in_turn(&make());
}

/// A row of a table, other ones for other seeds.
fn sample_row(table: &Table, seed: i64) -> Row {
    let value = |(k, column): (usize, &crate::table::Column)| match column.kind {
        _ if column.is_nullable && (seed as usize + k).is_multiple_of(3) => Value::Null,
        ColumnKind::Number => Value::Number(seed * 1000 + k as i64),
        ColumnKind::Bytes => Value::Bytes(vec![seed as u8, k as u8, 0, 255]),
        ColumnKind::Text => Value::Text(format!("{seed}: γλυπτό {k}")),
    };
    table.columns.iter().enumerate().map(value).collect()
}

fn sample_sculpture(number: u8) -> Sculpture {
    Sculpture {
        id: [number; 16],
        headset: u32::from(number % 3),
        hash: [7; 32],
        badge: Some(u32::from(number / 2)),
        claimed_badge: Some(u32::from(number)),
        facts: vec![number; 5],
        received_at: BoothTime(1000 - u64::from(number)),
        keep_day: 100,
        withdrawn_at: (number % 2 == 1).then_some(BoothTime(u64::from(number))),
        has_trace: false,
        export: ExportState::Queued,
        link_generation: 0,
        is_link_revoked: false,
    }
}

fn put_row(store: &dyn Store, table: &'static Table, row: &Row) {
    must(update(store, |tx| tx.put_row(table, row.clone())));
}

fn all_sculptures(store: &dyn Store) -> Vec<Sculpture> {
    must(view(store, |tx| tx.find(&Query::all::<Sculpture>())))
}

fn must<T>(done: Result<T, StoreError>) -> T {
    done.unwrap_or_else(|error| panic!("a store that works: {error}"))
}

fn keeps_every_table(store: &dyn Store) {
    for table in TABLES {
        let rows: Vec<Row> = (0..5).map(|seed| sample_row(table, seed)).collect();
        for row in &rows {
            put_row(store, table, row);
        }
        for row in &rows {
            let found = must(view(store, |tx| tx.get_row(table, &row[..table.key_columns])));
            assert_eq!(found.as_ref(), Some(row), "table {}", table.name);
        }
        let first = &rows[0][..table.key_columns];
        must(update(store, |tx| tx.remove_row(table, first)));
        assert_eq!(must(view(store, |tx| tx.get_row(table, first))), None, "{}", table.name);
        // A second time there is nothing to remove.
        must(update(store, |tx| tx.remove_row(table, first)));
    }
}

fn keeps_extremes(store: &dyn Store) {
    let mails: Vec<MailOrder> = [0, 1, u64::MAX, u64::MAX / 2, u64::MAX / 2 + 1]
        .map(|order| MailOrder {
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
        })
        .into();
    let long = Device {
        headset: 0,
        token_hash: [0; 32],
        hint: [0; 16],
        name: String::new(),
        enrolled_at: BoothTime(0),
        revoked_at: None,
        wiped_at: None,
        seen_at: None,
        status: (0..200_000u32).map(|k| k as u8).collect(),
    };
    must(update(store, |tx| {
        tx.put(&long)?;
        mails.iter().try_for_each(|mail| tx.put(mail))
    }));
    for mail in mails {
        let found = must(view(store, |tx| tx.get(&[mail.order.to_value()])));
        assert_eq!(found, Some(mail));
    }
    assert_eq!(must(view(store, |tx| tx.get(&[long.headset.to_value()]))), Some(long));
}

fn keeps_hostile_text(store: &dyn Store) {
    for (k, text) in ["'; DROP TABLE devices; --", "\" OR 1=1", "<b>&amp;", "\u{fffd}%_\\", "ά"]
        .into_iter()
        .enumerate()
    {
        let token = EnrolToken {
            token_hash: [k as u8; 32],
            note: text.into(),
            expires_at: BoothTime(0),
            uses_left: 0,
            is_revoked: true,
        };
        must(update(store, |tx| tx.put(&token)));
        let query = Query::all::<EnrolToken>().equal("note", &text.to_string());
        assert_eq!(must(view(store, |tx| tx.find::<EnrolToken>(&query))), [token], "{text}");
    }
    // What no row can have is had by none.
    let query = Query::all::<EnrolToken>().equal("note", &"a\0".to_string());
    assert_eq!(must(view(store, |tx| tx.find::<EnrolToken>(&query))), []);
    assert_eq!(must(view(store, |tx| tx.count_rows(&query))), 0);
    let key = ["a\0".to_string().to_value()];
    assert_eq!(must(view(store, |tx| tx.get::<Account>(&key))), None);
    must(update(store, |tx| tx.remove::<Account>(&key)));
    assert_eq!(must(view(store, |tx| tx.count_rows(&Query::all::<EnrolToken>()))), 5);
}

fn replaces_by_key(store: &dyn Store) {
    let mut sculpture = sample_sculpture(1);
    must(update(store, |tx| tx.put(&sculpture)));
    (sculpture.badge, sculpture.withdrawn_at) = (Some(77), None);
    must(update(store, |tx| tx.put(&sculpture)));
    assert_eq!(all_sculptures(store), [sculpture]);
}

fn drops_what_is_not_committed(store: &dyn Store) {
    put_row(store, Sculpture::TABLE, &sample_sculpture(1).to_row());
    let refused: Result<(), StoreError> = update(store, |tx| {
        tx.put(&sample_sculpture(2))?;
        tx.put(&Sculpture { badge: None, ..sample_sculpture(1) })?;
        tx.remove::<Sculpture>(&[[1u8; 16].to_value()])?;
        // It sees its own changes.
        assert_eq!(tx.find::<Sculpture>(&Query::all::<Sculpture>())?, [sample_sculpture(2)]);
        Err(StoreError::Failed("work that fails".into()))
    });
    assert!(refused.is_err());
    let all = all_sculptures(store);
    assert_eq!(all, [sample_sculpture(1)], "a transaction that was dropped left a trace");
}

fn refuses_changes_while_reading(store: &dyn Store) {
    let put: Result<(), StoreError> = view(store, |tx| tx.put(&sample_sculpture(1)));
    assert!(put.is_err(), "a row was put while reading");
    assert_eq!(must(view(store, |tx| tx.count_rows(&Query::all::<Sculpture>()))), 0);
}

fn refuses_rows_of_other_tables(store: &dyn Store) {
    let mut short = sample_sculpture(1).to_row();
    short.pop();
    let mut null = sample_sculpture(1).to_row();
    null[1] = Value::Null;
    let mut text = sample_sculpture(1).to_row();
    text[1] = Value::Text("3".into());
    let token = EnrolToken {
        token_hash: [0; 32],
        note: "a\0b".into(),
        expires_at: BoothTime(0),
        uses_left: 0,
        is_revoked: false,
    };
    let put = update(store, |tx| tx.put(&token));
    assert!(put.is_err(), "a text with a NUL");
    for row in [short, null, text] {
        let put = update(store, |tx| tx.put_row(Sculpture::TABLE, row.clone()));
        assert!(put.is_err(), "{row:?}");
    }
}

/// No two rows have the same value in a unique column, and any number has none.
fn refuses_what_is_taken(store: &dyn Store) {
    put_row(store, Sculpture::TABLE, &sample_sculpture(1).to_row());
    let second = Sculpture { claimed_badge: Some(1), ..sample_sculpture(2) };
    assert!(update(store, |tx| tx.put(&second)).is_err(), "a claimed badge is claimed again");
    assert_eq!(all_sculptures(store), [sample_sculpture(1)], "the first one is as it was");
    put_row(store, Sculpture::TABLE, &sample_sculpture(1).to_row());
    for number in [3, 4] {
        let without = Sculpture { claimed_badge: None, ..sample_sculpture(number) };
        put_row(store, Sculpture::TABLE, &without.to_row());
    }
    must(update(store, |tx| tx.remove::<Sculpture>(&[[1u8; 16].to_value()])));
    put_row(store, Sculpture::TABLE, &second.to_row());
}

fn finds_what_is_asked_for(store: &dyn Store) {
    for number in [5, 1, 4, 2, 0, 3] {
        put_row(store, Sculpture::TABLE, &sample_sculpture(number).to_row());
    }
    let all = Query::all::<Sculpture>;
    let cases: [(Query, &[u8]); 13] = [
        (all(), &[0, 1, 2, 3, 4, 5]),
        (all().first(2), &[0, 1]),
        (all().first(0), &[]),
        (all().equal("badge", &Some(1u32)), &[2, 3]),
        (all().absent("badge"), &[]),
        (all().equal("badge", &1u32).equal("headset", &2u32), &[2]),
        (all().absent("withdrawn_at"), &[0, 2, 4]),
        (all().present("withdrawn_at").ordered("received_at", RowOrder::Ascending), &[5, 3, 1]),
        (all().ordered("received_at", RowOrder::Descending).first(3), &[0, 1, 2]),
        // Equal ones by their key.
        (all().ordered("headset", RowOrder::Descending), &[2, 5, 1, 4, 0, 3]),
        (all().below("withdrawn_at", &BoothTime(3)), &[1]),
        (all().at_least("withdrawn_at", &BoothTime(3)), &[3, 5]),
        (all().at_least("claimed_badge", &2u32).below("claimed_badge", &4u32), &[2, 3]),
    ];
    for (query, expected) in cases {
        let found: Vec<Sculpture> = must(view(store, |tx| tx.find(&query)));
        let numbers: Vec<u8> = found.iter().map(|sculpture| sculpture.id[0]).collect();
        assert_eq!(numbers, expected, "{query:?}");
        let unlimited = Query { limit: usize::MAX, ..query.clone() };
        let all_found = must(view(store, |tx| tx.find::<Sculpture>(&unlimited))).len() as u64;
        assert_eq!(must(view(store, |tx| tx.count_rows(&query))), all_found, "{query:?}");
    }
    let unknown = Query::all::<Sculpture>().equal("no_such_column", &1u32);
    assert!(view(store, |tx| tx.find_rows(&unknown)).is_err());
}

fn never_takes_nothing_for_something(store: &dyn Store) {
    put_row(store, Sculpture::TABLE, &sample_sculpture(0).to_row());
    let below = Query::all::<Sculpture>().below("withdrawn_at", &BoothTime(u64::MAX));
    assert_eq!(must(view(store, |tx| tx.count_rows(&below))), 0, "nothing is below nothing");
    let equal = Query::all::<Sculpture>().equal("withdrawn_at", &BoothTime(0));
    assert_eq!(must(view(store, |tx| tx.count_rows(&equal))), 0);
}

/// Threads that each read a number and write one more: none is lost.
fn counts_in_turn(store: &dyn Store) {
    const THREADS: usize = 4;
    const COUNTS: usize = 10;
    put_row(store, BadgeCursor::TABLE, &BadgeCursor::new().to_row());
    let count_up = |tx: &mut (dyn Transaction + '_)| -> Result<(), StoreError> {
        let mut cursor: BadgeCursor = tx.get(&[0u8.to_value()])?.expect("it was put");
        cursor.turn += 1;
        tx.put(&cursor)
    };
    std::thread::scope(|scope| {
        for _ in 0..THREADS {
            scope.spawn(|| (0..COUNTS).for_each(|_| must(update(store, count_up))));
        }
    });
    let mut reading = must(store.begin(Access::Read));
    let cursor: BadgeCursor = must(reading.get(&[0u8.to_value()])).expect("it was put");
    assert_eq!(usize::from(cursor.turn), THREADS * COUNTS, "a change was lost");
}
