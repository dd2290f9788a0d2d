//! The embedded store: SQLite in a file, with a write-ahead log that is synced at each commit; or in memory,
//! for tests.
#![forbid(unsafe_code)]

use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use paros_booth_rules::records::{SCHEMA, SCHEMA_VERSION};
use paros_booth_rules::{Access, Row, Store, StoreError, Transaction, Value};
use rusqlite::types::{ToSqlOutput, ValueRef};
use rusqlite::{Connection, ErrorCode, TransactionBehavior, params_from_iter};

/// The number of read-only connections. Reads don't wait for a commit that is being synced.
const READERS: usize = 3;

/// The prepared statements that a connection caches: more than the rules have.
const STATEMENTS: usize = 256;

/// The application id in the header of the file: "paro".
const APPLICATION: i64 = 0x7061_726f;

/// A store in an SQLite database. Several processes may open the same file; each waits up to 5 s, the default
/// of `rusqlite`, for another's transaction.
#[derive(Debug)]
pub struct SqliteStore {
    writer: Mutex<Connection>,
    /// Empty for a database in memory, which has a single connection.
    readers: Vec<Mutex<Connection>>,
}

struct SqliteTransaction<'a> {
    connection: MutexGuard<'a, Connection>,
    access: Access,
    is_open: bool,
}

impl SqliteStore {
    /// Opens a file, and creates it if there is none.
    ///
    /// # Errors
    /// SQLite's error, or the file has another version, or is damaged.
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let open = || Connection::open(path).and_then(keep_statements).map_err(store_error);
        let mut writer = open()?;
        // Checked before anything is written, so that a file of another version isn't changed.
        make_tables(&mut writer)?;
        check_pages(&writer)?;
        let set = |name, value| writer.pragma_update(None, name, value).map_err(store_error);
        set("journal_mode", "WAL")?;
        // A commit returns after the log is synced.
        set("synchronous", "FULL")?;
        // Overwrites deleted data, so that it doesn't stay in free pages.
        set("secure_delete", "ON")?;
        let readers = (0..READERS).map(|_| open().map(Mutex::new)).collect::<Result<_, _>>()?;
        Ok(SqliteStore { writer: Mutex::new(writer), readers })
    }

    /// Makes an empty database in memory, for tests: one transaction at a time, and dropped with the store.
    ///
    /// # Errors
    /// SQLite's error.
    pub fn in_memory() -> Result<Self, StoreError> {
        let writer = Connection::open_in_memory().and_then(keep_statements);
        let mut writer = writer.map_err(store_error)?;
        make_tables(&mut writer)?;
        Ok(SqliteStore { writer: Mutex::new(writer), readers: Vec::new() })
    }

    /// Copies all rows of a store into a database in memory, for tests.
    ///
    /// # Errors
    /// The errors of either store.
    pub fn copy_in_memory(from: &dyn Store) -> Result<Self, StoreError> {
        let copy = SqliteStore::in_memory()?;
        let (mut source, mut target) = (from.begin(Access::Read)?, copy.begin(Access::Write)?);
        for table in SCHEMA.split("CREATE TABLE ").skip(1) {
            let name = table.split(' ').next().unwrap_or_default();
            for row in source.query(&format!("SELECT * FROM {name}"), &[])? {
                let places: Vec<String> = (1..=row.len()).map(|k| format!("?{k}")).collect();
                let insert = format!("INSERT INTO {name} VALUES ({})", places.join(", "));
                target.query(&insert, &row)?;
            }
        }
        target.commit()?;
        Ok(copy)
    }

    /// Locks a free reader, or waits for the first one.
    fn lock_reader(&self) -> MutexGuard<'_, Connection> {
        let free = self.readers.iter().find_map(|reader| reader.try_lock().ok());
        free.unwrap_or_else(|| lock(self.readers.first().unwrap_or(&self.writer)))
    }
}

impl Store for SqliteStore {
    fn begin(&self, access: Access) -> Result<Box<dyn Transaction + '_>, StoreError> {
        let (connection, begin) = match access {
            Access::Read => (self.lock_reader(), "BEGIN DEFERRED"),
            Access::Write => (lock(&self.writer), "BEGIN IMMEDIATE"),
        };
        execute(&connection, begin)?;
        Ok(Box::new(SqliteTransaction { connection, access, is_open: true }))
    }
}

