//! The embedded store does what every store does, and reads what earlier versions wrote.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use paros_booth::SqliteStore;
use paros_booth_rules::records::{Device, MailOrder, Sculpture, TABLES};
use paros_booth_rules::{BoothTime, ColumnKind, Field as _, Query, check_store, update, view};
use rusqlite::Connection;

/// A path in a folder of this test's own, at which there is nothing.
fn new_path() -> PathBuf {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("sqlite-{number}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("room on the disk");
    folder.join("booth.sqlite")
}

#[test]
fn sqlite_is_a_store() {
    check_store(|| SqliteStore::open(&new_path()).expect("a new database"));
}

/// The scripts make the tables of the records: the same columns in the same order, of the same kinds, keys and all.
#[test]
fn the_schema_is_that_of_the_records() {
    let path = new_path();
    SqliteStore::open(&path).expect("a new database");
    let database = Connection::open(&path).unwrap();
    let made: u32 = database
        .query_row("SELECT count(*) FROM sqlite_schema WHERE type = 'table'", [], |row| row.get(0))
        .unwrap();
    assert_eq!(made as usize, TABLES.len());
    for table in TABLES {
        let mut info = database
            .prepare("SELECT name, type, \"notnull\", pk FROM pragma_table_info(?)")
            .unwrap();
        let columns: Vec<(String, String, bool, u32)> = info
            .query_map([table.name], |row| Ok((row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?)))
            .unwrap()
            .map(Result::unwrap)
            .collect();
        let expected: Vec<_> = table
            .columns
            .iter()
            .enumerate()
            .map(|(k, column)| {
                let kind = match column.kind {
                    ColumnKind::Number => "INTEGER",
                    ColumnKind::Bytes => "BLOB",
                    ColumnKind::Text => "TEXT",
                };
                let key = if k < table.key_columns { k as u32 + 1 } else { 0 };
                (column.name.to_owned(), kind.to_owned(), !column.is_nullable, key)
            })
            .collect();
        assert_eq!(columns, expected, "table {}", table.name);
        for column in table.indexed {
            let index = format!("{}_{column}", table.name);
            let query = "SELECT count(*) FROM sqlite_schema WHERE type = 'index' AND name = ?";
            let count: u32 = database.query_row(query, [&index], |row| row.get(0)).unwrap();
            assert_eq!(count, 1, "{index}");
        }
    }
}

/// `tests/data/schema-1.sql` is a dump of a database of the first version: it is never changed.
#[test]
fn the_first_version_is_read() {
    let path = new_path();
    let database = Connection::open(&path).unwrap();
    database.execute_batch(include_str!("data/schema-1.sql")).unwrap();
    let mail =
        "INSERT INTO mail_orders VALUES (5, zeroblob(16), 'eleni@example.org', 1, 9, 0, 0, 9)";
    database.execute_batch(mail).unwrap();
    drop(database);
    let store = SqliteStore::open(&path).expect("it is brought to this version");
    let devices: Vec<Device> = view(&store, |tx| tx.find(&Query::all::<Device>())).unwrap();
    assert_eq!(devices.len(), 1);
    assert_eq!((devices[0].headset, devices[0].name.as_str()), (17, "Κουέστ"));
    assert_eq!(devices[0].enrolled_at, BoothTime(1_790_000_000_000));
    let kept: Vec<Sculpture> = view(&store, |tx| tx.find(&Query::all::<Sculpture>())).unwrap();
    assert_eq!((kept[0].id, kept[0].badge, kept[0].withdrawn_at), ([1; 16], Some(9), None));
    // Nobody was asked whether an address may stay.
    let mails: Vec<MailOrder> = view(&store, |tx| tx.find(&Query::all::<MailOrder>())).unwrap();
    assert_eq!((mails[0].why.as_str(), mails[0].keeps_address), ("", false));
    drop(store);
    SqliteStore::open(&path).expect("a second time there is nothing to do");
}

#[test]
fn a_newer_version_is_left_alone() {
    let path = new_path();
    let database = Connection::open(&path).unwrap();
    database.pragma_update(None, "user_version", 1000).unwrap();
    drop(database);
    let error = SqliteStore::open(&path).err().expect("it is unknown").to_string();
    assert!(error.contains("version 1000"), "{error}");
    let database = Connection::open(&path).unwrap();
    let version: u32 = database.pragma_query_value(None, "user_version", |row| row.get(0)).unwrap();
    assert_eq!(version, 1000);
}

#[test]
fn what_was_committed_is_there_after_a_restart() {
    let path = new_path();
    let device = Device {
        headset: 3,
        token_hash: [1; 32],
        hint: [2; 16],
        name: "Quest".into(),
        enrolled_at: BoothTime(5),
        revoked_at: None,
        wiped_at: None,
        seen_at: None,
        status: Vec::new(),
    };
    let store = SqliteStore::open(&path).unwrap();
    update(&store, |tx| tx.put(&device)).unwrap();
    drop(store);
    let store = SqliteStore::open(&path).unwrap();
    assert_eq!(view(&store, |tx| tx.get(&[3u32.to_value()])).unwrap(), Some(device));
}
