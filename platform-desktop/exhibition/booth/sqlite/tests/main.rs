//! Tests of SQLite files: other versions, and restarts. The tests of `rules` cover what every store does.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use paros_booth_rules::records::{Device, SCHEMA_VERSION};
use paros_booth_rules::{BoothTime, update, view};
use paros_booth_sqlite::SqliteStore;
use rusqlite::Connection;

/// The application id in SQLite's header: "paro".
const APPLICATION: u32 = u32::from_be_bytes(*b"paro");

/// Returns an unused path in this test's own folder.
fn new_path() -> PathBuf {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("sqlite-{number}"));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("room on the disk");
    folder.join("booth.sqlite")
}

#[test]
fn another_version_is_left_alone() {
    let path = new_path();
    drop(SqliteStore::open(&path).expect("a new database"));
    // Tables of an older and a newer program, and files of other applications.
    let (older, newer) = (SCHEMA_VERSION - 1, SCHEMA_VERSION + 1);
    for (application, version) in [(0, 5), (APPLICATION, older), (APPLICATION, newer), (1, 1)] {
        let database = Connection::open(&path).unwrap();
        database.pragma_update(None, "application_id", application).unwrap();
        database.pragma_update(None, "user_version", version).unwrap();
        drop(database);
        let before = fs::read(&path).unwrap();
        let error = SqliteStore::open(&path).expect_err("it is another").to_string();
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
    assert_eq!(view(&store, |tx| tx.get(&[&3u32])).unwrap(), Some(device));
}