impl Transaction for SqliteTransaction<'_> {
    fn query(&mut self, sql: &str, values: &[Value]) -> Result<Vec<Row>, StoreError> {
        let mut statement = self.connection.prepare_cached(sql).map_err(store_error)?;
        if self.access == Access::Read && !statement.readonly() {
            return Err(StoreError::Failed("this transaction may only read".into()));
        }
        let columns = statement.column_count();
        let read =
            |row: &rusqlite::Row<'_>| (0..columns).map(|k| row.get_ref(k).map(read)).collect();
        let rows = statement.query_map(params_from_iter(values.iter().map(write)), read);
        rows.and_then(Iterator::collect).map_err(store_error)
    }

    fn commit(mut self: Box<Self>) -> Result<(), StoreError> {
        execute(&self.connection, "COMMIT")?;
        self.is_open = false;
        Ok(())
    }
}

impl Drop for SqliteTransaction<'_> {
    fn drop(&mut self) {
        if self.is_open {
            // The error of ROLLBACK is ignored: SQLite may have rolled back already.
            let _ = execute(&self.connection, "ROLLBACK");
        }
    }
}

fn keep_statements(connection: Connection) -> rusqlite::Result<Connection> {
    connection.set_prepared_statement_cache_capacity(STATEMENTS);
    Ok(connection)
}

/// Makes the tables if the database has none.
fn make_tables(connection: &mut Connection) -> Result<(), StoreError> {
    // If two processes start at once, the second one finds the tables of the first.
    let transaction = connection
        .transaction_with_behavior(TransactionBehavior::Immediate)
        .map_err(store_error)?;
    let read =
        |name| transaction.pragma_query_value(None, name, |row| row.get(0)).map_err(store_error);
    let (application, version): (i64, i64) = (read("application_id")?, read("user_version")?);
    match (application, version) {
        (0, 0) => {
            transaction.execute_batch(SCHEMA).map_err(store_error)?;
            transaction.pragma_update(None, "application_id", APPLICATION).map_err(store_error)?;
            transaction.pragma_update(None, "user_version", SCHEMA_VERSION).map_err(store_error)?;
            transaction.commit().map_err(store_error)
        }
        (APPLICATION, SCHEMA_VERSION) => Ok(()),
        (_, other) => Err(StoreError::OtherVersion(other)),
    }
}

/// Checks every page of a database. Otherwise a truncated file would work until a missing row is read.
fn check_pages(connection: &Connection) -> Result<(), StoreError> {
    let found = connection.pragma_query_value(None, "quick_check", |row| row.get::<_, String>(0));
    match found.map_err(store_error)? {
        found if found == "ok" => Ok(()),
        found => Err(StoreError::Damaged(found.lines().last().unwrap_or_default().to_owned())),
    }
}

fn execute(connection: &Connection, sql: &str) -> Result<(), StoreError> {
    let done = connection.prepare_cached(sql).and_then(|mut statement| statement.execute(()));
    done.map(drop).map_err(store_error)
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn store_error(error: rusqlite::Error) -> StoreError {
    match error.sqlite_error_code() {
        Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => StoreError::Conflict,
        Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase) => {
            StoreError::Damaged(error.to_string())
        }
        _ => StoreError::Failed(Box::new(error)),
    }
}

fn write(value: &Value) -> ToSqlOutput<'_> {
    ToSqlOutput::Borrowed(match value {
        Value::Null => ValueRef::Null,
        Value::Number(number) => ValueRef::Integer(*number),
        Value::Bytes(bytes) => ValueRef::Blob(bytes),
        Value::Text(text) => ValueRef::Text(text.as_bytes()),
    })
}

fn read(value: ValueRef<'_>) -> Value {
    match value {
        ValueRef::Integer(number) => Value::Number(number),
        ValueRef::Blob(bytes) => Value::Bytes(bytes.to_vec()),
        ValueRef::Text(text) => Value::Text(String::from_utf8_lossy(text).into_owned()),
        // Strict tables have no columns of real numbers.
        ValueRef::Null | ValueRef::Real(_) => Value::Null,
    }
}
