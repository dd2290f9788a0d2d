//! The embedded store does what every store does, and reads what earlier versions wrote.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use paros_booth::SqliteStore;
use paros_booth_rules::records::{Device, TABLES};
use paros_booth_rules::{BoothTime, ColumnKind, Field as _, check_store, update, view};
use rusqlite::Connection;

/// As SQLite's header names the application: "paro".
const APPLICATION: u32 = u32::from_be_bytes(*b"paro");

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
        for column in table.indexed.iter().chain(table.unique) {
            let index = format!("{}_{column}", table.name);
            let query = "SELECT count(*) FROM sqlite_schema WHERE type = 'index' AND name = ?";
            let count: u32 = database.query_row(query, [&index], |row| row.get(0)).unwrap();
            assert_eq!(count, 1, "{index}");
        }
    }
}

#[test]
fn another_version_is_left_alone() {
    let path = new_path();
    drop(SqliteStore::open(&path).expect("a new database"));
    // Of tables of before the application's id, of a newer program, and of another application.
    for (application, version) in [(0, 5), (APPLICATION, 2), (1, 1)] {
        let database = Connection::open(&path).unwrap();
        database.pragma_update(None, "application_id", application).unwrap();
        database.pragma_update(None, "user_version", version).unwrap();
        drop(database);
        let before = fs::read(&path).unwrap();
        let error = SqliteStore::open(&path).err().expect("it is another").to_string();
        assert!(error.contains(&format!("version {version}, and")), "{error}");
        assert!(fs::read(&path).unwrap() == before);
    }
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
